"""Lowering to loops over the shapes: the size of the code does not depend on their number."""
