"""Scenes in space: poses of bodies, and the initial state in minimal perturbations, three for a rotation."""
