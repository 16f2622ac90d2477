"""The structural zeros of the shape integrals and their reasons: frame, orthogonality, mirror symmetry, exact sum."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations_with_replacement

import numpy as np

from derive.mechanics.zero_reasons import (
    AT_CENTRE,
    CONDITION_17,
    CONDITION_19,
    EXACT_SUM,
    ORTHONORMAL,
    SECOND_17,
    SECOND_19,
    UNDAMPED,
)
from derive.reduction.arithmetic import Array
from derive.reduction.integrals import Integrals

PAIRS = tuple(combinations_with_replacement(range(3), 2))
"""The components (a, b), a <= b, of a symmetric tensor."""
AXIAL_PAIRS = ((1, 2), (2, 0), (0, 1))
"""The components (a, b) of the product of which component k of an axial vector is the antisymmetric part."""
SCALAR = 3
"""The component of a scalar factor, whose parity is that of its field alone."""
SECOND_ORDER_TABLES = ("S5", "c9", "c10")
"""The tables to which fields of second order contribute."""
SECOND_ORDER_PARITY = 1e-5
"""The largest entry that a mirror symmetry forbids, relative to the others, up to which second-order fields have it."""


@dataclass(frozen=True, eq=False)
class Parities:
    """The mirror planes of a body, and the parities of its fields under reflection.

    axes: the axis, 0 to 2, of the normal of each plane. fields (N + 1, planes): the parity of X (row 0) and of each
    mode (rows 1 to N): 1 even, -1 odd, 0 neither. elastic: whether the stiffness is symmetric about each plane.
    """

    axes: tuple[int, ...]
    fields: Array
    elastic: tuple[bool, ...]


@dataclass(frozen=True)
class IntegralEntry:
    """An independent entry of an integral, of the stiffness or of the damping.

    name: as in the derivation. table, index: where `with_exact_zeros` stores it. factors: those of the integrand as
    pairs (field, component), where field 0 is X and field i is mode i. A field of second order Psi_ij is a product of
    modes i and j in its parity.
    """

    name: str
    table: str
    index: tuple[int, ...]
    factors: tuple[tuple[int, int], ...]


def integral_entries(n: int, second_order: bool = False) -> Iterator[IntegralEntry]:
    """The independent entries of all integrals of a body with n modes, and of its stiffness and damping."""
    shapes = range(1, n + 1)
    for k in range(3):
        yield IntegralEntry(f"c1_{k + 1}", "c1", (k,), ((0, k),))
    for i in shapes:
        for k in range(3):
            yield IntegralEntry(f"c2_{i}_{k + 1}", "c2", (i - 1, k), ((i, k),))
    for a, b in PAIRS:
        yield IntegralEntry(f"C3_{a + 1}{b + 1}", "C3", (a, b), ((0, a), (0, b)))
    for i in shapes:
        for a, b in PAIRS:
            yield IntegralEntry(f"C4_{i}_{a + 1}{b + 1}", "S4", (i - 1, a, b), ((i, a), (0, b)))
    for i in shapes:
        for j in shapes[i - 1 :]:
            for a, b in PAIRS:
                yield IntegralEntry(f"C5_{i}_{j}_{a + 1}{b + 1}", "S5", (i - 1, j - 1, a, b), ((i, a), (j, b)))
    for i in shapes:
        for k, (a, b) in enumerate(AXIAL_PAIRS):
            yield IntegralEntry(f"c6_{i}_{k + 1}", "c6", (i - 1, k), ((0, a), (i, b)))
    for i in shapes:
        for j in shapes[i:]:
            for k, (a, b) in enumerate(AXIAL_PAIRS):
                yield IntegralEntry(f"c7_{i}_{j}_{k + 1}", "c7", (i - 1, j - 1, k), ((i, a), (j, b)))
    if second_order:
        yield from _second_order_entries(n)
    for name, table in (("c8", "c8"), ("K", "stiffness"), ("B", "damping")):
        for i in shapes:
            for j in shapes[i - 1 :]:
                yield IntegralEntry(f"{name}_{i}_{j}", table, (i - 1, j - 1), ((i, SCALAR), (j, SCALAR)))


def _second_order_entries(n: int) -> Iterator[IntegralEntry]:
    """The independent entries of c9 and c10."""
    pairs = tuple(combinations_with_replacement(range(1, n + 1), 2))
    for i, j in pairs:
        for k in range(3):
            yield IntegralEntry(f"c9_{i}_{j}_{k + 1}", "c9", (i - 1, j - 1, k), ((i, k), (j, SCALAR)))
    for i, j in pairs:
        for k, (a, b) in enumerate(AXIAL_PAIRS):
            factors = ((0, a), (i, b), (j, SCALAR))
            yield IntegralEntry(f"c10_{i}_{j}_{k + 1}", "c10", (i - 1, j - 1, k), factors)


def with_exact_zeros(
    integrals: Integrals, stiffness: Array, damping: Array, *, mean: bool, orthonormal: bool, parities: Parities
) -> tuple[Integrals, Array, Array, dict[str, str]]:
    """Integrals, stiffness and damping with exact structural zeros (and ones), and the reason of each zero by name.

    mean: whether the frame is the mean frame. orthonormal: whether c8 is the unit matrix.
    """
    n = len(integrals.c2)
    names = ("c1", "c2", "C3", "S4", "S5", "c6", "c7", "c8")
    tables = {name: np.array(getattr(integrals, name)) + 0.0 for name in names}
    tables |= {"stiffness": np.array(stiffness) + 0.0, "damping": np.array(damping) + 0.0}
    second_order = integrals.c9 is not None and integrals.c10 is not None
    if integrals.c9 is not None and integrals.c10 is not None:
        tables |= {"c9": integrals.c9 + 0.0, "c10": integrals.c10 + 0.0}
    symmetric = _symmetric_planes(integrals.mass, tables, parities) if second_order else (True,) * len(parities.axes)
    undamped = not np.any(damping)
    if orthonormal:
        np.fill_diagonal(tables["c8"], 1.0)
    zeros: dict[str, str] = {}
    for entry in integral_entries(n, second_order):
        reason = (
            _by_frame(entry, mean=mean, orthonormal=orthonormal)
            or (UNDAMPED if undamped and entry.table == "damping" else "")
            or _by_mirror(entry, parities, symmetric)
        )
        if reason or tables[entry.table][entry.index] == 0.0:
            zeros[entry.name] = reason or EXACT_SUM
            tables[entry.table][entry.index] = 0.0
    _set_dependent_entries(tables, n)
    second = {name: tables[name] for name in ("c9", "c10") if name in tables}
    result = Integrals(integrals.mass, *(tables[name] for name in names), **second)
    return result, tables["stiffness"], tables["damping"], zeros


def _by_frame(entry: IntegralEntry, *, mean: bool, orthonormal: bool) -> str:
    """The reason why the frame or the orthogonality of the modes makes an entry zero; empty if they do not."""
    if mean and entry.table in ("c1", "c2", "c6"):
        return {"c1": AT_CENTRE, "c2": CONDITION_17, "c6": CONDITION_19}[entry.table]
    if mean and entry.table in ("c9", "c10"):
        return {"c9": SECOND_17, "c10": SECOND_19}[entry.table]
    diagonal = ("c8", "stiffness", "damping") if mean else ("c8", "stiffness")  # damping is that of the free modes
    if orthonormal and entry.table in diagonal and entry.index[0] != entry.index[1]:
        return ORTHONORMAL
    return ""


def _by_mirror(entry: IntegralEntry, parities: Parities, symmetric: tuple[bool, ...]) -> str:
    """The mirror plane under which the integrand is odd, so that its integral vanishes; empty if there is none.

    symmetric: whether fields of second order, if there are any, have the symmetry of each plane.
    """
    for plane, axis in enumerate(parities.axes):
        if entry.table in ("stiffness", "damping") and not parities.elastic[plane]:
            continue
        if entry.table in SECOND_ORDER_TABLES and not symmetric[plane]:
            continue
        if _parity(entry, parities, plane) == -1:
            return f"mirror symmetry in the plane normal to e{axis + 1}"
    return ""


def _parity(entry: IntegralEntry, parities: Parities, plane: int) -> float:
    """The parity of an integrand under reflection in a plane: 1 even, -1 odd, 0 neither."""
    parity = 1.0
    for field, component in entry.factors:
        parity *= parities.fields[field, plane] * (-1 if component == parities.axes[plane] else 1)
    return parity


def _symmetric_planes(mass: float, tables: dict[str, Array], parities: Parities) -> tuple[bool, ...]:
    """Whether the integrals of second-order fields, which are data of their own, have the symmetry of each plane."""

    own = [entry for entry in integral_entries(len(tables["c8"]), True) if entry.table in SECOND_ORDER_TABLES]
    length = math.sqrt(float(np.abs(tables["C3"]).max()) / mass)
    largest = {name: float(np.abs(tables[name]).max(initial=0.0)) for name in SECOND_ORDER_TABLES}
    inertia = max(largest["S5"], largest["c10"], largest["c9"] * length)
    limits = dict.fromkeys(SECOND_ORDER_TABLES, SECOND_ORDER_PARITY * inertia) | {
        "c9": SECOND_ORDER_PARITY * inertia / (length or 1.0)
    }

    def symmetric(plane: int) -> bool:
        odd = (entry for entry in own if _parity(entry, parities, plane) == -1)
        return all(abs(tables[entry.table][entry.index]) <= limits[entry.table] for entry in odd)

    return tuple(parities.elastic[plane] and symmetric(plane) for plane in range(len(parities.axes)))


def _set_dependent_entries(tables: dict[str, Array], n: int) -> None:
    """Set the dependent half of each symmetric or antisymmetric table from the independent half."""
    for a, b in PAIRS:
        tables["C3"][b, a] = tables["C3"][a, b]
        tables["S4"][:, b, a] = tables["S4"][:, a, b]
        tables["S5"][:, :, b, a] = tables["S5"][:, :, a, b]
    symmetric = ("S5", "c8", "stiffness", "damping", *(name for name in ("c9", "c10") if name in tables))
    for i in range(n):
        tables["c7"][i, i] = 0.0
        for j in range(i + 1, n):
            tables["c7"][j, i] = 0.0 - tables["c7"][i, j]
            for name in symmetric:
                tables[name][j, i] = tables[name][i, j]
