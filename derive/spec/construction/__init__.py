"""Specifications built in Python from typed values or mappings, with the keys, defaults and checks of a TOML file.

Every function raises SpecError with all faults; paths are those of a TOML file, without lines.
"""
