"""Bodies of second order against the nonlinear equilibrium of their elements: what is left is of third order."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from assembled import assembled
from grid_meshes import box_mesh
from nonlinear_elements import Held, nodes_held

import derive
from derive.derivation import reduced_bodies
from derive.mechanics.bodies.modal_body import ModalBody, ModalFrame
from derive.simulation.validity.far_deformation import left_out
from derive.solids.stresses import IntegratedMesh
from derive.spec.files.mesh_arrays import mesh_arrays
from derive.spec.model.body import NodalBody
from derive.spec.model.mesh import ElementKind, Material
from derive.spec.model.spatial_bodies import FlexibleBody

SIDES, MODES = (0.3, 0.02, 0.01), 14
STEEL = Material("steel", 210e9, 0.3, 7850.0)
NONE = (0.0, 0.0, 0.0)
LOADS = {
    "force_along": ((60.0, 0.0, 0.0), NONE),
    "force_across": ((0.0, 20.0, 0.0), NONE),
    "force_out": ((0.0, 0.0, 30.0), NONE),
    "spin_about_x": (NONE, (40.0, 0.0, 0.0)),
    "spin_about_y": (NONE, (0.0, 40.0, 0.0)),
    "spin_about_z": (NONE, (0.0, 0.0, 40.0)),
    "spin": (NONE, (25.0, 20.0, 30.0)),
}
FRAMES = {"mean": "mean", "node": {"kind": "point", "node": 40}}
QUICK = [("force_along", "rigid", "mean"), ("spin", "mean", "node")]
CASES = [(load, motion, "mean") for load in LOADS for motion in ("rigid", "mean")]
CASES += [(load, "rigid", "node") for load in ("force_along", "force_out", "spin")]
LONG = [pytest.param(*case, marks=pytest.mark.long) for case in CASES if case not in QUICK]


@dataclass(frozen=True, eq=False)
class Hook:
    """A curved bar that is held at its left end, whose nodes have their mean in `root`, with its tip at the right."""

    spec: NodalBody
    held: Held
    root: np.ndarray
    tip: list[int]
    body: ModalBody
    left: ModalFrame
    right: ModalFrame

    def by_modes(self, force: np.ndarray, spin: np.ndarray) -> np.ndarray:
        """The displacement of the tip."""
        return np.asarray(self.placed(self.amplitudes(force, spin))[1] - self.placed(np.zeros(MODES))[1])

    def amplitudes(self, force: np.ndarray, spin: np.ndarray) -> np.ndarray:
        """The amplitudes of the least potential energy of forces and of the spin."""
        a = np.zeros(MODES)

        def gradient(b: np.ndarray) -> np.ndarray:
            """The derivatives by imaginary steps; the potential is an analytic function of the amplitudes."""
            return np.array([self.potential(b + 1e-30j * e, force, spin).imag for e in np.eye(MODES)]) / 1e-30

        step = 1e-4 * np.abs(np.linalg.solve(self.body.stiffness, gradient(a))).max()
        for _ in range(6):
            rest = gradient(a)
            hessian = np.array([(gradient(a + step * e) - rest) / step for e in np.eye(MODES)])
            a = a - np.linalg.solve(hessian, rest)
        return a

    def potential(self, a: np.ndarray, force: np.ndarray, spin: np.ndarray) -> complex:
        body, (turn, tip, origin) = self.body, self.placed(a)
        w = turn.T @ spin
        inertia = body.C3 + np.einsum("i,iab->ab", a, body.C4 + np.swapaxes(body.C4, 1, 2))
        inertia = inertia + np.einsum("i,j,ijab->ab", a, a, body.C5)
        first = turn @ at(a, body.c1, body.c2, body.c9)
        moved = np.cross(spin, origin)
        rotating = body.mass * moved @ moved / 2 + moved @ np.cross(spin, first) + w @ inertia @ w / 2
        return complex(a @ body.stiffness @ a / 2 - force @ tip - rotating)

    def placed(self, a: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The rotation of the body, the tip, and the origin of the floating frame, with the left end held in place."""
        left, right = self.left, self.right
        seat, tip = (at(a, f.point.position, f.point.shapes, f.point.second) for f in (left, right))
        turn = rotation(at(a, np.zeros(3), left.twists, left.second_twists)).T
        origin = self.root - turn @ seat
        return turn, origin + turn @ tip, origin


def at(a: np.ndarray, zero: np.ndarray, first: np.ndarray, second: np.ndarray | None) -> np.ndarray:
    assert second is not None
    return np.asarray(zero + a @ first + np.einsum("i,j,ijk->k", a, a, second) / 2)


def rotation(theta: np.ndarray) -> np.ndarray:
    """The rotation of the quaternion along (1, theta/2)."""
    cross = np.array([[0, -theta[2], theta[1]], [theta[2], 0, -theta[0]], [-theta[1], theta[0], 0]])
    return np.asarray(np.eye(3) + (cross + cross @ cross / 2) / (1 + theta @ theta / 4))


@cache
def hook(motion: str, frame: str) -> Hook:
    x, mesh = box_mesh(ElementKind.HEX20, SIDES, (6, 1, 1), material=STEEL)
    x[:, 2] += 1.5 * x[:, 0] ** 2
    x[:, 1] += 6 * x[:, 0] ** 3
    left, right = (np.flatnonzero(np.abs(x[:, 0] - end) < 1e-9).tolist() for end in (0, SIDES[0]))
    solid = IntegratedMesh(mesh, x, full=True)
    m, k = assembled(solid)
    arrays = {"positions": x, "mass": m, "stiffness": k, **mesh_arrays(mesh)}
    equal = {"weights": [1] * len(left)}  # faces of elements are weighed by area without them
    sets = {"left": {"nodes": left, "motion": motion}, "right": {"nodes": right, **equal}}
    if motion == "mean":
        sets["left"] |= equal
    keys = {"nodes": arrays, "units": "SI", "modes": MODES, "interface": ["left", "right"], "order": 2}
    scene = derive.spatial_scene("hook", bodies={"hook": keys | {"markers": sets, "frame": FRAMES[frame]}})
    reduced = reduced_bodies(scene)["hook"]
    (spec,) = scene.bodies
    assert isinstance(spec, FlexibleBody)
    return Hook(
        spec.body,
        Held(solid, nodes_held(x, left, motion), m),
        x[left].mean(axis=0),
        right,
        reduced.body,
        *reduced.frames,
    )


@pytest.mark.parametrize(("load", "motion", "frame"), [*QUICK, *LONG])
def test_what_is_left_is_of_third_order(load: str, motion: str, frame: str) -> None:
    """A quarter of the load leaves a sixteenth of the relative error.

    At second order the held end turns as well: without that rotation the errors are a hundred times as large. If the
    nodes of a rigid set move as those of a small rotation, ten times as large.
    """
    (coarse, linear), (fine, _) = (errors(hook(motion, frame), *LOADS[load], scale) for scale in (1.0, 0.25))
    assert coarse < 0.005 * linear and fine < coarse / 13


@pytest.mark.parametrize(
    "load", ["force_out", *(pytest.param(load, marks=pytest.mark.long) for load in LOADS if load != "force_out")]
)
def test_a_run_implies_what_is_left(load: str) -> None:
    """The tip moves by 5 to 30 % of the length; the error is implied from the deformation alone."""
    of, (force, spin) = hook("rigid", "mean"), LOADS[load]
    second, _ = errors(of, force, spin, 48.0)
    amplitudes = of.amplitudes(np.array(force) * 48, np.array(spin) * 48**0.5)
    assert left_out(of.spec, amplitudes[None])[1] == pytest.approx(second, rel=0.6)


def errors(of: Hook, force: tuple[float, ...], spin: tuple[float, ...], scale: float) -> tuple[float, float]:
    """The errors of the displacement of the tip at second order, and by small displacements, relative to it."""
    f, w = np.array(force) * scale, np.array(spin) * scale**0.5
    loads = np.zeros_like(of.held.solid.x)
    loads[of.tip] = f / len(of.tip)
    truth = of.held.displacements(loads, tuple(w))[of.tip].mean(axis=0)
    small = of.by_modes(f * 1e-4, w * 1e-2) * 1e4
    second, first = (float(np.linalg.norm(u - truth) / np.linalg.norm(truth)) for u in (of.by_modes(f, w), small))
    return second, first
