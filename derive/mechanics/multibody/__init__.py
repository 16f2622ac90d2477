"""Mechanisms: instances of bodies, their coordinates, joints and forces, and their assembly."""
