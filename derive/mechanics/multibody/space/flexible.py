"""The finite-element body of a mechanism in space: its modal body, and marker frames that deform with it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from derive.algebra import sp
from derive.mechanics.bodies.spatial_body import NumberValues, exact_vector, modal_body
from derive.mechanics.body import Body, ExactValues
from derive.mechanics.motion.material_points import MaterialPoint
from derive.mechanics.motion.rotations import matrix_of
from derive.mechanics.multibody.bodies.body_type import BodyType, Component, Constant, CrossSection
from derive.mechanics.multibody.bodies.rigid import BODY_FRAME
from derive.mechanics.multibody.space.frame_motion import fixed_axes
from derive.mechanics.multibody.space.nodal_loads import nodal_forces
from derive.spec.model.spatial_bodies import FlexibleBody

if TYPE_CHECKING:
    from derive.mechanics.bodies.modal_body import Array, ModalBody, ModalFrame
    from derive.mechanics.terms import ModelConstant


@dataclass(frozen=True, eq=False)
class ReducedBody:
    """A finite-element body as numbers: its shape integrals, the frames of its markers, and the points of its loads."""

    body: ModalBody
    frames: tuple[ModalFrame, ...]
    load_points: tuple[ModalFrame, ...] = ()


class Flexible(BodyType[FlexibleBody]):
    """The type of a finite-element body, which keeps all coordinates; `reduced` is the body as numbers."""

    doc = "finite-element body"

    def __init__(self, reduced: ReducedBody) -> None:
        self.reduced = reduced

    def components(self, body: FlexibleBody, gravity: tuple[ModelConstant, ...]) -> tuple[Component, ...]:
        """The body with its floating frame."""
        of = _with_exact_values(self.reduced.body, gravity)
        axes = {m.name: matrix_of(m.rotation) for m in body.markers}
        sections = {frame.point.name: _section(frame, axes[frame.point.name]) for frame in self.reduced.frames}
        sections |= {frame.point.name: _section(frame, fixed_axes()) for frame in self.reduced.load_points}
        still = sp.ImmutableMatrix([0, 0, 0])
        origin = MaterialPoint(BODY_FRAME, "origin of the floating frame", still, (still,) * self.reduced.body.modes)
        sections[BODY_FRAME] = CrossSection(origin, twists=(still,) * self.reduced.body.modes)
        return (Component(body.name, body.name, of, sections, tuple(axes), body.name),)

    def forces(self, body: FlexibleBody) -> tuple[Any, ...]:
        """The resultants of the loads on nodes."""
        return tuple(nodal_forces(body))

    def constants(self, body: FlexibleBody) -> Iterator[Constant]:
        """No constants: all numbers are those of the files."""
        yield from ()


def _with_exact_values(given: ModalBody, gravity: tuple[ModelConstant, ...]) -> Body:
    """The body of the equations of motion, with the numbers of its tables as constants, each known individually."""
    numbers = NumberValues(given)
    body = modal_body(given)
    every = tuple(c for table in body.tables for c in numbers.constants(table))
    return replace(body, values=ExactValues(every), points=(), gravity=gravity)


def _section(frame: ModalFrame, axes: sp.ImmutableMatrix) -> CrossSection:
    point = frame.point
    second = () if point.second is None else tuple(tuple(map(exact_vector, row)) for row in point.second)
    (position,), shapes, twists = _exact(point.position[None]), _exact(point.shapes), _exact(frame.twists)
    material = MaterialPoint(point.name, point.doc, position, shapes, second=second)
    return CrossSection(material, axes=axes, twists=twists)


def _exact(vectors: Array) -> tuple[sp.ImmutableMatrix, ...]:
    """The rows of an array as exact numbers, without rounding errors of zero, which means over nodes have."""
    size = float(np.abs(vectors).max(initial=0.0))
    return tuple(exact_vector(np.where(np.abs(x) > ROUNDING * size, x, 0.0)) for x in vectors)


ROUNDING = 1e-13
"""Positions, displacements and rotations below this part of the largest one of a marker are rounding errors of zero."""
