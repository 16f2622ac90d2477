"""Solid finite elements of a mesh: shape functions, strains and stresses of displacements."""
