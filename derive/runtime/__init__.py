"""Compile generated C, load it, and call it through NumPy."""
