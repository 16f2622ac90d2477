"""The full model of second order of beams in space: T is that of points, M stays definite, and planar motions agree."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import pytest
from rods_in_space import FRAMES, beam, numbers, points

import derive
from derive.algebra import sp
from derive.mechanics.bodies.section_fields import position_field, second_field, section_shapes, shape_field
from derive.runtime.interpreted_scene import InterpretedFunction
from some_functions import only

SMALL: dict[str, Any] = {"ansatz": ["1", "xi", "xi^2", "xi^3"], "lateral": {"ansatz": ["1", "xi", "xi^2"]}}
TWISTED: dict[str, Any] = SMALL | {"torsion": {"ansatz": ["xi"], "stiffness": 7}, "centre": ["1/20", "-1/30"]}


def mass_matrix(of: Any, q: Any) -> Any:
    """M of a free beam in the state q, by the interpreter."""
    return mass_matrices(of, [q])[0]


def mass_matrices(of: Any, states: Any) -> Any:
    """M of a free beam in states q, by the interpreter."""
    scene = derive.spatial_scene("alone", bodies={"rod": of})
    with only("mass"):
        model = derive.lower(derive.derive(scene), explicit=True)
    run = {name: InterpretedFunction(model, model.kernel(name)) for name in ("setup", "mass")}
    k = run["setup"]((np.array(model.defaults),))
    return [model.pattern("mass", "M").dense(run["mass"]((q, k))) for q in states]


@pytest.mark.parametrize("frame", [FRAMES[2], *(pytest.param(f, marks=pytest.mark.long) for f in FRAMES[:2])])
def test_kinetic_energy_is_that_of_points(frame: Any) -> None:
    """T is that of the centres of sections that move with the whole displacement, and the inertia of sections.

    The beam is off its axis. The inertia of its sections has T through second order in amplitudes and rates.
    """
    of = beam(frame=frame, order=2, terms="full", **TWISTED)
    shapes, length = section_shapes(of), sp.Rational(3, 2)
    n = len(shapes)
    rng = np.random.default_rng(3)
    alpha, v = 0.3 * rng.normal(size=n), rng.normal(size=6 + n)
    quaternion = np.array([0.8, 0.1, -0.5, 0.3]) / np.sqrt(0.99)
    M = mass_matrix(of, np.r_[0.3, -0.2, 0.7, quaternion, alpha])
    Q, X = rotation(quaternion), position_field(length)
    first = [shape_field(s, length) for s in shapes]
    second = {(i, j): second_field(shapes[i], shapes[j], of.frame, length) for i, j in product(range(n), repeat=2)}

    def energy(cloud: Any, factor: float) -> float:
        """The kinetic energy of points with all amplitudes and their rates times a factor."""
        total = 0.0
        for weight, xi, p in cloud:
            Phi = np.array([numbers(f, float(xi), p) for f in first])
            Psi = np.array([[numbers(second[i, j], float(xi), p) for j in range(n)] for i in range(n)])
            r = numbers(X, float(xi), p) + factor * alpha @ (Phi + factor * np.einsum("j,ijk->ik", alpha, Psi) / 2)
            rdot = factor * v[6:] @ (Phi + factor * np.einsum("j,ijk->ik", alpha, Psi))
            velocity = v[:3] + Q @ (np.cross(v[3:6], r) + rdot)
            total += weight * float(velocity @ velocity) / 2
        return total

    every = points(of)
    centres = centres_of(every)
    sections = [*every, *((-weight, xi, p) for weight, xi, p in centres)]
    factors = np.array([-2.0, -1.0, 0.0, 1.0, 2.0]) / 2
    of_sections = np.linalg.solve(np.vander(factors, increasing=True), [energy(sections, f) for f in factors])
    total = energy(centres, 1.0) + of_sections[:3].sum()
    assert v @ M @ v / 2 == pytest.approx(total, rel=1e-11)
    assert abs(of_sections[3:].sum()) > 1e-6 * total


def centres_of(cloud: Any) -> Any:
    """The centres of the sections of points, with the mass (kg) of a beam of 2 kg."""
    nodes, weights = np.polynomial.legendre.leggauss(10)
    own = cloud[0][2]
    return [(w, xi, own) for w, (_, xi, _) in zip(weights, cloud[:: len(cloud) // len(nodes)], strict=True)]


def rotation(quaternion: Any) -> Any:
    """The rotation matrix of a unit quaternion, scalar first."""
    e0, e = quaternion[0], quaternion[1:]
    skew = np.array([[0, -e[2], e[1]], [e[2], 0, -e[0]], [-e[1], e[0], 0]])
    return (e0**2 - e @ e) * np.eye(3) + 2 * np.outer(e, e) + 2 * e0 * skew


def test_mass_matrix_stays_definite() -> None:
    """A beam that bends far in a tangent frame has a definite mass matrix in the full model, not in the truncated."""
    least = {}
    for terms in ("truncated", "full"):
        of = beam(frame=FRAMES[2], order=2, terms=terms, rotary_inertia="1/1000", **SMALL)
        least[terms] = least_eigenvalue(of, [np.full(len(section_shapes(of)), 0.4)])
    assert least["truncated"] < 0 < least["full"]


def test_mass_matrix_stays_definite_with_the_inertia_of_attached_masses() -> None:
    """A robot arm that a payload bent by 2 % had no definite mass matrix, as that inertia was truncated."""
    forearm = {"length": "1/4", "mass": "3/50", "bending_stiffness": 9, "rotary_inertia": 3e-7}
    shapes = {"ansatz": {"kind": "clamped-free", "count": 1}, "torsion": {"ansatz": ["xi"], "stiffness": 6}}
    payload = {"at": 1, "mass": "1/10", "inertia": ["1/50000"] * 3 + [0] * 3}
    of = forearm | shapes | {"order": 2, "terms": "full", "masses": {"payload": payload}}
    assert least_eigenvalue(of, 0.01 * np.random.default_rng(0).normal(size=(20, 3))) > 0


def least_eigenvalue(of: Any, amplitudes: Any) -> float:
    """The least eigenvalue of the scaled mass matrix of a beam alone with any of the amplitudes (n, shapes)."""
    least = []
    for M in mass_matrices(of, [np.r_[np.zeros(3), 1, np.zeros(3), alpha] for alpha in amplitudes]):
        scale = np.sqrt(np.abs(np.diag(M)))
        least.append(np.linalg.eigvalsh(M / np.outer(scale, scale))[0])
    return float(min(least))
