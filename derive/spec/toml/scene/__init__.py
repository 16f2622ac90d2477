"""The tables of a scene: bodies, joints, drives, forces, and the checks between them."""
