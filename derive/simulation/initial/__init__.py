"""Consistent initialisation of a scene."""
