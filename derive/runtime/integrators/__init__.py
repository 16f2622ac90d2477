"""Integrators in C, compiled together with a model; their sources are in `templates/host`."""
