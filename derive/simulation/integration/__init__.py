"""Time integration of a compiled scene, and the diagnosis of failures."""
