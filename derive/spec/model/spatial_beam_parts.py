"""The parts of a beam in space as frozen data: markers, its deflection along e3 and torsion, loads, attached masses."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated

from derive.short_text import record_text
from derive.spec.model.beam_parts import DEFAULT_LENGTH, DEFAULT_MASS, INERTIA_UNIT, POSITION, Polynomial, ShapeFamily
from derive.spec.model.documentation import documented
from derive.spec.model.forces import LOAD_FACTOR, ForceFrame
from derive.spec.model.keys import Key, KeyType, key
from derive.spec.model.quantity import Quantity
from derive.spec.model.spatial_start import NO_ROTATION, ROTATION_FORMS, UnitQuaternion
from derive.spec.model.time_function import TimeFunction


@documented
@dataclass(frozen=True)
class SectionFrame:
    """A named marker of a beam in space: a point of its axis, and a frame that turns with the section there.

    Attributes:
        name: the name of the marker.

    Examples:
        >>> import derive
        >>> from fractions import Fraction
        >>> tip = derive.SectionFrame("tip", Fraction(1))
        >>> rod = {"length": 1, "mass": 2, "bending_stiffness": 100, "rotary_inertia": 1e-3, "markers": {"tip": tip}}
        >>> derive.spatial_scene("floating", bodies={"rod": rod}).bodies[0].markers[0].at
        Fraction(1, 1)
    """

    name: str
    at: Annotated[Fraction, POSITION]
    rotation: Annotated[
        UnitQuaternion,
        key(
            KeyType.ROTATION,
            f"Rotation of the marker against the undeformed beam: {ROTATION_FORMS}.",
            shown=(1, 0, 0, 0),
        ),
    ] = NO_ROTATION
    __repr__ = record_text


@documented
@dataclass(frozen=True)
class LateralDeflection:
    """The deflection of a beam in space along its e3, where it differs from that along e2.

    Examples:
        >>> import derive
        >>> flat = derive.LateralDeflection(bending_stiffness=5)
        >>> rod = {"length": 1, "mass": 2, "bending_stiffness": 100, "rotary_inertia": 1e-3, "lateral": flat}
        >>> derive.spatial_scene("floating", bodies={"rod": rod}).bodies[0].bending_stiffnesses
        (Fraction(100, 1), Fraction(5, 1))
    """

    ansatz: Annotated[
        tuple[Polynomial, ...] | ShapeFamily | None,
        key(ShapeFamily, "Shape functions of the deflection along e3; by default those of the deflection along e2."),
    ] = None
    bending_stiffness: Annotated[
        Quantity | None,
        key(
            KeyType.POSITIVE_QUANTITY,
            "Bending stiffness EI about e2, N m^2, of deflections along e3; by default that about e3.",
            "N m^2",
        ),
    ] = None
    __repr__ = record_text


@documented
@dataclass(frozen=True)
class TorsionalDeformation:
    """How a beam twists about its axis. Without this table it is rigid in torsion.

    Examples:
        >>> import derive
        >>> twist = derive.TorsionalDeformation(ansatz=["xi"], stiffness=10)
        >>> rod = {"length": 1, "mass": 2, "bending_stiffness": 100, "rotary_inertia": 1e-3, "torsion": twist}
        >>> derive.spatial_scene("floating", bodies={"rod": rod}).bodies[0].torsion.stiffness
        Fraction(10, 1)
    """

    ansatz: Annotated[
        tuple[Polynomial, ...],
        key(
            KeyType.SHAPES,
            "Polynomials in xi whose sum, times 2/length, is the rotation of the sections about the axis, before the "
            "condition of the frame takes a constant from each: no mean rotation, none at the point of the frame, or "
            'opposite ones at the ends of a chord. ["xi"] is a uniform twist.',
            example='["xi"]',
        ),
    ]
    stiffness: Annotated[
        Quantity,
        key(
            KeyType.POSITIVE_QUANTITY,
            "Torsional stiffness GJ, N m^2: a run-time parameter or a number.",
            "N m^2",
            example="10",
        ),
    ]
    __repr__ = record_text


LoadTriple = tuple[Polynomial, Polynomial, Polynomial]
"""Three components of a load that are polynomials in xi."""
NO_LOAD: LoadTriple = ((), (), ())


def _components(what: str, unit: str, example: str) -> Key:
    text = f"{what}, {unit}, along the axes of the frame: numbers, or polynomials in xi, from -1 to 1 along the beam."
    return key(KeyType.LOAD_TRIPLE, text, unit, default=NO_LOAD, shown=(0, 0, 0), example=example)


@documented
@dataclass(frozen=True)
class SpatialDistributedLoad:
    """A load along the axis of a beam in space: force and torque per length, times a function of t.

    Attributes:
        name: the name of the load.

    Examples:
        >>> import derive
        >>> rod = {"length": 1, "mass": 2, "bending_stiffness": 100, "rotary_inertia": 1e-3}
        >>> rod["loads"] = {"wind": {"force": [0, 0, "-10*(1 - xi^2)"], "time": "sin(t)"}}
        >>> derive.spatial_scene("floating", bodies={"rod": rod}).bodies[0].loads[0].force[2]
        (Fraction(-10, 1), Fraction(0, 1), Fraction(10, 1))
    """

    name: str
    force: Annotated[LoadTriple, _components("Force per length", "N/m", '[0, 0, "-10*(1 - xi^2)"]')]
    torque: Annotated[LoadTriple, _components("Torque per length", "N", "[2, 0, 0]")]
    time: Annotated[TimeFunction, LOAD_FACTOR]
    frame: Annotated[
        ForceFrame,
        key(
            KeyType.CHOICE,
            "The frame of the components: inertial, or body: forces turn with the floating frame of the beam, torques "
            "with its sections.",
        ),
    ] = "inertial"
    __repr__ = record_text


@documented
@dataclass(frozen=True)
class SpatialAttachedMass:
    """A rigid body that is fixed to a section of a beam in space.

    Attributes:
        name: the name of the mass.

    Examples:
        >>> import derive
        >>> tip = {"at": 1, "mass": "1/2", "centre": [0.1, 0, 0]}
        >>> rod = {"length": 1, "mass": 2, "bending_stiffness": 100, "rotary_inertia": 1e-3, "masses": {"tip": tip}}
        >>> derive.spatial_scene("floating", bodies={"rod": rod}).bodies[0].masses[0].mass
        Fraction(1, 2)
    """

    name: str
    at: Annotated[Fraction, POSITION]
    mass: Annotated[Quantity, key(KeyType.POSITIVE_QUANTITY, "Mass, kg.", DEFAULT_MASS.unit, example="0.5")]
    inertia: Annotated[
        tuple[Quantity, ...] | None,
        key(
            KeyType.INERTIA_TENSOR,
            "Tensor of inertia about its centre of mass along the axes of the section, kg m^2: the entries "
            "[Jxx, Jyy, Jzz, Jxy, Jxz, Jyz], Jxy = - int x y dm; by default that of a point.",
            INERTIA_UNIT,
            example="[0.01, 0.02, 0.02, 0, 0, 0]",
        ),
    ] = None
    centre: Annotated[
        tuple[Quantity, Quantity, Quantity],
        key(
            KeyType.COORDINATE_TRIPLE,
            "Its centre of mass against the point of the axis, along the axes of the section, m.",
            DEFAULT_LENGTH.unit,
        ),
    ] = (Fraction(0), Fraction(0), Fraction(0))
    __repr__ = record_text
