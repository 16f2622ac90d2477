"""FMUs of versions 2 and 3, for model exchange and co-simulation."""
