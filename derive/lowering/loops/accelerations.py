"""Accelerations with loops: the modes are eliminated, since their mass matrix c8 is constant; six rows remain."""

from __future__ import annotations

import casadi as ca

from derive.algebra import sp
from derive.ir.kernel import Kernel, Section
from derive.ir.patterns import pattern
from derive.ir.statements import Require, Requirement, ReturnCode, Store, StoreLocal, StoreStrided, TriangularSolve
from derive.lowering.elimination_orders import elimination_order
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.ldlt import VANISHING, factorise, solve
from derive.lowering.loops.assignments import NOTHING, IndexedStore, Scalar, Target
from derive.lowering.loops.context import RIGID, SHAPE, LoopContext
from derive.lowering.loops.program import Program
from derive.lowering.model_functions import ModelFunction, OutputElements
from derive.mechanics.sums import ModeSum
from derive.mechanics.symbols import Family, I, is_indexed, local, quantity
from derive.mechanics.tables import TableKind
from derive.roles import Source


def accel(context: LoopContext, function: ModelFunction) -> Kernel:
    """M vdot = -h by the Schur complement of the shapes, whose mass matrix c8 is constant: factorised in setup."""
    program = context.program(context.q, context.v)
    coupled = tuple(context.coupling)
    named = context.c8 is TableKind.FULL  # what the substitution overwrites has its own array
    b = {r: e if is_indexed(e) and not named else local("B", r + 1, shapes=(I,)) for r, e in context.coupling.items()}
    computed = [r for r in coupled if b[r] != context.coupling[r]]
    moving = _moving(context)
    h = local("h", shapes=(I,))
    scalars: list[Scalar] = [
        (local(f"h_{context.rows[r]}"), context.at_rest(context.left[context.rows[r]])) for r in moving
    ]
    nonzeros = [(r, c) for c in moving for r in moving if r >= c and context.mass_entry(r, c) != 0]
    scalars += [(local("M", r + 1, c + 1), context.mass_entry(r, c)) for r, c in nonzeros]
    rows: list[IndexedStore] = [(StoreLocal("h", NOTHING), context.at_rest(context.left[SHAPE]))] if context.n else []
    rows += [(StoreLocal(f"B_{r + 1}", NOTHING), context.coupling[r]) for r in computed]
    program.sums([*(e for _, e in scalars), *(e for _, e in rows), *b.values()])  # all tables in one pass
    program.phase("h and B", "(15)", "forces, and coupling of rigid-body motion and modes", scalars, rows)
    arrays = ("h", *(f"B_{r + 1}" for r in computed))
    weight = sp.S.One
    if context.c8 is TableKind.FULL and context.n:
        program.sections.append(_substituted(context, arrays, transposed=False))
    elif context.c8 is TableKind.DIAGONAL:
        weight = 1 / quantity(Family.C8, shapes=(I,))
    mode_sums = [
        ModeSum(local("BB", r + 1, c + 1), sp.S.Zero, weight * b[r] * b[c], "B^T c8^-1 B")
        for c in coupled
        for r in coupled
        if r >= c
    ]
    mode_sums += [ModeSum(local("Bh", r + 1), sp.S.Zero, weight * b[r] * h, "B^T c8^-1 h") for r in coupled]
    program.add_mode_sums(mode_sums if context.n else [])
    _rigid_accelerations(context, program, nonzeros, coupled, moving)
    rest = h + sum((b[r] * context.rigid_rows[r].a for r in coupled), sp.S.Zero)
    if context.n:
        x = local("x", shapes=(I,))
        doc = "accelerations of the modal amplitudes"
        modes: IndexedStore = (StoreLocal("x", NOTHING), -weight * rest)
        stored: IndexedStore = (StoreStrided("vdot", RIGID, 1, NOTHING), x if named else -weight * rest)
        program.phase("alphaddot", "(15)", doc, (), [modes] if named else [modes, stored])
        if named:
            program.sections.append(_substituted(context, ("x",), transposed=True))
            program.phase("vdot", "", doc, (), [stored])
        program.add_mode_sums([ModeSum(local("shapes"), sp.S.Zero, x, "sum that is finite if all are")])
    every = sp.Add(*(context.rigid_rows[r].a for r in moving), *([local("shapes")] if context.n else []))
    finite = Require(Requirement.FINITE, NOTHING, ReturnCode.NOT_FINITE, "an acceleration is not finite")
    program.scalars("check", "", "check that the result is finite", [(finite, every)])
    names = tuple(str(row.a) for row in context.rigid_rows)
    labels = (*names, *([f"alpha1ddot .. alpha{context.n}ddot"] if context.n else []))
    return program.kernel(
        function,
        context.inputs,
        {"vdot": OutputElements(labels, count=RIGID + context.n)},
        method=", by the Schur complement of the modes and a sparse LDL^T of the rest.",
    )


def _substituted(context: LoopContext, arrays: tuple[str, ...], transposed: bool) -> Section:
    doc = "back substitution with the Cholesky factor of c8" if transposed else "forward substitution with it"
    return Section("c8", Source.APPENDIX, doc, (TriangularSolve("root", context.n, arrays, transposed),))


def _moving(context: LoopContext) -> tuple[int, ...]:
    """The rigid rows with a force or with a coupling; the acceleration of another one, without weight, is zero."""
    coupled = set(context.coupling)
    coupled |= {k for r in range(RIGID) for c in range(r) if context.mass_entry(r, c) != 0 for k in (r, c)}
    return tuple(r for r, name in enumerate(context.rows) if r in coupled or context.at_rest(context.left[name]) != 0)


def _rigid_accelerations(
    context: LoopContext,
    program: Program,
    nonzeros: list[tuple[int, int]],
    coupled: tuple[int, ...],
    moving: tuple[int, ...],
) -> None:
    """Solve the Schur complement for the rigid accelerations."""
    schur = {(r, c) for r in coupled for c in coupled if r >= c}
    present = {(moving.index(r), moving.index(c)) for r, c in schur | set(nonzeros)}
    shape = pattern(len(moving), len(moving), present, symmetric=True)

    def make(symbols: Symbols) -> list[tuple[Target, ca.SX]]:
        def known(label: str, *components: int) -> ca.SX:
            return symbols.values[local(label, *components)]

        whole = {(r, c): known("M", r + 1, c + 1) for r, c in nonzeros}
        entries = dict(whole)
        for r, c in schur:
            inner = known("BB", r + 1, c + 1)
            entries[r, c] = whole[r, c] - inner if (r, c) in whole else -inner
        right = [-known(f"h_{context.rows[r]}") + (known("Bh", r + 1) if r in coupled else 0) for r in moving]
        factors = factorise(shape, {(i, j): entries[moving[i], moving[j]] for i, j in shape.entries})
        solution = solve(factors, right)
        margin = symbols.number(VANISHING)
        wants: list[tuple[Target, ca.SX]] = [
            (
                Require(
                    Requirement.POSITIVE, NOTHING, ReturnCode.PIVOT, f"the pivot of {context.rows[moving[j]]} vanished"
                ),
                pivot - margin * whole[moving[j], moving[j]],
            )
            for pivot, j in zip(factors.pivots, factors.order, strict=True)
        ]
        for r, x in zip(moving, solution, strict=True):
            wants.append((context.rigid_rows[r].a, x))
            wants.append((Store("vdot", r, NOTHING), x))
        return wants + [(Store("vdot", r, NOTHING), ca.SX(0)) for r in range(RIGID) if r not in moving]

    order = ", ".join(context.rows[moving[j]] for j in elimination_order(shape))
    program.straight("vdot", Source.FACTORISATION, f"accelerations of the rigid motion: eliminate {order}", make)
