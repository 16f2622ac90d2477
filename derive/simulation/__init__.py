"""Simulation of a compiled scene: consistent initialisation, integration, analysis of constraints."""
