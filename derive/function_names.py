"""The names of the functions that a model has on request, for arguments of commands, which import nothing else."""

OF_MODELS = ("inverse_dynamics", "gravity_compensation", "centre_of_mass", "centroidal_momentum")
"""Those of a model, one of each."""
ON_REQUEST = (*OF_MODELS, "marker_rotations")
"""All of them: each marker has one."""
