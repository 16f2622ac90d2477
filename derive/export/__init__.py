"""Models for other programs: packages of the generated C that a host accepts as they are."""
