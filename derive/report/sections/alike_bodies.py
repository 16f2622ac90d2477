"""Bodies of a scene whose equations of motion differ in names and constants alone: a page shows them once."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping
from dataclasses import dataclass, replace

from derive.algebra import sp
from derive.mechanics.equations import Equations
from derive.mechanics.generic_forces import DAMPING_TERM
from derive.mechanics.multibody.kinds import BodyInstance
from derive.mechanics.multibody.mechanism import Mechanism
from derive.mechanics.multibody.space.mechanism import SpatialMechanism
from derive.mechanics.symbols import identity, owned
from derive.mechanics.terms import Intermediate, ModelConstant
from derive.mechanics.typed_symbol import Symbol


@dataclass(frozen=True)
class EquationsShownOnce:
    """The equations of a scene without those of bodies that are like an earlier one.

    alike: the names of these bodies, by the name of the body whose equations are shown. owners: the bodies and the
    groups of pieces of rods whose constants are shown, by all bodies and groups. values: the constants of others with
    other values, by the constants that are shown and their owners.
    """

    equations: Equations
    alike: Mapping[str, tuple[str, ...]]
    owners: Mapping[str, str]
    values: Mapping[sp.Symbol, Mapping[str, ModelConstant]]


def shown_once(mechanism: Mechanism | SpatialMechanism) -> EquationsShownOnce:
    """The equations of a mechanism, of bodies that are alike those of the first.

    Bodies are alike if they are of one kind, keep the same coordinates, and bear the same forces. The damping between
    the pieces of a rod, which is another in each, does not count.
    """
    equations = mechanism.expanded()
    first: dict[Hashable, str] = {}
    alike: dict[str, tuple[str, ...]] = {}
    definitions: list[Intermediate] = []
    defined: dict[str, set[Hashable]] = {}
    owners = {instance.name: instance for instance in mechanism.instances if instance.moves}
    damped = {name for damping in mechanism.dampings for name in damping.components}
    shown = {name: first.setdefault(tuple(_form(of, equations, name in damped)), name) for name, of in owners.items()}
    for name, same in shown.items():
        alike[same] = (*alike.get(same, ()), *([name] if name != same else []))
    for d in equations.definitions:
        owner = identity(d.symbol).owner
        if owner in shown:
            form = _without_names(d.symbol, owners[owner]), _without_names(d.expr, owners[owner])
            known = defined.setdefault(shown[owner], set())
            if form in known:
                continue
            known.add(form)
        definitions.append(d)
    kept = [k for k, row in enumerate(equations.rows) if identity(row.v).owner in alike]
    rows = tuple(equations.rows[k] for k in kept)
    names = {row.name for row in rows}
    places = {k: place for place, k in enumerate(kept)}
    same_constants = _owners(shown, owners)
    constants, values = _constants(equations, same_constants)
    shorter = replace(
        equations,
        rows=rows,
        terms=tuple(term for term in equations.terms if term.row in names),
        definitions=tuple(definitions),
        coefficients=constants,
        vanished=tuple(v for v in equations.vanished if v.term.row in names),
        mass=equations.mass.extract(kept, kept),
        mass_zeros=tuple(
            (places[i], places[j], why) for i, j, why in equations.mass_zeros if i in places and j in places
        ),
    )
    others = {name: names for name, names in alike.items() if names}
    return EquationsShownOnce(shorter, others, same_constants, values)


def _owners(shown: Mapping[str, str], instances: Mapping[str, BodyInstance]) -> dict[str, str]:
    """The owners of constants that are shown, by those that are like them: bodies, and the groups of pieces of rods."""
    result: dict[str, str] = {}
    for name, same in shown.items():
        result[name] = same
        result.setdefault(instances[name].component.group, instances[same].component.group)
    return result


def _constants(
    equations: Equations, owners: Mapping[str, str]
) -> tuple[tuple[ModelConstant, ...], dict[sp.Symbol, dict[str, ModelConstant]]]:
    """The constants of bodies that are shown, and those of others with other values, see `EquationsShownOnce`."""
    shown: dict[Hashable, ModelConstant] = {}
    kept: list[ModelConstant] = []
    values: dict[sp.Symbol, dict[str, ModelConstant]] = {}
    for c in equations.coefficients:
        owner = identity(c.symbol).owner
        same = owners.get(owner, owner)
        known = shown.setdefault((same, owned(c.symbol, ""), c.zero), c)
        if known is c:
            kept.append(c)
        elif known.value != c.value:
            values.setdefault(known.symbol, {})[owner] = c
    return tuple(kept), values


def _form(instance: BodyInstance, equations: Equations, damped: bool) -> Iterator[Hashable]:
    """All parts of the equations of an instance, without its name and that of its constants.

    damped: whether its damping is that between the pieces of a rod, which is left out.
    """
    rows = {row.name: _without_names(row.v, instance) for row in instance.coordinates.rows}
    yield instance.kind, tuple(rows.values())
    for term in equations.terms:
        if term.row in rows and not (damped and term.name == DAMPING_TERM.name):
            yield rows[term.row], term.name, _without_names(term.expr, instance)
    for d in equations.definitions:
        known = identity(d.symbol)
        if known.owner == instance.name and not known.point:
            yield _without_names(d.symbol, instance), _without_names(d.expr, instance)


def _without_names(expr: sp.Expr, instance: BodyInstance) -> sp.Expr:
    """An expression in which the symbols of an instance have no owner."""
    own = (instance.name, instance.component.group)
    symbols = (s for s in expr.free_symbols if isinstance(s, Symbol) and s.identity.owner in own)
    return expr.xreplace({symbol: owned(symbol, "") for symbol in symbols})
