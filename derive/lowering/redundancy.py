"""Redundant constraints: which rows of a constraint Jacobian the others imply, by the names of their multipliers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from derive.enumerations import enumeration

Matrix = NDArray[np.float64]

INDEPENDENT = 1e-6
"""A row of length 1 is independent of others if more than this is left of it beside their span."""


@dataclass(frozen=True)
class Dependence:
    """A constraint, and those that together imply it; all by the names of their multipliers."""

    name: str
    on: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.name} is implied by {enumeration(self.on) or 'joints that eliminate coordinates'}"


def dependences(G: Matrix, rank: int, names: Sequence[str]) -> tuple[Dependence, ...]:
    """A minimal set of constraints that the others imply: the last ones, if the numbers allow the choice.

    G (nlambda, nv): the constraint Jacobian, its rows scaled to lengths near 1, with its rank. names (nlambda,): the
    names of the multipliers.
    """
    basis = _independent_rows(G, rank)
    rows = G[basis]
    result = []
    for i in (i for i in range(len(names)) if i not in basis):
        factors = np.linalg.lstsq(rows.T, G[i], rcond=None)[0] if basis else np.zeros(0)
        others = tuple(names[j] for j, factor in zip(basis, factors, strict=True) if abs(factor) > 1e-5)
        result.append(Dependence(names[i], others))
    return tuple(result)


def _independent_rows(G: Matrix, rank: int) -> list[int]:
    """`rank` independent rows: each that is not in the span of those before it, or else those that pivoting selects."""
    chosen: list[int] = []
    basis = np.zeros((0, G.shape[1]))
    for i, row in enumerate(G):
        rest = row - basis.T @ (basis @ row)
        rest -= basis.T @ (basis @ rest)
        size = np.linalg.norm(rest)
        if size > INDEPENDENT:
            chosen.append(i)
            basis = np.vstack([basis, rest / size])
    if len(chosen) == rank:
        return chosen
    from scipy.linalg import qr  # only where constraints depend on each other; its import takes a tenth of a second

    _, _, order = qr(G.T, mode="economic", pivoting=True)
    return sorted(int(i) for i in order[:rank])


def redundancy_text(redundant: Sequence[Dependence]) -> str:
    """The message on redundant constraints."""
    lines = [f"  {d}" for d in redundant]
    return "\n".join(
        [
            f"{len(redundant)} of the constraints are redundant:",
            *lines,
            "Their multipliers have no unique value. Remove as many constraints (a weaker kind of joint, or none), or "
            'let a body deform where the others hold it; a beam bends, but does not stretch. redundant = "resolve" in '
            "[scene] computes the reactions of least norm.",
        ]
    )
