"""A mass with inertia at the tip of a beam is a rigid body that is welded there: its frequencies are exact."""

from __future__ import annotations

import numpy as np
import scipy.linalg
from made import make
from scipy.optimize import brentq

from derive.simulation.compiled_scene import constraint_matrix
from derive.spec.toml.read import parse

MASS, INERTIA = 0.8, 0.03

CANTILEVER = f"""
name = "tip_mass"
ground.markers = {{ wall = [0, 0] }}
[bodies.rod]
frame = {{ kind = "tangent", at = -1 }}
ansatz = ["1", "xi", "xi^2", "xi^3", "xi^4", "xi^5", "xi^6", "xi^7"]
orthogonal = true
mass = 1
length = 1
bending_stiffness = 1
markers = {{ root = -1, tip = 1 }}
[bodies.weight]
mass = {MASS}
inertia = {INERTIA}
markers = {{ centre = [0, 0] }}
[joints.clamp]
kind = "fixed"
between = ["ground.wall", "rod.root"]
[joints.weld]
kind = "weld"
between = ["rod.tip", "weight.centre"]
"""


def exact(b: float) -> float:
    """Zero at b = (m l^3 w^2/EI)^(1/4): w'' = J w^2 w' and w''' = - M w^2 w at the tip of w(x), clamped at 0."""
    c, s, ch, sh = np.cos(b), np.sin(b), np.cosh(b), np.sinh(b)
    first = ((ch + c) - INERTIA * b**3 * (sh + s), (sh + s) - INERTIA * b**3 * (ch - c))
    second = ((sh - s) + MASS * b * (ch - c), (ch + c) + MASS * b * (sh - s))
    return first[0] * second[1] - first[1] * second[0]


def test_the_frequencies_are_those_of_a_cantilever_with_a_mass_at_its_tip() -> None:
    made = make(parse(CANTILEVER))
    native, (k, start) = made.native, made.start()
    n, rest = native.nq, np.concatenate([start.q, np.zeros(native.nv + native.nlambda)])
    dae = native.dae["index3"]
    still, moving = (dae.pattern.dense(dae.jacobian(0.0, rest, 0 * rest, cj, k)) for cj in (0.0, 1.0))
    free = scipy.linalg.null_space(constraint_matrix(native, 0.0, start.q, k))
    M = free.T @ (moving - still)[n : 2 * n, n : 2 * n] @ free
    K = free.T @ still[n : 2 * n, :n] @ free
    found = np.sqrt(scipy.linalg.eigh(K, M, eigvals_only=True))
    expected = [brentq(exact, low, high) ** 2 for low, high in ((0.5, 2.0), (2.0, 4.5))]
    np.testing.assert_allclose(found[:2], expected, rtol=1e-5)
