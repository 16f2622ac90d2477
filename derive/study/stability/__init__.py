"""Stability of the models of a ladder over a parameter: their eigenvalues, thresholds and wrong verdicts."""
