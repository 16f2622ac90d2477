"""Sweeps: many runs of one model with other values of its parameters, and a few numbers as the result of each run."""
