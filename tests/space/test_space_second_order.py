"""Bodies of second order in scenes in space: against the oracle, whose energies have two powers of the deformation."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from decimal_vectors import Array
from space_kernels import SpaceModel, disagreements, random_state, space_model

from derive.roles import Role

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


@pytest.mark.parametrize("order", [2, pytest.param(1, marks=pytest.mark.long)])
def test_generated_code_is_that_of_the_oracle(models: Callable[[int], SpaceModel], order: int) -> None:
    """At first order the tables are left out."""
    assert disagreements(models(order), 3) == []


def test_inertia_is_that_of_the_nodes_up_to_the_order_of_the_energies(models: Callable[[int], SpaceModel]) -> None:
    """The energy of the nodes, which also has higher powers, differs by the third one."""
    model = models(2)
    t, q, v = random_state(model.native, 3)
    modal = np.array([role is Role.AMPLITUDE for role in model.native.roles])
    rates = [i - 1 for i, of in enumerate(modal) if of]  # a body has one velocity less than coordinates

    def error(small: float) -> float:
        q[modal] = small * np.array([0.8, -0.6])
        v[rates] = small * np.array([0.5, 0.9])
        seen = model.oracle.see(t, q, v)
        of_nodes = sum(
            float(xdot[:, k] @ body.masses @ xdot[:, k]) / 2
            for body, xdot in model.oracle.velocities(t, q, v)
            for k in range(3)
        )
        return abs(of_nodes - float(seen.energy["kinetic"]))

    coarse, fine = error(4e-2), error(1e-2)
    assert 1e-13 < fine < coarse * 4.0**-3 * 1.3
