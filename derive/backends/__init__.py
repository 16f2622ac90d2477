"""The backends, which write models as source code."""
