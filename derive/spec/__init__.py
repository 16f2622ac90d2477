"""Specifications: the input of a user, which is checked and converted to frozen data."""
