"""The names of the functions that a model has on request, for arguments of commands, which import nothing else."""

OF_MODELS = ("inverse_dynamics", "gravity_compensation", "centre_of_mass", "centroidal_momentum")
"""The names of functions that a model has one of."""
ON_REQUEST = (*OF_MODELS, "marker_rotations")
"""The names of all functions on request, with that of the functions of markers."""
