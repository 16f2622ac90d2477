"""Equations to kernels."""
