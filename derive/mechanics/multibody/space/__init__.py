"""Mechanisms in space: marker frames, joints by masks of relative rows, minimal coordinates, forces and outputs."""
