"""A Python module of a model, which needs NumPy alone."""
