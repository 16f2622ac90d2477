"""Mechanisms: instances of bodies, their coordinates, joints and forces, put together."""
