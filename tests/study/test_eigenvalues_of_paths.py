"""Eigenvalues of a model over a parameter: rounding errors, rotating axes, and thresholds that are bracketed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from derive.study.stability.eigenvalues import Eigenvalues, eigenvalues
from derive.study.stability.thresholds import Threshold, intervals, loss, thresholds


def state_space(stiffness: Sequence[float], coupling: float = 0.0) -> np.ndarray:
    """Two displacements with a stiffness over the mass each, and a gyroscopic coupling."""
    A = np.zeros((4, 4))
    A[:2, 2:] = np.eye(2)
    A[2:, :2] = -np.diag(stiffness)
    A[2, 3], A[3, 2] = coupling, -coupling
    return A


def test_rounding_errors_do_not_grow() -> None:
    """The stiffness is zero: a double eigenvalue is split by their root; a true negative one grows."""
    assert eigenvalues(state_space([-1e-8, 1e6])).growing == 0
    assert eigenvalues(state_space([-1e-4, 1e6])).growing == 1
    assert eigenvalues(state_space([-1e-4, 1e6])).growth == pytest.approx(1e-2)
    assert eigenvalues(np.zeros((0, 0))).growing == 0
    free = state_space([-9.0, -9.0], 6.0)  # a free mass in axes that rotate at 3
    assert eigenvalues(free).growing == 0
    assert eigenvalues(free, spin=3.0).frequencies.size == 0
    assert eigenvalues(state_space([4, 9]), spin=3.0).frequencies == pytest.approx([2])


def counted(changes: Sequence[float]) -> tuple[list[float], list[int | None], tuple[Threshold, ...]]:
    """A count that changes by one at each value, over 0, 1, ..., 4; there is none above 3.5."""

    def count(x: float) -> int | None:
        return None if x > 3.5 else sum(x > c for c in changes) % 3

    values = [float(n) for n in range(5)]
    counts = [count(x) for x in values]
    return values, counts, thresholds(count, values, counts)


def test_frequencies_in_rotating_axes_are_those_of_modes_that_vibrate() -> None:
    """A mode that decays at once turns there at about the spin; a whirl near the critical speed is slow."""
    values = np.array([-500 + 9j, -0.3 + 0.2j, 20j, 3, -3], dtype=complex)
    made = Eigenvalues(values, np.full(len(values), 1e-9), spin=10.0)
    assert made.frequencies == pytest.approx([0.2, 20]) and made.diverging == 1


def test_two_equal_real_eigenvalues_are_two_growing_modes() -> None:
    """Of a symmetric shaft, which rounding makes a conjugate pair."""
    A = state_space([-4, -4])
    A[2, 1], A[3, 0] = 1e-13, -1e-13
    assert eigenvalues(A).growing == 2


def test_all_thresholds_between_two_values_are_bracketed() -> None:
    values, counts, found = counted([0.3, 0.4, 2.5])
    assert [c.value for c in found] == pytest.approx([0.3, 0.4, 2.5], rel=1e-6)
    assert [(c.before, c.after) for c in found] == [(0, 1), (1, 2), (2, 0)]
    known = intervals(values, counts, found)
    assert [i.stable for i in known] == [True, False, True, None]
    assert [i.low for i in known] == pytest.approx([0, 0.3, 2.5, 3]) and known[-1].high == 4
    assert loss(known) == pytest.approx(0.3)
    assert loss(known[1:]) is None


def test_numbers_that_keep_changing_are_given_up() -> None:
    calls: list[float] = []

    def count(x: float) -> int:
        calls.append(x)
        return int(x * 2**16) % 5

    assert thresholds(count, [0.0, 3.3], [0, 1])
    assert len(calls) == 200
