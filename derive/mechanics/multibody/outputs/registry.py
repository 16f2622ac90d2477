"""The registry of outputs, one line for each kind: the values of `kind` in `[outputs.NAME]`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from derive.mechanics.multibody.outputs.deflection import ChordDeflection
from derive.mechanics.multibody.outputs.energies import Energies, Powers
from derive.mechanics.multibody.outputs.marker_motion import Distance, Inclination, MarkerRotation, MarkerVector
from derive.mechanics.multibody.outputs.reactions import DriveForce, Reaction, SpringForce
from derive.mechanics.multibody.outputs.section_forces import (
    AxialLoad,
    BendingMoment,
    Curvature,
    MomentGap,
    SectionForce,
    ShearGap,
    Strain,
)
from derive.registry import Registry

if TYPE_CHECKING:
    from derive.mechanics.multibody.outputs.output_type import OutputType

OUTPUTS: Registry[OutputType] = Registry(
    "output",
    {
        "position": MarkerVector("position of a marker", 0, "m"),
        "velocity": MarkerVector("velocity of a marker", 1, "m/s"),
        "acceleration": MarkerVector("acceleration of a marker", 2, "m/s^2"),
        "rotation": MarkerRotation("rotation of the section at a marker", 0, "rad"),
        "angular_velocity": MarkerRotation("angular velocity of the section at a marker", 1, "rad/s"),
        "angular_acceleration": MarkerRotation("angular acceleration of the section at a marker", 2, "rad/s^2"),
        "distance": Distance(),
        "angle": Inclination(),
        "deflection": ChordDeflection(),
        "reaction": Reaction(),
        "drive": DriveForce(),
        "spring": SpringForce(),
        "axial_force": SectionForce("axial force of a beam, positive in tension", 0),
        "shear_force": SectionForce("shear force of a beam", 1),
        "bending_moment": BendingMoment(),
        "curvature": Curvature(),
        "strain": Strain(),
        "energy": Energies(),
        "power": Powers(),
    },
    doc="""The kinds of outputs in the plane by their names, which are the values of `kind` in [outputs.NAME].

    `derive.OUTPUTS.register(name, member)` adds one of your own, a subclass of `derive.extensions.OutputType`.

    Examples:
        >>> import derive
        >>> derive.OUTPUTS["reaction"].doc
        'what a joint exerts on body 2, with its drive'
        >>> "bending_moment" in derive.OUTPUTS
        True
    """,
)

MONITORS: Registry[OutputType] = Registry(
    "monitor",
    {
        "axial_load": AxialLoad(0),
        "axial_load_linear": AxialLoad(1),
        "axial_load_quadratic": AxialLoad(2),
        "moment_gap": MomentGap(),
        "shear_gap": ShearGap(),
    },
)
"""Outputs that a simulation adds to a scene to watch the validity of its model; no specification asks for them."""


def output_type(kind: str) -> OutputType:
    """The type of an output of a scene, or of one that a simulation adds. Raises UnknownNameError."""
    return MONITORS[kind] if kind in MONITORS else OUTPUTS[kind]
