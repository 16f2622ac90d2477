"""A bar of solid elements whose angular acceleration alone changes its stiffness, against own beam elements."""

from __future__ import annotations

import numpy as np
import pytest
from assembled import assembled
from grid_meshes import box_mesh
from numpy.polynomial.legendre import leggauss
from scipy.linalg import eigh

import derive
from derive.mechanics.symbols import amplitude_of
from derive.runtime.interpreted_scene import InterpretedScene
from derive.simulation.errors import MassMatrixNotDefinite
from derive.simulation.space.initial_state import spatial_scene_state
from derive.solids.stresses import IntegratedMesh
from derive.spec.files.mesh_arrays import mesh_arrays
from derive.spec.model.mesh import ElementKind, Material
from explicit_motion import moved

LENGTH, HEIGHT, WIDTH = 0.4, 0.03, 0.0025
DENSITY = 7850.0
STEEL = Material("steel", 210e9, 0.3, DENSITY)
MODES, TWIST = 12, 4
"""The modes of the body: the first two bend it in its soft plane, and the fifth and another one twist it."""
ELEMENTS = 40
CRITICAL = 11660.0
"""The acceleration (rad/s^2) by which the beam buckles laterally."""


def spun_up(acceleration: float, modes: int, elements: tuple[int, int, int], frame: str) -> derive.SpatialScene:
    """The bar, clamped to a hinge about z that has this acceleration; frame: "mean", or "point" at its root."""
    x, mesh = box_mesh(ElementKind.HEX20, (LENGTH, HEIGHT, WIDTH), elements, material=STEEL)
    x = x - np.array([0, HEIGHT / 2, WIDTH / 2]) - np.array([0, *x[:, 1:].min(axis=0)])
    root = np.flatnonzero(np.abs(x[:, 0]) < 1e-9).tolist()
    m, k = assembled(IntegratedMesh(mesh, x, full=True))
    bar = {
        "nodes": {"positions": x, "mass": m, "stiffness": k, **mesh_arrays(mesh)},
        "units": "SI",
        "modes": modes,
        "interface": ["root"],
        "order": 2,
        "markers": {"root": {"nodes": root, "motion": "rigid"}},
        "frame": {"kind": "point", "node": root[0]} if frame == "point" else frame,
    }
    return derive.spatial_scene(
        "spun_up",
        ground={"o": (0, 0, 0)},
        bodies={"bar": bar},
        joints={"hinge": {"kind": "revolute", "between": ["ground.o", "bar.root"]}},
        drives={"drive": {"joint": "hinge", "motion": f"{acceleration / 2!r}*t^2"}},
    )


def body_squares(acceleration: float) -> np.ndarray:
    """The squares of the frequencies of the bar while it has this acceleration and no speed."""
    scene = spun_up(acceleration, MODES, (16, 2, 1), "point")
    native = InterpretedScene(derive.lower(derive.derive(scene)))
    constants = native.setup()
    start = spatial_scene_state(scene, native, constants).q
    names = [amplitude_of("bar", i) for i in range(1, MODES + 1)]
    columns = [native.coordinates.index(name.shown) for name in names]
    rates = [native.velocities.index(amplitude_of("bar", i, 1).shown) for i in range(1, MODES + 1)]

    def accelerations(column: int, amplitude: float) -> np.ndarray:
        q = np.array(start)
        q[columns] = 0
        q[column] = amplitude
        return np.asarray(native.solve(0.0, q, np.zeros(native.nv), constants)[0])[rates]

    step = 1e-6
    stiffness = [(accelerations(i, -step) - accelerations(i, step)) / (2 * step) for i in columns]
    return np.sort(np.linalg.eigvals(np.array(stiffness).T).real)


def beam_squares(acceleration: float, bending: float, torsion: float, twists: int) -> np.ndarray:
    """The squares of the frequencies of a beam with two stiffnesses (N m^2), in its first twists without the moment."""
    line = DENSITY * HEIGHT * WIDTH
    polar = DENSITY * (HEIGHT * WIDTH**3 + WIDTH * HEIGHT**3) / 12
    h, size = LENGTH / ELEMENTS, 3 * (ELEMENTS + 1)
    K, M = np.zeros((size, size)), np.zeros((size, size))
    points, weights = leggauss(5)
    for element in range(ELEMENTS):
        w, turn = 3 * element + np.array([0, 1, 3, 4]), 3 * element + np.array([2, 5])
        for g, weight in zip((points + 1) / 2, weights * h / 2, strict=True):
            x = (element + g) * h
            moment = line * acceleration * ((LENGTH**3 - x**3) / 3 - x * (LENGTH**2 - x**2) / 2)
            shapes = np.array([1 - 3 * g**2 + 2 * g**3, h * g * (1 - g) ** 2, 3 * g**2 - 2 * g**3, h * g**2 * (g - 1)])
            curved = np.array([12 * g - 6, h * (6 * g - 4), 6 - 12 * g, h * (6 * g - 2)]) / h**2
            linear, twisted = np.array([1 - g, g]), np.array([-1, 1]) / h
            K[np.ix_(w, w)] += weight * bending * np.outer(curved, curved)
            K[np.ix_(turn, turn)] += weight * torsion * np.outer(twisted, twisted)
            K[np.ix_(w, turn)] += weight * moment * np.outer(curved, linear)
            K[np.ix_(turn, w)] += weight * moment * np.outer(linear, curved)
            M[np.ix_(w, w)] += weight * line * np.outer(shapes, shapes)
            M[np.ix_(turn, turn)] += weight * polar * np.outer(linear, linear)
    free = np.arange(3, size)
    bent, turned = free[free % 3 != 2], free[free % 3 == 2]
    _, modes = eigh(K[np.ix_(turned, turned)], M[np.ix_(turned, turned)], subset_by_index=(0, twists - 1))
    moved = np.zeros((size, len(bent) + twists))
    moved[bent, range(len(bent))] = 1
    moved[turned, len(bent) :] = modes
    return np.asarray(eigh(moved.T @ K @ moved, moved.T @ M @ moved, eigvals_only=True))


@pytest.mark.long
def test_angular_acceleration_alone_takes_stiffness_away() -> None:
    """K0r: the moment of the inertia forces couples bending with torsion. As many twists take part in both models.

    The beam has the bending and torsional frequencies of the bar at rest; warping is not restrained in it.
    """
    still, spun = (body_squares(acceleration) for acceleration in (0.0, 0.4 * CRITICAL))
    bending = DENSITY * HEIGHT * WIDTH * still[0] * (LENGTH**2 / 3.5160153) ** 2
    polar = DENSITY * (HEIGHT * WIDTH**3 + WIDTH * HEIGHT**3) / 12
    torsion = polar * still[TWIST] * (2 * LENGTH / np.pi) ** 2

    def lost(twists: int) -> np.ndarray:
        """The relative changes of the squares of the beam."""
        before, after = (beam_squares(a, bending, torsion, twists) for a in (0.0, 0.4 * CRITICAL))
        return np.asarray(1 - after / before)

    of_body = 1 - spun / still
    assert lost(2)[0] == pytest.approx(0.116, rel=0.01) and lost(ELEMENTS)[:2] == pytest.approx(
        [0.129, 0.048], rel=0.01
    )
    assert of_body[0] == pytest.approx(lost(2)[0], rel=0.08)
    assert of_body[1] == pytest.approx(lost(ELEMENTS)[1], rel=0.05)
    nearly, over = (beam_squares(f * CRITICAL, bending, torsion, ELEMENTS)[0] for f in (0.99, 1.01))
    assert nearly > 0 > over


def test_a_frame_at_the_held_end_leaves_modes_hardly_any_inertia_to_lose() -> None:
    """Six modes of a bar take up a turn about its axis there, and a small twist the rest; in the mean frame it is left.

    The message says so: with few modes the bar would move, and the more of them it has, the sooner it stops.
    """
    with pytest.raises(MassMatrixNotDefinite, match=r'bar deforms .* leave 0\.089 % of .* frame = "mean"') as stopped:
        moved(spun_up(2000, 6, (6, 1, 1), "point"), duration=0.01, output=0.005)
    assert stopped.value.left < 1e-3 and stopped.value.t < 0.005
    run = moved(spun_up(2000, 6, (6, 1, 1), "mean"), duration=0.01, output=0.005)
    assert 0 < np.abs(run.motion.q[:, 7:]).max() < 1e-4
