"""Observables of a motion: marker positions, deflections, plots, CSV files."""
