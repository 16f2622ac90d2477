"""Haug's conjecture in numbers: pivots of the KKT matrix in two frames, in elimination orders that are determined once.

"He expects that the sparse matrix symbolic factorization will be substantially more stable when there is a larger
number of precisely zero terms in the system mass matrix" (the paper, concluding remarks).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from derive.backends.model_files import explicit_files
from derive.derivation import derive
from derive.errors import TisserandError
from derive.ir.patterns import Pattern, pattern
from derive.lowering.flat.context import Context
from derive.lowering.flat.kkt_matrix import DependentConstraints, kkt_pattern
from derive.lowering.flat.lower import lower
from derive.runtime.compiler import UNOPTIMISED
from derive.runtime.interpreted_scene import with_iteration_matrix
from derive.runtime.loading import load_scene
from derive.runtime.native_call import Matrix
from derive.simulation.errors import RedundantConstraints
from derive.study.elimination import backward_error, eliminate, entry_mask, equilibrated, kkt_systems
from derive.study.pivot_orders import ORDERS, Order, without_diagonal
from derive.study.states import simulated_states, undeformed_states
from derive.study.variants import OperationCounts, SceneVariant, operation_counts
from derive.terminal import Report

SINGULAR = (
    "study pivots compares elimination orders by their pivots; where joints are redundant, the KKT matrix is singular, "
    "and a pivot vanishes in every order"
)


class RedundantJoints(TisserandError):
    """Joints of a scene are redundant, so that the study has nothing to compare."""


TRIAL_STATES = 40
"""The number of states of each kind, about, in which random numberings are tried."""


@dataclass(frozen=True)
class PivotStatistics:
    """The pivots of one order in some states, with rows and columns scaled: the worst values, and the median growth.

    without_diagonal: the pivots that are zero by structure. vanishing: the others that vanish in a state or between two
    where no earlier pivot does. failures: the states without a result. smallest: the least pivot, divided by the
    largest entry of its column.
    """

    without_diagonal: int
    vanishing: int
    failures: int
    smallest: float
    typical_growth: float
    growth: float
    backward_error: float


@dataclass(frozen=True)
class StateStatistics:
    """One frame in some states: the entries of M and of the KKT matrix that vanish in a state or between two, condition
    numbers, the backward error of LU with partial pivoting, and the pivots of each order."""

    states: int
    vanishing_mass: int
    vanishing_kkt: int
    condition: float
    scaled_condition: float
    pivoted_backward_error: float
    orders: dict[str, PivotStatistics]


@dataclass(frozen=True)
class FrameStability:
    """The stability of one frame.

    neighbours: the average numbers of unknowns that a coordinate and a multiplier are coupled with. broken: for each
    order the share of `numberings` of the unknowns in which a pivot vanishes.
    """

    frame: str
    counts: OperationCounts
    neighbours: tuple[float, float]
    undeformed: StateStatistics
    simulated: StateStatistics
    numberings: int
    broken: dict[str, float]


def frame_stability(variant: SceneVariant, count: int, numberings: int, step: str, task: Report) -> FrameStability:
    """The pivots of a variant in `count` states of each kind. step: the text of this variant among others.

    task: called with a line on each part of the work.

    Raises SpecError, CompilerError, SimulationError; RedundantJoints where joints are redundant.
    """
    try:
        return _frame_stability(variant, count, numberings, step, task)
    except DependentConstraints as error:
        raise RedundantJoints(f"{SINGULAR}. {error}") from None
    except RedundantConstraints as error:
        raise RedundantJoints(f"{SINGULAR}: {'; '.join(map(str, error.redundant))}") from None


def _frame_stability(variant: SceneVariant, count: int, numberings: int, step: str, task: Report) -> FrameStability:
    label = f"{step}{variant.scene.name}, {variant.frame} frame: "
    task(f"{label}deriving and compiling ...")
    equations = derive(variant.scene).expanded()
    model = lower(equations, explicit=True, balanced=variant.scene.start is not None)
    native = with_iteration_matrix(load_scene(explicit_files(model, variant.scene), UNOPTIMISED), model)
    k, shape = native.setup(), kkt_pattern(Context(equations))
    task(f"{label}simulating ...")
    moving_states = simulated_states(variant.scene, native, k, count)
    kinds = (undeformed_states(variant.scene, native, k, moving_states), moving_states)
    task(f"{label}eliminating ...")
    at_rest, moving = (kkt_systems(native, k, kind) for kind in kinds)
    largest = np.maximum(np.abs(at_rest[0]).max(axis=0), np.abs(moving[0]).max(axis=0))
    scaled_at_rest, scaled = equilibrated(*at_rest), equilibrated(*moving)
    orders = {name: order(shape, native.nv, scaled_at_rest[0][0]) for name, order in ORDERS.items()}
    some = slice(None, None, max(1, count // TRIAL_STATES))
    tried = [np.concatenate([a[some], b[some]]) for a, b in zip(scaled_at_rest, scaled, strict=True)]
    return FrameStability(
        variant.frame,
        operation_counts(equations, model),
        _neighbours(shape, native.nv),
        _statistics(
            at_rest[0], vanishing(at_rest[0], largest, entry_mask(shape)), scaled_at_rest, shape, native.nv, orders
        ),
        _statistics(moving[0], vanishing(moving[0], largest, entry_mask(shape)), scaled, shape, native.nv, orders),
        numberings,
        broken(shape, native.nv, (scaled_at_rest[0][0], at_rest[0][0]), (tried[0], tried[1]), numberings, label, task),
    )


def broken(
    shape: Pattern,
    coordinates: int,
    firsts: tuple[Matrix, Matrix],
    system: tuple[Matrix, Matrix],
    numberings: int,
    label: str,
    task: Report,
) -> dict[str, float]:
    """The share of numberings of the unknowns, the given one and random ones, in which a pivot of each order vanishes.

    Orders break ties by the numbers of the unknowns, so that the result of one numbering may be chance; and orders that
    depend on values depend on units. They therefore use the matrices of `firsts` alternately, the first matrix scaled
    and in SI units. Coordinates keep the numbers before those of multipliers.
    """
    random, failed = np.random.default_rng(1988), dict.fromkeys(ORDERS, 0)
    new, multipliers = np.arange(shape.rows), shape.rows - coordinates
    for number in range(numberings):
        task(f"{label}numbering {number + 1} of {numberings} ...")
        place = np.argsort(new)
        pairs = ((int(place[i]), int(place[j])) for i, j in shape.entries)
        again = pattern(shape.rows, shape.cols, {(max(p), min(p)) for p in pairs}, symmetric=True)
        for name, order in ORDERS.items():
            renumbered = order(again, coordinates, firsts[number % 2][np.ix_(new, new)])
            back = Order(tuple(int(new[i]) for i in renumbered.rows), tuple(int(new[j]) for j in renumbered.cols))
            failed[name] += bool(np.any(eliminate(*system, back.rows, back.cols).vanished))
        new = np.concatenate([random.permutation(coordinates), coordinates + random.permutation(multipliers)])
    return {name: count / numberings for name, count in failed.items()}


def vanishing(A: Matrix, scale: Matrix, there: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The mask (n, n) of the structural entries that vanish in one of the matrices (states, n, n), or between two.

    there: the mask of structural entries. scale (n, n): their largest values; an entry below 1e-12 of it has vanished.
    """
    zero = np.any(np.abs(A) <= 1e-12 * scale, axis=0)
    changed = np.any(A[1:] * A[:-1] < 0, axis=0)
    return np.asarray(there & (zero | changed))


def _statistics(
    raw: Matrix,
    gone: NDArray[np.bool_],
    scaled: tuple[Matrix, Matrix],
    shape: Pattern,
    coordinates: int,
    orders: dict[str, Order],
) -> StateStatistics:
    A, b = scaled
    pivoted = np.asarray(np.linalg.solve(A, b[:, :, None])[:, :, 0], dtype=np.float64)
    return StateStatistics(
        states=len(A),
        vanishing_mass=int(gone[:coordinates, :coordinates].sum()),
        vanishing_kkt=int(gone.sum()),
        condition=float(np.linalg.cond(raw).max()),
        scaled_condition=float(np.linalg.cond(A).max()),
        pivoted_backward_error=float(backward_error(A, b, pivoted).max()),
        orders={name: _pivots(A, b, shape, coordinates, order) for name, order in orders.items()},
    )


def _pivots(A: Matrix, b: Matrix, shape: Pattern, coordinates: int, order: Order) -> PivotStatistics:
    elimination = eliminate(A, b, order.rows, order.cols)
    missing = without_diagonal(shape, coordinates, order)
    return PivotStatistics(
        without_diagonal=missing,
        vanishing=int(elimination.vanished.sum()) - (missing > 0),
        failures=int(elimination.failed.sum()),
        smallest=float(np.nanmin(elimination.ratios)),
        typical_growth=float(np.median(elimination.growth)),
        growth=float(elimination.growth.max()),
        backward_error=float(backward_error(A, b, elimination.x).max()),
    )


def _neighbours(shape: Pattern, coordinates: int) -> tuple[float, float]:
    others = entry_mask(shape).sum(axis=1) - np.diag(entry_mask(shape))
    return float(others[:coordinates].mean()), float(others[coordinates:].mean()) if len(others) > coordinates else 0.0
