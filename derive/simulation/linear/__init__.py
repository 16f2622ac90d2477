"""Linearisation of a compiled model about a state: state-space matrices, eigenvalues, modes."""
