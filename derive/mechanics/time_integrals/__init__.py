"""Integrals of functions of time in closed form."""
