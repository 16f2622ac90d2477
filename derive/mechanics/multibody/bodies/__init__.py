"""The types of bodies in a mechanism: one file for each, and the registry that a specification chooses from."""
