"""Observables of a motion: marker positions, deflections, plots, CSV files, the data of the player."""
