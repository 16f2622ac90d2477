"""Specifications: what the user writes, checked and turned into frozen data."""
