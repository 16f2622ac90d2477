"""The names of the functions that a model has on request, for arguments of commands, which import nothing else."""

ON_REQUEST = (
    "inverse_dynamics",
    "gravity_compensation",
    "centre_of_mass",
    "centroidal_momentum",
    "marker_rotations",
)
