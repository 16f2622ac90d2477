"""Time integration of a compiled scene: the registry of integrators, and the diagnosis of failures."""
