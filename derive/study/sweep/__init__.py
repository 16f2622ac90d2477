"""Sweeps: many runs of one model with other values of its parameters, and what each run comes to."""
