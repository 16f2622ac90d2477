"""The finite-element body of a mechanism in space: its modal body, and marker frames that deform with it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations_with_replacement
from typing import TYPE_CHECKING, Any

import numpy as np

from derive.algebra import sp
from derive.mechanics.axes import AXES
from derive.mechanics.bodies.spatial_body import NumberValues, modal_body
from derive.mechanics.body import Body, ExactValues
from derive.mechanics.motion.material_points import MaterialPoint
from derive.mechanics.motion.rotations import matrix_of
from derive.mechanics.multibody.bodies.body_type import BodyType, Component, Constant, CrossSection
from derive.mechanics.multibody.bodies.rigid import BODY_FRAME
from derive.mechanics.multibody.space.frame_motion import fixed_axes
from derive.mechanics.multibody.space.nodal_loads import nodal_forces
from derive.mechanics.symbols import Family, Identity
from derive.mechanics.terms import ModelConstant
from derive.roles import Source
from derive.spec.model.spatial_bodies import FlexibleBody

if TYPE_CHECKING:
    from derive.mechanics.bodies.modal_body import Array, ModalBody, ModalFrame


@dataclass(frozen=True, eq=False)
class ReducedBody:
    """A finite-element body as numbers: its shape integrals, the frames of its markers, and the points of its loads."""

    body: ModalBody
    frames: tuple[ModalFrame, ...]
    load_points: tuple[ModalFrame, ...] = ()


class Flexible(BodyType[FlexibleBody]):
    """The type of a finite-element body, which keeps all coordinates.

    reduced: the body as numbers. looped: whether the numbers of markers are constants, so that bodies that differ in
    them have one code in loops over instances; straight-line code takes fewer operations with the numbers themselves.
    """

    doc = "finite-element body"

    def __init__(self, reduced: ReducedBody, looped: bool) -> None:
        self.reduced, self.looped = reduced, looped

    def components(self, body: FlexibleBody, gravity: tuple[ModelConstant, ...]) -> tuple[Component, ...]:
        """The body with its floating frame."""
        of = _with_exact_values(self.reduced.body, gravity)
        axes = {m.name: matrix_of(m.rotation) for m in body.markers}
        sections = {
            frame.point.name: _section(frame, axes[frame.point.name], self.looped) for frame in self.reduced.frames
        }
        sections |= {frame.point.name: _section(frame, fixed_axes(), self.looped) for frame in self.reduced.load_points}
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


def _section(frame: ModalFrame, axes: sp.ImmutableMatrix, looped: bool) -> CrossSection:
    """The frame at a marker. looped: whether its numbers are constants."""
    point, constants = frame.point, _PointNumbers(frame.point.name, looped)
    modes = range(1, len(point.shapes) + 1)
    ones = [(i,) for i in modes]
    (position,) = constants(Family.POINT_POSITION, [()], point.position[None], "X", "m", "(1)")
    shapes = constants(Family.POINT_SHAPE, ones, point.shapes, "displacement", "", "(1)")
    twists = constants(Family.SECTION_ROTATION, ones, frame.twists, "rotation", "1/m", "(1)")
    second = constants.of_pairs(Family.POINT_SECOND, point.second, "displacement", "1/m")
    second_twists = constants.of_pairs(Family.SECTION_ROTATION, frame.second_twists, "rotation", "1/m^2")
    material = MaterialPoint(point.name, point.doc, position, shapes, tuple(constants.made), second)
    stresses = () if frame.stresses is None else tuple(_exact_column(row) for row in frame.stresses)
    return CrossSection(material, axes=axes, twists=twists, second_twists=second_twists, stresses=stresses)


def _exact_column(numbers: Array) -> sp.ImmutableMatrix:
    return sp.ImmutableMatrix([sp.Rational(float(x)) for x in numbers])


class _PointNumbers:
    """The numbers of a marker, or constants with these values, without rounding errors of zero, which means have."""

    def __init__(self, point: str, as_constants: bool) -> None:
        self.point, self.as_constants, self.made = point, as_constants, list[ModelConstant]()

    def __call__(
        self,
        family: Family,
        modes: Sequence[tuple[int, ...]],
        vectors: Array,
        doc: str,
        unit: str,
        equation: str = Source.SECOND_ORDER,
    ) -> tuple[sp.ImmutableMatrix, ...]:
        """The vectors of some modes, whose components are numbers or the names of constants."""
        size = float(np.abs(vectors).max(initial=0.0))
        result = []
        for of, vector in zip(modes, vectors, strict=True):
            entries = [sp.S.Zero] * len(AXES)
            for k, value in zip(AXES, vector, strict=True):
                exact = sp.Rational(float(value))
                if abs(value) > ROUNDING * size and not self.as_constants:
                    entries[k - 1] = exact
                elif abs(value) > ROUNDING * size:
                    symbol = entries[k - 1] = Identity(family, of, (k,), point=self.point).symbol
                    by = f" by mode{'s' * (len(of) - 1)} {' and '.join(map(str, of))}" if of else ""
                    text = f"{doc} . e{k} of {self.point}{by}"
                    self.made.append(ModelConstant(symbol, exact, equation, text, unit))
            result.append(sp.ImmutableMatrix(entries))
        return tuple(result)

    def of_pairs(
        self, family: Family, vectors: Array | None, doc: str, unit: str
    ) -> tuple[tuple[sp.ImmutableMatrix, ...], ...]:
        """The vectors (N, N) of pairs of modes, which are symmetric in these; none at first order."""
        if vectors is None:
            return ()
        modes = range(1, len(vectors) + 1)
        pairs = [*combinations_with_replacement(modes, 2)]
        values = np.array([vectors[i - 1, j - 1] for i, j in pairs])
        of = dict(zip(pairs, self(family, pairs, values, doc, unit), strict=True))
        return tuple(tuple(of[min(i, j), max(i, j)] for j in modes) for i in modes)


ROUNDING = 1e-13
"""Positions, displacements and rotations below this part of the largest one of a marker are rounding errors of zero."""
