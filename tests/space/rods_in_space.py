"""Rods as beams in space, with points that have their masses, and their accelerations by the interpreter."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np

import derive
from derive.mechanics.bodies.section_fields import SectionField
from derive.runtime.interpreted_scene import InterpretedFunction
from derive.spec.model.spatial_beam import SpatialBeam
from some_functions import only

PLANAR_ROD: dict[str, Any] = {
    "length": "3/2",
    "mass": 2,
    "bending_stiffness": 30,
    "ansatz": ["1", "xi", "xi^2", "xi^3"],
    "axial": {"ansatz": ["xi"], "stiffness": 1000},
}
ROD: dict[str, Any] = PLANAR_ROD | {
    "lateral": {"ansatz": ["1", "xi", "xi^2", "xi^3"], "bending_stiffness": 12},
    "rotary_inertia": "1/50",
    "torsion": {"ansatz": ["xi", "xi^2"], "stiffness": 7},
}
SHAPES = ["1", "xi", "xi^2", "xi^3", "xi^4"]
FRAMES: tuple[Any, ...] = ("mean", "chord", {"kind": "tangent", "at": -1}, {"kind": "point", "at": "1/3"})


def beam(**changes: Any) -> SpatialBeam:
    """The beam of a scene with it alone, with more shapes."""
    markers = {"left": {"at": -1}, "right": 1}
    scene = derive.spatial_scene("alone", bodies={"rod": ROD | {"ansatz": SHAPES, "markers": markers} | changes})
    (body,) = scene.bodies
    assert isinstance(body, SpatialBeam)
    return body


def points(of: SpatialBeam) -> list[tuple[float, Fraction, tuple[float, ...]]]:
    """Masses (kg) at points of sections, some negative, that have the mass, the centre and the inertia of the beam."""
    mass, inertia = 2.0, 1 / 50
    e = (0.0, *(float(x) for x in of.centre))  # type: ignore[arg-type]
    own = inertia / (4 * mass)
    section = [(1 - inertia / (2 * mass), e)]
    for axis, weight in enumerate((-own, own, own)):
        for sign in (1.0, -1.0):
            section.append((weight, tuple(x + sign * (k == axis) for k, x in enumerate(e))))
    nodes, weights = np.polynomial.legendre.leggauss(10)
    return [(w * share * mass / 2, Fraction(x), p) for x, w in zip(nodes, weights, strict=True) for share, p in section]


def numbers(field: SectionField, xi: float, p: tuple[float, ...]) -> list[float]:
    """A field at a point p of the section at xi, in doubles."""
    result = [0.0] * 3
    for (axis, coordinate), of in field.slots.items():
        number = float(np.polynomial.polynomial.polyval(xi, [float(c) for c in of.coefficients]))
        result[axis - 1] += number * float(field.unit((axis, coordinate))) * (p[coordinate - 1] if coordinate else 1)
    return result


def accelerations(scene: Any, q: Any, v: Any, t: float = 0.0) -> Any:
    """The accelerations of a scene, by the interpreter, at the time t (s)."""
    with only("accel"):
        model = derive.lower(derive.derive(scene), explicit=True)
    run = {k.name: InterpretedFunction(model, k) for k in model.kernels if k.name in ("setup", "accel")}
    return run["accel"].at(t, q, v, run["setup"]((np.array(model.defaults),)))
