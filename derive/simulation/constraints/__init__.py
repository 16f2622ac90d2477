"""Constraints of a compiled scene: scaling, closest consistent states, redundancy, projection."""
