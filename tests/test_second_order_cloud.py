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
from derive.backends.c.source import CBackend
from derive.backends.python.backend import PythonBackend
from derive.lowering.cost_model import flat_operations
from derive.mechanics.bodies.modal_body import ModalBody
from derive.mechanics.bodies.spatial_body import modal_body
from derive.mechanics.symbols import Family
from derive.reduction import reduce
from derive.runtime.compiled_model import Native
from derive.spec.model.body import BodyFrame, DisplacementOrder

sys.path.insert(0, str(Path(__file__).parent / "reduction"))
import bodies_of_nodes as bodies
import second_order_bodies as stiff

from test_cloud import gravity, times, turned

N, POINTS = 3, 8
GRAVITY = (0.7, -0.3, -9.81)
KINDS = (
    *(pytest.param(f"{frame} flat", marks=pytest.mark.long) for frame in ("given", "mean")),
    "given loops",
    pytest.param("mean loops", marks=pytest.mark.long),
)
"""In the mean frame some sums vanish."""
Vector = list[Any]


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
def compiled(kind: str) -> Native:
    return derive.load(CBackend().files(model(kind), "test"), ("-std=c99", "-O0", "-ffp-contract=off"))


@cache
def module(kind: str) -> dict[str, Any]:
    names: dict[str, Any] = {}
    exec(PythonBackend().files(model(kind), "test")[0].text, names)
    return names


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


@pytest.mark.parametrize("kind", KINDS)
def test_generated_code_is_the_truncated_lagrangian(kind: str) -> None:
    native, python = compiled(kind), module(kind)
    k = native.setup()
    for seed in range(2):
        q, v, a = state(seed)
        rows, size = expected(kind.split(maxsplit=1)[0], seed)
        values, h = native.mass_force(0.0, q, v, k)
        mass = python["dense"](python["MASS"], values)
        assert np.max(np.abs(mass @ a + h - rows) / size) < 1e-13
        assert np.array_equal(mass, mass.T)
        by_python = python["dense"](python["MASS"], python["mass"](q, k)) @ a + python["force"](0.0, q, v, k)
        assert np.max(np.abs(by_python - rows) / size) < 1e-13
        solved = native.accel(0.0, q, v, k)
        assert np.max(np.abs(mass @ solved + h)) < 1e-12 * np.linalg.cond(mass) * np.max(np.abs(h))


@pytest.mark.parametrize("frame", ["given", pytest.param("mean", marks=pytest.mark.long)])
def test_both_lowerings_give_the_same(frame: str) -> None:
    flat, loops = compiled(f"{frame} flat"), compiled(f"{frame} loops")
    kf, kt = flat.setup(), loops.setup()
    q, v, a = state(4)
    y, ydot = np.concatenate([q, v]), np.concatenate([flat.rates(q, v, kf), a])
    for call in (
        lambda native, k: native.force(0.0, q, v, k),
        lambda native, k: native.energy(q, v, k),
        lambda native, k: native.momentum(q, v, k),
        lambda native, k: native.residual(0.0, y, ydot, k),
        lambda native, k: native.accel(0.0, q, v, k),
        lambda native, k: native.load("at0", q, np.array([3.0, -2.0, 0.7]), k),
        lambda native, k: np.concatenate(native.marker(f"at{POINTS - 1}", q, v, k)[:2]),
    ):
        one, other = call(flat, kf), call(loops, kt)
        assert np.max(np.abs(one - other)) < 1e-11 * np.max(np.abs(one))


@pytest.mark.parametrize("kind", KINDS)
def test_jacobian_by_complex_steps(kind: str) -> None:
    native, python = compiled(kind), module(kind)
    k = native.setup()
    q, v, a = state(5)
    y, ydot = np.concatenate([q, v]), np.concatenate([native.rates(q, v, k), a])
    cj, step = 2.3, 1e-40
    steps = 1j * step * np.eye(len(y))
    numeric = python["residual"](0.0, y + steps, ydot + cj * steps, k).imag.T / step
    matrix = python["dense"](python["JACOBIAN"], native.jacobian(0.0, y, ydot, cj, k))
    assert np.max(np.abs(matrix - numeric) / np.abs(numeric).max(axis=1, keepdims=True)) < 1e-12


@pytest.mark.parametrize("kind", KINDS)
def test_markers_move_to_second_order(kind: str) -> None:
    """Nothing of x is cut off at a point; its velocity and its Jacobian are derivatives of it."""
    native, python = compiled(kind), module(kind)
    k = native.setup()
    q, v, _ = state(6)
    _, _, x, phi, psi = body(kind.split(maxsplit=1)[0])
    alpha, qdot = q[7:], native.rates(q, v, k)
    for node in (0, POINTS - 1):
        place, speed, jacobian = native.marker(f"at{node}", q, v, k)
        r = x[node] + alpha @ phi[:, node] + np.einsum("i,j,ijk->k", alpha, alpha, psi[:, :, node]) / 2
        with mpmath.workdps(30):
            expected = q[:3] + np.array([float(z) for z in turned(list(mp(q[3:7])), list(mp(r)))])
        assert np.allclose(place, expected, rtol=1e-14, atol=1e-14)
        assert np.allclose(python[f"marker_at{node}"](q + 1e-40j * qdot, v, k)[0].imag / 1e-40, speed, rtol=1e-12)
        dense = python["dense"](native.marker_pattern(f"at{node}"), jacobian)
        assert np.allclose(dense @ v, speed, rtol=1e-13, atol=1e-13)
        force = np.array([3.0, -2.0, 0.7])
        assert np.allclose(native.load(f"at{node}", q, force, k), dense.T @ force, rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("kind", KINDS)
def test_power_balance_and_momenta(kind: str) -> None:
    """v . (M vdot + h) is the rate of the energy; gravity alone changes the momenta, to second order in a."""
    native, python = compiled(kind), module(kind)
    k = native.setup()
    q, v, a = state(9)
    qdot, step = native.rates(q, v, k), 1e-40
    power = v @ native.residual(0.0, np.concatenate([q, v]), np.concatenate([qdot, a]), k)[7 + N :]
    change = python["energy"](q + 1j * step * qdot, v + 1j * step * a, k).imag.sum() / step
    assert np.isclose(power, change, rtol=1e-11)
    free = native.accel(0.0, q, v, k)
    drift = python["momentum"](q + 1j * step * qdot, v + 1j * step * free, k).imag / step
    _, masses, x, phi, psi = body(kind.split(maxsplit=1)[0])
    r = x + np.tensordot(q[7:], phi, 1) + np.einsum("i,j,ijnk->nk", q[7:], q[7:], psi) / 2
    with mpmath.workdps(30):
        places = q[:3] + np.array([[float(z) for z in turned(list(mp(q[3:7])), list(mp(p)))] for p in r])
    weight = np.outer(masses, GRAVITY)
    expected = np.concatenate([weight.sum(axis=0), np.cross(places, weight).sum(axis=0)])
    assert np.max(np.abs(drift - expected)) < 1e-9 * np.max(np.abs(free))


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
