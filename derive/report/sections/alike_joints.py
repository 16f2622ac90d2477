"""Joints of a scene whose constraints differ in names and constants alone: a page shows them once."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping
from dataclasses import dataclass

from derive.algebra import sp
from derive.mechanics.symbols import owned
from derive.mechanics.terms import Constraint
from derive.mechanics.typed_symbol import Symbol


@dataclass(frozen=True)
class ConstraintsShownOnce:
    """The constraints of a scene without those of joints that are like an earlier one.

    alike: the names of these joints, by the name of the joint whose constraints are shown.
    """

    constraints: tuple[Constraint, ...]
    alike: Mapping[str, tuple[str, ...]]


def constraints_once(constraints: Iterable[Constraint], bodies: Iterable[str]) -> ConstraintsShownOnce:
    """The constraints, of joints that are alike those of the first. bodies: the names of all bodies in their order."""
    of: dict[str, list[Constraint]] = {}
    for constraint in constraints:
        of.setdefault(constraint.of, []).append(constraint)
    places = {name: place for place, name in enumerate(bodies)}
    first: dict[Hashable, str] = {}
    alike: dict[str, tuple[str, ...]] = {}
    for joint, own in of.items():
        same = first.setdefault(_form(joint, own, places), joint)
        alike[same] = (*alike.get(same, ()), *([joint] if joint != same else []))
    shown = tuple(constraint for joint in alike for constraint in of[joint])
    return ConstraintsShownOnce(shown, {joint: others for joint, others in alike.items() if others})


def _form(joint: str, constraints: Iterable[Constraint], places: Mapping[str, int]) -> Hashable:
    """All parts of the constraints of a joint, with the numbers of its bodies, in their order, in place of names."""
    own = tuple(constraints)
    symbols = {s for c in own for s in c.position.free_symbols if isinstance(s, Symbol)}
    bodies = sorted({s.identity.owner for s in symbols} & places.keys(), key=places.__getitem__)
    names = {**{body: str(number) for number, body in enumerate(bodies, 1)}, joint: "joint"}
    change = {s: owned(s, names[s.identity.owner]) for s in symbols if s.identity.owner in names}
    return tuple((c.unit, c.force_unit, _changed(c.position, change)) for c in own)


def _changed(expr: sp.Expr, change: Mapping[sp.Symbol, sp.Symbol]) -> sp.Expr:
    return expr.xreplace(dict(change))
