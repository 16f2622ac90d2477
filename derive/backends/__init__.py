"""Models to source code."""
