"""Damping of the deformation of a body in several components, which acts between these."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.generic_forces import DAMPING_TERM
from derive.mechanics.multibody.bodies.body_type import ComponentDamping
from derive.mechanics.multibody.forces.force_type import GeneralisedForce
from derive.mechanics.symbols import Family, identity, owned
from derive.mechanics.terms import ModelConstant, Term

if TYPE_CHECKING:
    from derive.mechanics.multibody.instances import InstanceEquations


def shared_damping(rod: str, components: tuple[str, ...], entries: Iterable[ModelConstant]) -> ComponentDamping:
    """The damping of a rod in several components by the entries of its matrix; equal entries share a constant."""
    symbols, constants = dict[tuple[int, int], sp.Symbol](), dict[sp.Expr, ModelConstant]()
    for c in (c for c in entries if not c.zero):
        i, j = c.symbol.identity.shapes
        doc = f"damping of amplitudes {i} and {j} of {rod}, counted through its pieces; also of equal entries"
        entry = replace(c, symbol=owned(c.symbol, rod), doc=doc)
        symbols[i, j] = constants.setdefault(c.value, entry).symbol
    return ComponentDamping(components, symbols, tuple(constants.values()))


def damping_force(damping: ComponentDamping, instances: Mapping[str, InstanceEquations]) -> GeneralisedForce:
    """The damping forces B alphadot on the amplitudes of the components of a body, and their power."""
    every = (row for name in damping.components for row in instances[name].rows)
    rows = [row for row in every if identity(row.v).family is Family.AMPLITUDE]
    forces: dict[str, list[sp.Expr]] = {}
    for (i, j), entry in damping.entries.items():
        first, second = rows[i - 1], rows[j - 1]
        forces.setdefault(first.name, []).append(entry * second.v)
        if i != j:
            forces.setdefault(second.name, []).append(entry * first.v)
    totals = {name: sp.Add(*force) for name, force in forces.items()}
    terms = tuple(Term(row, DAMPING_TERM.name, DAMPING_TERM.equation, total) for row, total in totals.items())
    power = sp.Add(*(totals[row.name] * row.v for row in rows if row.name in totals))
    return GeneralisedForce(terms, dissipation=-power)
