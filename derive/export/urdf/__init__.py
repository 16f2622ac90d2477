"""The description of a tree of rigid bodies as a robot (URDF)."""
