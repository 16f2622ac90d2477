"""Expansion of the equations of motion: one row and its terms for each mode, without the terms that vanish."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import chain
from typing import TYPE_CHECKING, TypeAlias

from derive.algebra import sp
from derive.garbage_collection import paused
from derive.mechanics import zeros
from derive.mechanics.cubic_stiffness import cubic_energy, cubic_terms
from derive.mechanics.equations import Equations
from derive.mechanics.expanded_sums import ExpandedSums, expanded_moments, expanded_sums
from derive.mechanics.generic_forces import generic_forces
from derive.mechanics.motion.full_second_order import DependentAmplitudes
from derive.mechanics.motion.material_points import marker
from derive.mechanics.sums import of_index
from derive.mechanics.terms import EquationOfMotion, Intermediate, Reason, Term

if TYPE_CHECKING:
    from derive.mechanics.body import Body
    from derive.mechanics.motion.body_motion import Motion
    from derive.mechanics.typed_symbol import Symbol

Absent: TypeAlias = "dict[tuple[str, sp.Expr], list[Symbol]]"
"""The vanishing entries of sums by their row and their factor."""

TRANSLATIONS = "the mass enters as m I, so translations along different axes do not couple"


@paused()
def expand(body: Body) -> Equations:
    """The equations of motion of a body, with a row for each of its modes, from its virtual work.

    Entries of tables that vanish are left out, so that all terms, definitions and entries of M keep their own reasons.
    """
    motion, work, expanded = body.motion, body.virtual_work, _Expansion(body)
    dependent, sums, reasons, forces = expanded.dependent, expanded.sums, expanded.reasons, expanded.forces
    inertia = (*work.rigid, *_of_each_mode(body.field_motion, work.generic))
    weight = (*work.rigid_weight, *_of_each_mode(body.field_motion, work.generic_weight)) if body.gravity else ()
    applied = tuple(chain.from_iterable(_of_each_mode(motion, (force.term,)) for force in forces))
    applied += tuple(cubic_terms(body.constants, motion))
    written = expanded.written

    def total(*exprs: sp.Expr) -> sp.Expr:
        return zeros.drop(dependent.put_in(sums.put_in(sp.Add(*exprs)), reasons), reasons)

    projected = [dependent.projected(written(part), reasons) for part in (inertia, weight)]
    complete = (*projected[0].terms, *written(applied), *projected[1].terms)
    absent = _absent((*inertia, *applied), sums)
    for key, symbols in projected[0].absent.items():
        absent.setdefault(key, []).extend(symbols)
    terms, vanished = zeros.drop_terms(complete, reasons)
    return Equations(
        name=body.name,
        doc=body.doc,
        frame_doc=body.frame_doc,
        coordinates=motion.coordinates,
        rows=motion.rows,
        rates=motion.rates,
        parameters=body.parameters,
        coefficients=body.constants,
        definitions=expanded.definitions,
        terms=terms,
        vanished=tuple(v if v.reason else replace(v, reason=_identity(motion, v.term)) for v in vanished),
        mass=mass_matrix(motion.rows, terms),
        mass_zeros=_mass_zeros(motion, complete, reasons, absent),
        kinetic_energy=total(work.kinetic_energy, *(force.kinetic for force in forces)),
        strain_energy=total(*(force.strain for force in forces), cubic_energy(body.constants, motion)),
        weight_energy=total(work.weight_energy) if body.gravity else None,
        linear_momentum=tuple(map(total, work.linear_momentum)),
        angular_momentum=tuple(map(total, work.angular_momentum)),
        mass_moments=tuple(map(total, work.mass_moments)),
        markers=tuple(marker(motion, point) for point in body.points),
        body=body,
    )


class _Expansion:
    """The sums and amplitudes that terms of all rows of a body contain, and the definitions of moments."""

    def __init__(self, body: Body) -> None:
        motion, fields, work = body.motion, body.field_motion, body.virtual_work
        self.dependent = DependentAmplitudes(motion, fields)
        self.forces = generic_forces({c.symbol.identity.family for c in body.constants})
        needed = (*(work.gravity if body.gravity else ()), *self.dependent.definitions)
        first, reasons = zeros.drop_definitions(needed, zeros.reasons_of(body.constants))
        moments, self.reasons = _moments(self.dependent, fields, reasons)
        self.definitions = (*motion.rotation_definitions, *first, *moments)
        of_forces = expanded_sums(motion, chain.from_iterable(force.sums for force in self.forces), self.reasons)
        of_fields = expanded_sums(fields, fields.row_sums, () if self.dependent.numbers else self.reasons)
        self.sums = of_forces | of_fields

    def written(self, terms: Iterable[Term]) -> Iterator[Term]:
        """The terms with their sums expanded."""
        return (replace(t, expr=self.sums.put_in(t.expr)) for t in terms)


def rigid_rows(body: Body, kept: Collection[sp.Symbol] = ()) -> tuple[sp.Expr, ...]:
    """The force (N) and the torque about O (N m) that the motion of a body needs, besides its weight.

    In the plane the components are 1, 2 and about e3; in space three of the force along inertial axes, and three of the
    torque along those of the body. In the coordinates and the constants of the body, and the defined symbols that are
    `kept`. They are sums of terms of `expand`, which makes those of all rows, energies and momenta in three times as
    long.
    """
    work, expanded = body.virtual_work, _Expansion(body)
    weight = work.rigid_weight if body.gravity else ()
    complete = (
        expanded.dependent.projected(expanded.written(part), expanded.reasons).terms for part in (work.rigid, weight)
    )
    terms, _ = zeros.drop_terms(tuple(chain.from_iterable(complete)), expanded.reasons)
    known: dict[sp.Basic, sp.Expr] = {}
    for definition in expanded.definitions:  # each in terms of those before it
        if definition.symbol not in kept:
            known[definition.symbol] = definition.expr.xreplace(known)
    totals = (sp.Add(*(t.expr for t in terms if t.row == row.name)) for row in body.motion.rigid_rows)
    return tuple(total.xreplace(known) for total in totals)


def _moments(
    dependent: DependentAmplitudes, fields: Motion, reasons: zeros.Reasons
) -> tuple[tuple[Intermediate, ...], zeros.Reasons]:
    """The moments of the larger family of fields without vanishing parts, and the reasons with those of the moments."""
    if not dependent.numbers:
        return expanded_moments(fields, reasons)
    complete = expanded_moments(fields)[0]
    kept = (dependent.put_in(d.expr, reasons) for d in complete)
    in_amplitudes = (
        replace(d, expr=expr if expr != 0 else dependent.put_in(d.expr)) for d, expr in zip(complete, kept, strict=True)
    )
    return zeros.drop_definitions(tuple(in_amplitudes), reasons)


def _of_each_mode(motion: Motion, generic: tuple[Term, ...]) -> Iterator[Term]:
    """The terms of a generic mode, repeated for each mode."""
    for i, alpha in enumerate(motion.alpha, 1):
        for t in generic:
            yield replace(t, row=alpha.name, expr=of_index(t.expr, i))


def _absent(terms: Iterable[Term], sums: ExpandedSums) -> Absent:
    """The entries that vanish in the sums of terms, by the row and the factor that they have in it."""
    result: Absent = {}
    for term in terms:
        for symbol in term.expr.free_symbols & sums.absent.keys():
            for entry, factor in sums.absent[symbol]:
                result.setdefault((term.row, factor), []).append(entry)
    return result


def mass_matrix(rows: Sequence[EquationOfMotion], terms: Iterable[Term]) -> sp.ImmutableMatrix:
    """The factors of the accelerations in each row."""
    accelerations = [row.a for row in rows]
    exprs: dict[str, list[sp.Expr]] = {row.name: [] for row in rows}
    for term in terms:
        exprs[term.row].append(term.expr)
    factors = [linear_factors(sp.Add(*exprs[row.name]), accelerations) for row in rows]
    return sp.ImmutableMatrix([[row[a] for a in accelerations] for row in factors])


def linear_factors(expr: sp.Expr, symbols: Sequence[sp.Symbol]) -> dict[sp.Symbol, sp.Expr]:
    """The derivatives of an expression that is linear in some symbols: in a product, what stands beside the symbol.

    Much faster than derivatives of the whole, which look at every term for each symbol.
    """
    wanted, parts = set(symbols), {s: list[sp.Expr]() for s in symbols}
    for term in sp.Add.make_args(expr):
        beside = sp.Mul.make_args(term)
        own = wanted.intersection(beside)
        for symbol in own or wanted & term.free_symbols:
            alone = len(own) == 1 and sum(symbol in f.free_symbols for f in beside) == 1
            parts[symbol].append(sp.Mul(*(f for f in beside if f != symbol)) if alone else term.diff(symbol))
    return {symbol: sp.Add(*summands) if summands else sp.S.Zero for symbol, summands in parts.items()}


def _mass_zeros(
    motion: Motion, complete: tuple[Term, ...], reasons: zeros.Reasons, absent: Absent
) -> tuple[tuple[int, int, Reason], ...]:
    """The row, column and reason of each structural zero of the mass matrix (lower triangle).

    absent: the entries that the terms leave out.
    """
    full, n = mass_matrix(motion.rows, complete), len(motion.rows)
    lower = ((i, j, full[i, j]) for i in range(n) for j in range(i + 1))
    vanishing = ((i, j, entry) for i, j, entry in lower if entry == 0 or zeros.drop(entry, reasons) == 0)
    return tuple((i, j, _reason(motion, entry, reasons, absent, i, j)) for i, j, entry in vanishing)


def _reason(motion: Motion, entry: sp.Expr, reasons: zeros.Reasons, absent: Absent, i: int, j: int) -> Reason:
    """The reason of a zero of the mass matrix: the integrals in it, or that translations are independent."""
    gone = absent.get((motion.rows[i].name, motion.rows[j].a), ())
    known = Reason(zeros.behind((*entry.free_symbols, *gone), reasons))
    if known:
        return known
    if max(i, j) < motion.rotation.rows:
        return Reason(identity=TRANSLATIONS)
    raise ArithmeticError(f"entry {i}, {j} of the mass matrix vanishes without a reason")


def _identity(motion: Motion, term: Term) -> Reason:
    """The reason of a vanished term that contains no integral."""
    odd = "c7 is odd in its indices, so that one shape does not act on itself"
    known = motion.identities | {(str(a), "Coriolis"): odd for a in motion.alpha}
    if not motion.alpha:
        pairs = ((row.name, name) for row in motion.rows for name in ("Coriolis", "relative"))
        known |= dict.fromkeys(pairs, "a rigid body has no shapes")
    if (term.row, term.name) not in known:
        raise ArithmeticError(f"the {term.name} term of row {term.row} vanishes without a reason")
    return Reason(identity=known[term.row, term.name])
