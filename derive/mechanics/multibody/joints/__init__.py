"""The joints of a mechanism: one file for each type, and the registry that a specification chooses from."""
