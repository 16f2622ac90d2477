"""Bodies in space with second-order fields against the Lagrangian of a cloud of point masses, in 50 digits.

The displacements are u = sum a_i Phi_i + 1/2 sum a_i a_j Psi_ij with random fields. The kinetic and potential energy of
the points are polynomials in the amplitudes and their rates; what is of third and fourth order in them is cut off
exactly. The equations of motion are Lagrange's, in quasi-velocities, differentiated numerically.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest

import derive
from derive import Model
from derive.lowering.cost_model import flat_operations
from derive.mechanics.bodies.modal_body import ModalBody
from derive.mechanics.bodies.spatial_body import modal_body
from derive.mechanics.symbols import Family
from derive.reduction import reduce
from derive.spec.model.body import BodyFrame, DisplacementOrder

sys.path.insert(0, str(Path(__file__).parent / "reduction"))
import bodies_of_nodes as bodies
import second_order_bodies as stiff

from cloud_checks import GRAVITY, CloudCode, check_lowerings, gravity, times, turned

N, POINTS = 3, 8
KINDS = (
    *(pytest.param(f"{frame} flat", marks=pytest.mark.long) for frame in ("given", "mean")),
    "given loops",
    pytest.param("mean loops", marks=pytest.mark.long),
)
"""In the mean frame some sums vanish."""


@cache
def body(frame: str) -> tuple[ModalBody, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """The body with masses, positions, Phi and Psi at its nodes, in its frame."""
    spec, _ = stiff.stiffened(N, BodyFrame(frame), POINTS)
    found = reduce(spec)
    fields = [np.array([getattr(p, name) for p in found.points]) for name in ("position", "shapes", "second")]
    x, phi, psi = fields[0], fields[1].swapaxes(0, 1), np.moveaxis(fields[2], 0, 2)
    found = replace(found, points=(found.points[0], found.points[-1]))
    return found, spec.data.mass.diagonal(), x, phi, psi


@cache
def model(kind: str) -> Model:
    frame, lowering = kind.split()
    return derive.lower(derive.derive_modal(body(frame)[0], gravity(), lowering))


@cache
def code(kind: str) -> CloudCode:
    return CloudCode(model(kind))


def state(seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(100 + seed)
    e = rng.uniform(-1, 1, 4)
    q = np.concatenate([rng.uniform(-1, 1, 3), e / np.linalg.norm(e), rng.uniform(-0.2, 0.2, N)])
    return q, rng.uniform(-1, 1, 6 + N), rng.uniform(-1, 1, 6 + N)


def mp(array: np.ndarray) -> Any:
    return np.vectorize(mpmath.mpf, otypes=[object])(array)


class Lagrangian:
    """T and V of the cloud through second order in amplitudes and rates, by velocities in the body frame."""

    def __init__(self, frame: str) -> None:
        self.body, masses, *fields = body(frame)
        self.m = mp(masses)
        self.x, self.phi, self.psi = map(mp, fields)

    def truncated(self, of: Callable[[Any], Any]) -> Any:
        """The terms through s^2 of a polynomial of fourth degree in s, at s = 1."""
        values = [of(mpmath.mpf(s)) for s in (-2, -1, 0, 1, 2)]
        second = (-values[0] + 16 * values[1] - 30 * values[2] + 16 * values[3] - values[4]) / 24
        first = (values[0] - 8 * values[1] + 8 * values[3] - values[4]) / 12
        return values[2] + first + second

    def kinetic(self, v: Any, w: Any, a: Any, rates: Any) -> Any:
        """v: Q^T cdot."""

        def at(s: Any) -> Any:
            r = self.x + np.tensordot(a * s, self.phi, 1) + np.einsum("i,j,ijnk->nk", a, a, self.psi) * s * s / 2
            tangents = self.phi + np.einsum("j,ijnk->ink", a, self.psi) * s
            speed = v + np.cross(w, r) + np.tensordot(rates * s, tangents, 1)
            return (self.m[:, None] * speed * speed).sum() / 2

        return self.truncated(at)

    def momenta(self, v: Any, w: Any, a: Any, rates: Any) -> tuple[Any, Any, Any, Any]:
        """The derivatives of T by v, w, the rates and a."""
        h = mpmath.mpf(10) ** -16
        arguments = [v, w, rates, a]
        result = []
        for k, values in enumerate(arguments):
            gradient = []
            for i in range(len(values)):
                ends = []
                for sign in (1, -1):
                    changed = [x.copy() for x in arguments]
                    changed[k][i] += sign * h
                    ends.append(self.kinetic(changed[0], changed[1], changed[3], changed[2]))
                gradient.append((ends[0] - ends[1]) / (2 * h))
            result.append(np.array(gradient, dtype=object))
        return result[0], result[1], result[2], result[3]

    def weight(self, c: Any, e: Any, a: Any) -> Any:
        g = mp(np.array(GRAVITY))

        def at(s: Any) -> Any:
            r = self.x + np.tensordot(a * s, self.phi, 1) + np.einsum("i,j,ijnk->nk", a, a, self.psi) * s * s / 2
            places = np.array([np.array(c) + np.array(turned(list(e), list(p))) for p in r], dtype=object)
            return -(self.m[:, None] * g * places).sum()

        return self.truncated(at)

    def rows(self, q: np.ndarray, v: np.ndarray, acc: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The rows of the equations of motion, and the sizes of what was added."""
        with mpmath.workdps(50):
            q_, v_, a_ = mp(q), mp(v), mp(acc)
            e, half = list(q_[3:7]), mpmath.mpf(1) / 2
            edot = np.array([half * x for x in times(e, [mpmath.mpf(0), *v_[3:6]])], dtype=object)
            h = mpmath.mpf(10) ** -12

            def at(t: Any) -> tuple[Any, ...]:
                """Momenta along the path: in the inertial frame for c, in the body frame for the rest."""
                turn = q_[3:7] + t * edot  # to first order, as a derivative needs it
                rates, a = v_[6:] + t * a_[6:], q_[7:] + t * v_[6:]
                back = [turn[0], -turn[1], -turn[2], -turn[3]]
                velocity = np.array(turned(back, list(v_[:3] + t * a_[:3])), dtype=object)
                p, spin, of_rates, of_a = self.momenta(velocity, v_[3:6] + t * a_[3:6], a, rates)
                return np.array(turned(list(turn), list(p)), dtype=object), spin, of_rates, of_a, velocity, p

            before, now, after = at(-h), at(mpmath.mpf(0)), at(h)
            pdot, ldot, ratesdot = ((after[k] - before[k]) / (2 * h) for k in range(3))
            w = v_[3:6]
            turning = np.cross(w, now[1]) + np.cross(now[4], now[5])
            rows = np.concatenate([pdot, ldot + turning, ratesdot - now[3]])
            rows = rows + self._weight_gradient(q_)
            k, b = mp(self.body.stiffness), mp(self.body.damping)
            rows[6:] += k @ q_[7:] + b @ v_[6:]
            sizes = np.abs(np.concatenate([pdot, ldot, ratesdot])) + 10
            return rows.astype(float), sizes.astype(float)

    def _weight_gradient(self, q: Any) -> Any:
        h = mpmath.mpf(10) ** -16
        result = []
        for row in range(6 + N):
            ends = []
            for sign in (1, -1):
                c, e, a = q[:3].copy(), list(q[3:7]), q[7:].copy()
                if row < 3:
                    c[row] += sign * h
                elif row < 6:
                    turn = [mpmath.mpf(1), mpmath.mpf(0), mpmath.mpf(0), mpmath.mpf(0)]
                    turn[row - 2] = sign * h / 2
                    e = times(e, turn)
                else:
                    a[row - 6] += sign * h
                ends.append(self.weight(c, e, a))
            result.append((ends[0] - ends[1]) / (2 * h))
        return np.array(result, dtype=object)


@cache
def expected(frame: str, seed: int) -> tuple[np.ndarray, np.ndarray]:
    return Lagrangian(frame).rows(*state(seed))


def places(frame: str, q: np.ndarray) -> np.ndarray:
    """x of all points, of which nothing is cut off."""
    _, _, x, phi, psi = body(frame)
    r = x + np.tensordot(q[7:], phi, 1) + np.einsum("i,j,ijnk->nk", q[7:], q[7:], psi) / 2
    with mpmath.workdps(30):
        return q[:3] + np.array([[float(z) for z in turned(list(mp(q[3:7])), list(mp(p)))] for p in r])


@pytest.mark.parametrize("kind", KINDS)
def test_generated_code_is_the_truncated_lagrangian(kind: str) -> None:
    for seed in range(2):
        code(kind).check_rows(*state(seed), *expected(kind.split(maxsplit=1)[0], seed), bound=1e-13)


@pytest.mark.parametrize("frame", ["given", pytest.param("mean", marks=pytest.mark.long)])
def test_both_lowerings_give_the_same(frame: str) -> None:
    check_lowerings(code(f"{frame} flat"), code(f"{frame} loops"), *state(4), bound=1e-11)


@pytest.mark.parametrize("kind", KINDS)
def test_jacobian_by_complex_steps(kind: str) -> None:
    code(kind).check_jacobian(*state(5))


@pytest.mark.parametrize("kind", KINDS)
def test_markers_move_to_second_order(kind: str) -> None:
    q, v, _ = state(6)
    for node in (0, POINTS - 1):
        code(kind).check_marker(f"at{node}", q, v, list(places(kind.split(maxsplit=1)[0], q)[node]))


@pytest.mark.parametrize("kind", KINDS)
def test_power_balance_and_momenta(kind: str) -> None:
    """To second order in the amplitudes."""
    frame, (q, v, a) = kind.split(maxsplit=1)[0], state(9)
    code(kind).check_balances(q, v, a, 0.0, body(frame)[1], places(frame, q))


def test_zeros_of_the_mean_frame() -> None:
    """c9 and c10 vanish by the conditions of the frame; the terms that they would make say so."""
    equations = derive.derive_modal(body("mean")[0])
    reasons = {table.family: table.zero for table in equations.tables}
    assert reasons[Family.C9] == "condition (17) at second order (no mean displacement)"
    assert reasons[Family.C10] == "condition (19) at second order (no mean rotation)"
    names = {(v.term.row, v.term.name): str(v.reason) for v in equations.expanded().vanished}
    assert "c9_1_1_1 .. c9_1_3_3 = 0 by condition (17) at second order" in names["alpha1", "translation"]
    assert not any("c9" in str(term.expr) or "c10" in str(term.expr) for term in equations.expanded().terms)


@pytest.mark.parametrize("n", [2, *(pytest.param(n, marks=pytest.mark.long) for n in (4, 6))])
def test_cost_of_second_order(n: int) -> None:
    """In the mean frame there is none, since c9 and c10 vanish; elsewhere the cost model predicts it."""

    def operations(frame: BodyFrame, order: DisplacementOrder) -> tuple[int, int]:
        given = replace(reduce(replace(stiff.stiffened(n, frame, 12)[0], order=order)), points=())
        counted = derive.lower(derive.derive_modal(given, None, "flat"), explicit=True).kernel("force").operations
        return counted, flat_operations(modal_body(given))

    first, second = DisplacementOrder.FIRST_ORDER, DisplacementOrder.TRUNCATED
    assert operations(bodies.MEAN, second) == operations(bodies.MEAN, first)
    counted, predicted = operations(bodies.GIVEN, second)
    assert counted == {2: 445, 4: 1061, 6: 1973}[n] and predicted == pytest.approx(counted, rel=0.1)
