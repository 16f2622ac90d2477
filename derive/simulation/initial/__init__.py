"""Consistent initialisation: the initial guess and the closest consistent state."""
