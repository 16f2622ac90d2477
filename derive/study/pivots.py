"""Haug's conjecture in numbers: pivots of the KKT matrix in both frames, in orders that are found once and kept.

"He expects that the sparse matrix symbolic factorization will be substantially more stable when there is a larger
number of precisely zero terms in the system mass matrix" (the paper, concluding remarks).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from derive.backends.model_files import model_files
from derive.derivation import derive, lower
from derive.ir.patterns import Pattern, pattern
from derive.lowering.flat.constraints import kkt_pattern
from derive.lowering.flat.context import Context
from derive.mechanics.equations import Equations
from derive.runtime.native import Matrix, load_scene
from derive.study import states
from derive.study.counts import Counts, counts
from derive.study.eliminate import backward_error, eliminate
from derive.study.matrices import equilibrated, present, systems
from derive.study.orders import ORDERS, Order, without_diagonal
from derive.study.variants import Variant
from derive.terminal import show_progress

QUICK = ("-std=c99", "-O0", "-ffp-contract=off")
"""Flags of the compiler: here no time is measured."""

FEW = 40
"""About as many states of each kind are enough to try an order in."""


@dataclass(frozen=True)
class Pivots:
    """What one order gives in some states, rows and columns scaled: the worst of all, `typical_growth` the median.

    `without_diagonal` are zero by structure, `vanishing` others that vanish in a state or between two, if none before
    them does; `failures` are states without a result. `smallest` is a pivot over the largest entry of its column.
    """

    without_diagonal: int
    vanishing: int
    failures: int
    smallest: float
    typical_growth: float
    growth: float
    backward_error: float


@dataclass(frozen=True)
class Looked:
    """One frame in some states: entries of M and of the KKT matrix that vanish in one of them or between two, what LU
    with partial pivoting gives, and what each order does."""

    states: int
    vanishing_mass: int
    vanishing_kkt: int
    condition: float
    scaled_condition: float
    pivoted_backward_error: float
    orders: dict[str, Pivots]


@dataclass(frozen=True)
class InFrame:
    """One frame; `broken` is the share of `numberings` of the unknowns in which an order has a pivot that vanishes.

    `neighbours` are the average numbers of other unknowns that a coordinate and a multiplier are coupled with.
    """

    frame: str
    counts: Counts
    neighbours: tuple[float, float]
    undeformed: Looked
    simulated: Looked
    numberings: int
    broken: dict[str, float]


def look(variant: Variant, count: int, numberings: int) -> InFrame:
    """Look at one frame in `count` states of each kind. Raises SpecError, CompilerError, SimulationError."""
    said = f"{variant.scene.name}, {variant.frame} frame: "
    show_progress(f"{said}building")
    equations = derive(variant.scene)
    assert isinstance(equations, Equations)
    native = load_scene(model_files(lower(equations), variant.scene), QUICK)
    k, shape = native.setup(), kkt_pattern(Context(equations))
    show_progress(f"{said}simulating")
    moved = states.simulated(variant.scene, native, k, count)
    kinds = (states.undeformed(variant.scene, native, k, moved), moved)
    show_progress(f"{said}eliminating")
    at_rest, moving = (systems(native, k, kind) for kind in kinds)
    largest = np.maximum(np.abs(at_rest[0]).max(axis=0), np.abs(moving[0]).max(axis=0))
    scaled_at_rest, scaled = equilibrated(*at_rest), equilibrated(*moving)
    found = {name: order(shape, native.nv, scaled_at_rest[0][0]) for name, order in ORDERS.items()}
    some = slice(None, None, max(1, count // FEW))
    tried = [np.concatenate([a[some], b[some]]) for a, b in zip(scaled_at_rest, scaled, strict=True)]
    return InFrame(
        variant.frame,
        counts(equations),
        _neighbours(shape, native.nv),
        _looked(at_rest[0], vanishing(at_rest[0], largest, present(shape)), scaled_at_rest, shape, native.nv, found),
        _looked(moving[0], vanishing(moving[0], largest, present(shape)), scaled, shape, native.nv, found),
        numberings,
        broken(shape, native.nv, (scaled_at_rest[0][0], at_rest[0][0]), (tried[0], tried[1]), numberings, said),
    )


def broken(
    shape: Pattern,
    coordinates: int,
    firsts: tuple[Matrix, Matrix],
    system: tuple[Matrix, Matrix],
    numberings: int,
    said: str = "",
) -> dict[str, float]:
    """The share of numberings in which a pivot of an order vanishes: the one that is there, and random ones.

    Orders choose among equals by their numbers, so that what one numbering gives may be luck; and those that look at
    values depend on units. So they look at each of `firsts` by turns, the first matrix scaled and in SI units.
    Coordinates keep the numbers before multipliers.
    """
    random, failed = np.random.default_rng(1988), dict.fromkeys(ORDERS, 0)
    new, multipliers = np.arange(shape.rows), shape.rows - coordinates
    for number in range(numberings):
        show_progress(f"{said}numbering {number + 1} of {numberings}")
        place = np.argsort(new)
        pairs = ((int(place[i]), int(place[j])) for i, j in shape.entries)
        again = pattern(shape.rows, shape.cols, {(max(p), min(p)) for p in pairs}, symmetric=True)
        for name, order in ORDERS.items():
            found = order(again, coordinates, firsts[number % 2][np.ix_(new, new)])
            back = Order(tuple(int(new[i]) for i in found.rows), tuple(int(new[j]) for j in found.cols))
            failed[name] += bool(np.any(eliminate(*system, back.rows, back.cols).vanished))
        new = np.concatenate([random.permutation(coordinates), coordinates + random.permutation(multipliers)])
    return {name: count / numberings for name, count in failed.items()}


def vanishing(A: Matrix, scale: Matrix, there: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which structural entries (n, n) vanish in one of the matrices (states, n, n), or between two.

    Entries that are 1e-12 of their largest values, `scale`, have vanished.
    """
    zero = np.any(np.abs(A) <= 1e-12 * scale, axis=0)
    changed = np.any(A[1:] * A[:-1] < 0, axis=0)
    return np.asarray(there & (zero | changed))


def _looked(
    raw: Matrix,
    gone: NDArray[np.bool_],
    scaled: tuple[Matrix, Matrix],
    shape: Pattern,
    coordinates: int,
    orders: dict[str, Order],
) -> Looked:
    A, b = scaled
    pivoted = np.asarray(np.linalg.solve(A, b[:, :, None])[:, :, 0], dtype=np.float64)
    return Looked(
        states=len(A),
        vanishing_mass=int(gone[:coordinates, :coordinates].sum()),
        vanishing_kkt=int(gone.sum()),
        condition=float(np.linalg.cond(raw).max()),
        scaled_condition=float(np.linalg.cond(A).max()),
        pivoted_backward_error=float(backward_error(A, b, pivoted).max()),
        orders={name: _pivots(A, b, shape, coordinates, order) for name, order in orders.items()},
    )


def _pivots(A: Matrix, b: Matrix, shape: Pattern, coordinates: int, order: Order) -> Pivots:
    found = eliminate(A, b, order.rows, order.cols)
    missing = without_diagonal(shape, coordinates, order)
    return Pivots(
        without_diagonal=missing,
        vanishing=int(found.vanished.sum()) - (missing > 0),
        failures=int(found.failed.sum()),
        smallest=float(np.nanmin(found.ratios)),
        typical_growth=float(np.median(found.growth)),
        growth=float(found.growth.max()),
        backward_error=float(backward_error(A, b, found.x).max()),
    )


def _neighbours(shape: Pattern, coordinates: int) -> tuple[float, float]:
    others = present(shape).sum(axis=1) - np.diag(present(shape))
    return float(others[:coordinates].mean()), float(others[coordinates:].mean()) if len(others) > coordinates else 0.0
