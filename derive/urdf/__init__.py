"""Descriptions of robots (URDF): reading, and the scene that one describes."""
