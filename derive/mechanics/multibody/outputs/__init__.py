"""Outputs of a mechanism: motions of markers, reactions, section forces, energies and powers."""
