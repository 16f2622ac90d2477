"""Damping of the deformation of a body in several components, which acts between these."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.generic_forces import DAMPING_TERM
from derive.mechanics.multibody.bodies.body_type import ComponentDamping
from derive.mechanics.multibody.forces.force_type import GeneralisedForce
from derive.mechanics.symbols import Family, identity
from derive.mechanics.terms import Term

if TYPE_CHECKING:
    from derive.mechanics.multibody.instances import InstanceEquations


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
