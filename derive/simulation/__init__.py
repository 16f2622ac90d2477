"""The numerics on top of a compiled scene: consistent start, integration, analysis of constraints, pictures."""
