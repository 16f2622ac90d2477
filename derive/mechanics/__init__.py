"""Derivation of the equations of motion with SymPy: exact numbers, named terms, no files."""
