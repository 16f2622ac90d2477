"""Accelerations of a table model: shapes are eliminated, since their mass matrix c8 is constant; six rows are left."""

from __future__ import annotations

import casadi as ca
import sympy as sp

from derive.ir.model import Kernel, Section
from derive.ir.patterns import pattern
from derive.ir.statements import Require, Requirement, ReturnCode, Store, StoreLocal, StoreStrided, TriangularSolve
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.functions import VANISHING
from derive.lowering.functions import ModelFunction
from derive.lowering.ldlt import elimination_order, factorise, solve
from derive.lowering.loops.program import NOTHING, Elements, IndexedStore, Program, Scalar, Target
from derive.lowering.loops.tables import RIGID, SHAPE, Tables
from derive.mechanics.sums import Total
from derive.mechanics.symbols import Family, I, local, quantity
from derive.mechanics.tables import TableKind


def accel(tables: Tables, function: ModelFunction) -> Kernel:
    """M vdot = -h by the Schur complement of the shapes, whose mass matrix c8 is constant: factorised in setup."""
    program = tables.program(tables.q, tables.v)
    coupled = tuple(tables.coupling)
    b = {r: local("B", r + 1, shapes=(I,)) for r in coupled}
    h = local("h", shapes=(I,))
    scalars: list[Scalar] = [(local(f"h_{name}"), tables.at_rest(tables.left[name])) for name in tables.rows]
    places = [(r, c) for c in range(RIGID) for r in range(c, RIGID) if tables.mass_entry(r, c) != 0]
    scalars += [(local("M", r + 1, c + 1), tables.mass_entry(r, c)) for r, c in places]
    rows: list[IndexedStore] = [(StoreLocal("h", NOTHING), tables.at_rest(tables.left[SHAPE]))] if tables.n else []
    rows += [(StoreLocal(f"B_{r + 1}", NOTHING), tables.coupling[r]) for r in coupled]
    program.phase("h and B", "(15)", "forces, and coupling of rigid-body motion and modes", scalars, rows)
    arrays = ("h", *(f"B_{r + 1}" for r in coupled))
    weight = sp.S.One
    if tables.c8 is TableKind.FULL and tables.n:
        program.sections.append(_substituted(tables, arrays, transposed=False))
    elif tables.c8 is TableKind.DIAGONAL:
        weight = 1 / quantity(Family.C8, shapes=(I,))
    totals = [
        Total(local("BB", r + 1, c + 1), sp.S.Zero, weight * b[r] * b[c], "B^T c8^-1 B")
        for c in coupled
        for r in coupled
        if r >= c
    ]
    totals += [Total(local("Bh", r + 1), sp.S.Zero, weight * b[r] * h, "B^T c8^-1 h") for r in coupled]
    program.reduce(totals if tables.n else [])
    _rigid_accelerations(tables, program, places, coupled)
    rest = h + sum((b[r] * tables.rigid_rows[r].a for r in coupled), sp.S.Zero)
    if tables.n:
        x = local("x", shapes=(I,))
        program.phase(
            "alphaddot",
            "(15)",
            "accelerations of the modal amplitudes",
            (),
            [(StoreLocal("x", NOTHING), -weight * rest)],
        )
        if tables.c8 is TableKind.FULL:
            program.sections.append(_substituted(tables, ("x",), transposed=True))
        program.phase(
            "vdot", "", "accelerations of the modal amplitudes", (), [(StoreStrided("vdot", RIGID, 1, NOTHING), x)]
        )
        program.reduce([Total(local("shapes"), sp.S.Zero, x, "sum that is finite if all are")])
    every = sp.Add(*(row.a for row in tables.rigid_rows), *([local("shapes")] if tables.n else []))
    finite = Require(Requirement.FINITE, NOTHING, ReturnCode.NOT_FINITE, "an acceleration is not finite")
    program.scalars("check", "", "check that the result is finite", [(finite, every)])
    names = tuple(str(row.a) for row in tables.rigid_rows)
    labels = (*names, *([f"alpha1ddot .. alpha{tables.n}ddot"] if tables.n else []))
    return program.kernel(
        function,
        tables.inputs,
        {"vdot": Elements(labels, RIGID + tables.n)},
        method=", by the Schur complement of the modes and a sparse LDL^T of the rest.",
    )


def _substituted(tables: Tables, arrays: tuple[str, ...], transposed: bool) -> Section:
    doc = "back substitution with the Cholesky factor of c8" if transposed else "forward substitution with it"
    return Section("c8", "appendix", doc, (TriangularSolve("root", tables.n, arrays, transposed),))


def _rigid_accelerations(
    tables: Tables, program: Program, places: list[tuple[int, int]], coupled: tuple[int, ...]
) -> None:
    """Solve the Schur complement for the six rigid accelerations."""
    schur = {(r, c) for r in coupled for c in coupled if r >= c}
    shape = pattern(RIGID, RIGID, schur | set(places), symmetric=True)

    def make(symbols: Symbols) -> list[tuple[Target, ca.SX]]:
        def known(label: str, *components: int) -> ca.SX:
            return symbols.values[local(label, *components)]

        whole = {(r, c): known("M", r + 1, c + 1) for r, c in places}
        entries = dict(whole)
        for r, c in schur:
            inner = known("BB", r + 1, c + 1)
            entries[r, c] = whole[r, c] - inner if (r, c) in whole else -inner
        right = [
            -known(f"h_{name}") + (known("Bh", r + 1) if r in coupled else 0) for r, name in enumerate(tables.rows)
        ]
        factors = factorise(shape, {entry: entries[entry] for entry in shape.entries})
        solution = solve(factors, right)
        margin = symbols.number(VANISHING)
        wants: list[tuple[Target, ca.SX]] = [
            (
                Require(Requirement.POSITIVE, NOTHING, ReturnCode.PIVOT, f"the pivot of {tables.rows[j]} vanished"),
                pivot - margin * whole[j, j],
            )
            for pivot, j in zip(factors.pivots, factors.order, strict=True)
        ]
        for r, x in enumerate(solution):
            wants.append((tables.rigid_rows[r].a, x))
            wants.append((Store("vdot", r, NOTHING), x))
        return wants

    order = ", ".join(tables.rows[j] for j in elimination_order(shape))
    program.straight("vdot", "LDL^T", f"accelerations of the rigid motion: eliminate {order}", make)
