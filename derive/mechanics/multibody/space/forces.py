"""Forces and torques in space, at markers and in joints: their loads, from which virtual work and reactions follow."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import TYPE_CHECKING, Any, TypeAlias

from derive.algebra import sp, zero
from derive.mechanics.motion.vectors import cross
from derive.mechanics.symbols import element as element_symbol
from derive.mechanics.terms import EquationOfMotion, Intermediate, Term
from derive.spec.model.markers import MarkerRef
from derive.spec.model.spatial_forces import (
    SpatialAction,
    SpatialForce,
    SpatialJointForce,
    SpatialJointLoad,
    SpatialSpring,
    SpatialTorque,
)

if TYPE_CHECKING:
    from derive.mechanics.multibody.space.frame_motion import FrameMotion


@dataclass(frozen=True)
class MarkerLoad:
    """A force at a marker and a torque on its frame, columns of 3 in the inertial frame (N, N m)."""

    marker: MarkerRef
    force: sp.Matrix
    torque: sp.Matrix


@dataclass(frozen=True)
class ActionLoads:
    """The loads of a force, a torque or a spring, and the definitions in them.

    `value` (N or N m) is that of a load in a joint; `potential` (J) is the energy it stores, if any; `dissipation` (W,
    not positive) the power it takes away from it.
    """

    element: SpatialAction
    loads: tuple[MarkerLoad, ...]
    definitions: tuple[Intermediate, ...] = ()
    potential: sp.Expr = field(default_factory=zero)
    dissipation: sp.Expr = field(default_factory=zero)
    value: sp.Expr = field(default_factory=zero)

    @property
    def name(self) -> str:
        """The name of its terms."""
        noun = "spring" if isinstance(self.element, SpatialSpring) else self.element.kind
        return f"{noun} {self.element.name}"

    def on(self, body: str) -> Iterator[MarkerLoad]:
        """Yield its loads on a body."""
        return (load for load in self.loads if load.marker.body == body)

    def terms(self, at: Callable[[MarkerRef], FrameMotion], rows: tuple[EquationOfMotion, ...]) -> tuple[Term, ...]:
        """The virtual work of the loads on the rows of a mechanism, on the left-hand side."""
        totals: dict[str, sp.Expr] = {}
        for load in self.loads:
            for row, factor in at(load.marker).work(load.force, load.torque):
                totals[row] = totals.get(row, sp.S.Zero) + factor
        kept = (row.name for row in rows if totals.get(row.name, sp.S.Zero) != 0)
        return tuple(Term(row, self.name, "(10)", -totals[row]) for row in kept)


@dataclass(frozen=True)
class CountedRotation:
    """The rotation of the second of two markers about z of the first, with all turns, rad.

    rate: its time derivative where z of both markers is one axis in every state. It is None of markers that a
    constraint keeps on an axis; `angle` is then what whole turns add to the rotation from -pi to pi.
    """

    angle: sp.Expr
    rate: sp.Expr | None


Values = Mapping[str, Any]
Markers = tuple[MarkerRef, ...]
Frames: TypeAlias = "tuple[FrameMotion, ...]"


@cache
def none() -> sp.Matrix:
    """No force, or no torque."""
    return sp.zeros(3, 1)


class ElementDefinitions:
    """Names for the quantities of an element, with their definitions."""

    def __init__(self, owner: str, doc: str) -> None:
        self.owner, self.doc, self.made = owner, doc, list[Intermediate]()

    def __call__(self, label: str, value: sp.Expr, text: str, *components: int) -> sp.Expr:
        """The name of a scalar; numbers and symbols stay as they are."""
        value = sp.sympify(value)
        if value.is_Rational or value.is_Symbol:
            return value
        symbol = element_symbol(self.owner, label, *components)
        self.made.append(Intermediate(symbol, value, self.owner, "(10)", f"{text} of {self.doc}"))
        return symbol

    def vector(self, label: str, values: sp.Matrix, text: str) -> sp.Matrix:
        """The names of the components of a column."""
        return sp.Matrix([self(label, x, f"{text} along {k}", k) for k, x in enumerate(values, 1)])


def force_loads(force: SpatialForce, frames: tuple[FrameMotion, ...], values: Values) -> ActionLoads:
    """The load of a force, whose components turn with the frame of its marker, or are inertial."""
    name = ElementDefinitions(force.name, f"force {force.name}")
    given = name.vector("", values["force"], "component")
    vector = sp.Matrix(frames[0].axes) * given if force.frame == "body" else given
    load = MarkerLoad(force.at, name.vector("inertial", vector, "force"), none())
    return ActionLoads(force, (load,), tuple(name.made))


def torque_loads(torque: SpatialTorque, frames: tuple[FrameMotion, ...], values: Values) -> ActionLoads:
    """The load of a torque, and that of its reaction."""
    name = ElementDefinitions(torque.name, f"torque {torque.name}")
    given = name.vector("", values["torque"], "component")
    vector = sp.Matrix(frames[0].axes) * given if torque.frame == "body" else given
    vector = name.vector("inertial", vector, "torque")
    loads = [MarkerLoad(torque.on, none(), vector)]
    if torque.against is not None:
        loads.append(MarkerLoad(torque.against, none(), -vector))
    return ActionLoads(torque, tuple(loads), tuple(name.made))


def joint_load_loads(load: SpatialJointLoad, markers: Markers, frames: Frames, values: Values) -> ActionLoads:
    """The force along, or the torque about, z of the first marker of a joint on the second one, and its reaction."""
    name = ElementDefinitions(load.name, f"{load.kind} {load.name}")
    value = name("value", values["value"], "value")
    vector = name.vector("inertial", frames[0].axes[:, 2] * value, load.kind)
    pairs = [(vector, none()) if isinstance(load, SpatialJointForce) else (none(), vector)]
    pairs.append((-pairs[0][0], -pairs[0][1]))
    loads = tuple(MarkerLoad(marker, *pair) for marker, pair in zip(reversed(markers), pairs, strict=True))
    return ActionLoads(load, loads, tuple(name.made), value=value)


def moved_to(load: MarkerLoad, old: sp.Matrix, new: sp.Matrix) -> tuple[sp.Matrix, sp.Matrix]:
    """The force and the torque of a load about another point, both in the inertial frame."""
    return load.force, load.torque + cross(old - new, load.force)
