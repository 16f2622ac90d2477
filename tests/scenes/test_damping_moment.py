"""The bending moment from the curvature with the damping of the material, against that from equilibrium."""

from __future__ import annotations

import numpy as np
import pytest
from made import Made, make

from derive.spec.toml.read import parse

POINTS, WEIGHTS = np.polynomial.legendre.leggauss(6)
SHAPES = ["1", "xi", "xi^2", "xi^3", "xi^4"]
N = 3  # shapes
LENGTH, BENDING, BETA = 0.8, 3.0, 0.02


def rod(damping: str, frame: str = '"mean"', more: str = "", pieces: int = 1) -> Made:
    """A rod with outputs at the Gauss points of its left piece."""
    markers = ", ".join(f"p{i} = {float((at + 1) / pieces - 1)!r}" for i, at in enumerate(POINTS))
    outputs = "\n".join(
        f'm{i} = {{ kind = "bending_moment", section = "rod.p{i}" }}\n'
        f'c{i} = {{ kind = "curvature", section = "rod.p{i}" }}'
        for i in range(len(POINTS))
    )
    return make(
        parse(
            f"""
name = "retarded"
[bodies.rod]
pieces = {pieces}
frame = {frame}
ansatz = {SHAPES}
mass = 1.2
length = {LENGTH}
bending_stiffness = {{ symbol = "EI", default = {BENDING} }}
markers = {{ {markers}, tip = 1 }}
{damping}
{more}
[forces.pull]
at = "rod.tip"
components = [0, 1e-6]
[outputs]
{outputs}
"""
        )
    )


def moments(made: Made, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The moments from equilibrium and from the curvature, and the curvature, at the Gauss points."""
    native, k = made.native, made.native.setup()
    values = native.evaluate_outputs(0.0, q, v, *native.solve(0.0, q, v, k), k)
    by_name = dict(zip(native.outputs, values, strict=True))
    numbers = range(len(POINTS))
    names = [[f"m{i}" for i in numbers], [f"m{i}_curvature" for i in numbers], [f"c{i}" for i in numbers]]
    of_equilibrium, of_curvature, curvature = (np.array([by_name[name] for name in some]) for some in names)
    return of_equilibrium, of_curvature, curvature


DAMPING = {
    "none": "",
    "stiffness": f"damping = {{ stiffness = {BETA} }}",
    "proportional": 'damping = { mass = 0.7, stiffness = { symbol = "beta", default = 0.02 } }',
    "ratio": "damping = { ratio = 0.2 }",
}


MEAN, CHORD, TANGENT = '"mean"', '"chord"', '{ kind = "tangent", at = -1 }'
CASES = [
    ("ratio", MEAN),
    ("proportional", TANGENT),
    *(pytest.param(kind, MEAN, marks=pytest.mark.long) for kind in ("none", "stiffness", "proportional")),
    pytest.param("proportional", CHORD, marks=pytest.mark.long),
]
"""Damping by the mass and by the stiffness that is a parameter, and that of a ratio, whose matrix is full."""


@pytest.mark.parametrize(("kind", "frame"), CASES)
def test_both_moments_do_the_same_work_on_every_shape(kind: str, frame: str) -> None:
    """Small motions have int (M of equilibrium - M of the curvature) d2phi/dx2 dx = 0, with and without damping."""
    _compare(rod(DAMPING[kind], frame, "masses.end = { at = 1, mass = 0.3, inertia = 0.01 }"))


@pytest.mark.parametrize("kind", [pytest.param("proportional", marks=pytest.mark.long), "ratio"])
def test_the_moment_of_the_damping_is_that_of_the_whole_rod(kind: str) -> None:
    """This holds in a piece, too, where the rates of the other piece enter."""
    _compare(rod(DAMPING[kind], pieces=2))


def _compare(made: Made) -> None:
    rng = np.random.default_rng(0)
    n = made.native.nq
    still = np.zeros(n)
    shapes = np.flatnonzero(["alpha" in name for name in made.native.coordinates])
    bent, bending = np.zeros((2, n))
    bent[shapes], bending[shapes] = rng.normal(size=(2, len(shapes)))
    curvatures = [moments(made, shape, still)[2] for shape in np.eye(n)[shapes[:N]]]
    found, expected, _ = moments(made, 1e-7 * bent, 1e-6 * bending)
    size = np.abs(expected).max()
    assert np.abs(found - expected).max() > 1e-3 * size, "the shapes cannot represent this moment"
    for curvature in curvatures:
        assert abs(WEIGHTS @ ((found - expected) * curvature)) < 1e-6 * size * np.abs(curvature).max()


def test_the_damping_of_the_stiffness_is_the_law_of_kelvin_and_voigt() -> None:
    """EI (w'' + beta w''dot), exactly; the rate of the curvature is its value for the velocities as amplitudes."""
    made = rod(DAMPING["stiffness"])
    rng = np.random.default_rng(1)
    q, v = rng.normal(size=made.native.nq), rng.normal(size=made.native.nv)
    _, found, curvature = moments(made, q, v)
    rate = moments(made, v, q)[2]
    np.testing.assert_allclose(found, BENDING * (curvature + BETA * rate), rtol=1e-12)
