"""Bodies of second order in scenes in space: constraints and loads exactly, inertia up to the order of the energies."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from decimal_vectors import Array, floats
from space_kernels import SpaceModel, differences, random_state, space_model

from derive.roles import Role
from derive.simulation.compiled_scene import mass_matrix

NODES, MODES = 6, 2
SCENE = """
name = "second_order"
[scene]
gravity = [1, -2, -9]
[ground.markers]
base = { at = [0.1, -0.2, 0.3], rotation = { axis = [1, 2, 3], angle = 0.7 } }
[bodies.blade]
nodes = "blade.npz"
units = "SI"
frame = "given"
orthonormal = false
order = ORDER
[bodies.blade.markers]
root = { nodes = [0, 1, 2, 3], rotation = { axis = [2, -1, 1], angle = 1.1 } }
tip = 5
[bodies.blade.loads]
wind = { nodes = [1, 4, 5], forces = [[1, -2, 0.5], [0.3, 2, 1], [0, 1, -3]], time = "2 - t" }
jet = { nodes = [2, 5], forces = [[1, 0.4, -2]], frame = "body" }
[bodies.bob]
mass = 2
inertia = [0.3, 0.4, 0.5, 0.05, -0.02, 0.01]
markers.top = [0.2, 0, -0.3]
[joints.hinge]
kind = "revolute"
between = ["ground.base", "blade.root"]
[joints.ball]
kind = "spherical"
between = ["bob.top", "blade.tip"]
[springs.strut]
between = ["ground.base", "blade.tip"]
stiffness = 3
damping = 0.4
rest = 0.2
[simulation]
duration = 1
output = 1
"""


def arrays() -> dict[str, Array]:
    """Random nodes, modes and second-order fields, and the geometric stiffness that belongs to these by definition."""
    rng = np.random.default_rng(5)
    x, mass = rng.uniform(-1, 1, (NODES, 3)), rng.uniform(0.1, 0.5, NODES)
    psi = rng.uniform(-0.7, 0.7, (MODES, MODES, NODES, 3))
    psi = (psi + np.swapaxes(psi, 0, 1)) / 2
    axes = np.eye(3)

    def centrifugal(a: Array, b: Array) -> Array:
        return np.cross(a, np.cross(b, x))

    squares = [(a, a) for a in axes]
    products = [(axes[i], axes[j]) for i, j in ((0, 1), (1, 2), (0, 2))]
    fields = [centrifugal(a, b) for a, b in squares] + [centrifugal(a, b) + centrifugal(b, a) for a, b in products]

    def work(loads: list[Array]) -> Array:
        return np.array([np.einsum("a,ijak,ak->ij", mass, psi, np.broadcast_to(f, x.shape)) for f in loads])

    return {
        "positions": x,
        "mass": mass,
        "modes": rng.uniform(-0.5, 0.5, (MODES, NODES, 3)),
        "modal_stiffness": np.array([[30.0, 4.0], [4.0, 50.0]]),
        "K0t": work([*axes]),
        "K0r": work([np.cross(axis, x) for axis in axes]),
        "K0omega": work(fields),
        "K0F": -np.moveaxis(psi, (0, 1), (2, 3)),
        "K0F_nodes": np.arange(NODES),
    }


@pytest.fixture(scope="module")
def models(tmp_path_factory: pytest.TempPathFactory) -> Callable[[int], SpaceModel]:
    """The scene with the displacements of an order, beside the oracle of second order."""

    @cache
    def model(order: int) -> SpaceModel:
        folder = tmp_path_factory.mktemp(f"order{order}")
        np.savez(folder / "blade.npz", **arrays())
        path = folder / "scene.toml"
        path.write_text(SCENE.replace("ORDER", str(order)))
        return space_model(path, complete=False)

    return model


KINEMATIC = ("g", "G", "gdot", "gamma", "marker blade_tip", "velocity of blade_tip", "Jacobian of blade_tip")


def kinematic(model: SpaceModel) -> dict[str, float]:
    every = dict(differences(model, *random_state(model.native, 3)))
    return {name: every[name] for name in KINEMATIC if name in every}


@pytest.mark.long
def test_constraints_and_markers_are_of_second_order(models: Callable[[int], SpaceModel]) -> None:
    sizes = kinematic(models(2))
    assert set(sizes) >= {"g", "G", "gdot", "gamma"}
    assert all(size < 1e-12 for size in sizes.values()), sizes


def errors(model: SpaceModel, small: float) -> tuple[float, float, float, float]:
    """The errors of M and h in rigid-body and in modal rows, for amplitudes and rates of some size."""
    native = model.native
    t, q, v = random_state(native, 3)
    modal = np.array([role is Role.AMPLITUDE for role in native.roles])
    q[modal] = small * np.array([0.8, -0.6])
    names = list(native.coordinates)
    first = names.index("blade_alpha1") - 1  # a body has one velocity less than coordinates
    rows = np.arange(native.nv)
    alpha = (rows >= first) & (rows < first + MODES)
    v[alpha] = small * np.array([0.5, 0.9])
    k = native.setup()
    seen = model.oracle.see(t, q, v)
    M = np.abs(mass_matrix(native, q, k) - floats(seen.M))
    h = np.abs(native.force(t, q, v, k) - floats(seen.h))
    return (
        float(M[np.ix_(~alpha, ~alpha)].max()),
        float(M[np.ix_(~alpha, alpha)].max()),
        float(h[~alpha].max()),
        float(h[alpha].max()),
    )


ORDERS = (3, 2, 3, 2)
"""Energies are exact to second order in amplitudes and rates, and so M and h in this order of what remains."""


def test_inertia_is_that_of_energies_of_second_order(models: Callable[[int], SpaceModel]) -> None:
    for order, coarse, fine in zip(ORDERS, errors(models(2), 4e-2), errors(models(2), 1e-2), strict=True):
        assert 1e-13 < fine < coarse * 4.0**-order * 1.3 + 1e-12


@pytest.mark.long
def test_displacements_of_first_order_differ(models: Callable[[int], SpaceModel]) -> None:
    assert all(size > 1e-5 for size in kinematic(models(1)).values())
    for order, coarse, fine in zip(ORDERS, errors(models(1), 4e-2), errors(models(1), 1e-2), strict=True):
        assert fine > coarse * 4.0**-order * 2, "an order is lost"
