"""Simulation of a scene: consistent initialisation, integration, constraints, observables."""
