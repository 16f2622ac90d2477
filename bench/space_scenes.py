"""Mechanisms in space for the benchmark of their cost: scenes in files, and states that meet their constraints.

Chains are those of the C by hand: body after body, the first one joined to the ground at the origin; a body has the
markers `left` and `right`. A flexible body is a cloud of point masses with random modes, so that no integral vanishes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import derive
from derive.derivation import reduced_bodies
from derive.mechanics.multibody.space.flexible import ReducedBody
from derive.spec.model.spatial_scene import SpatialScene

Array = NDArray[np.float64]

MODES = 8
POINTS = 20
GRAVITY = -9.81
AXES = {"revolute": 5, "spherical": 3, "fixed": 6}
"""The constraints of each kind of joint."""
EXAMPLES = Path(__file__).parents[1] / "examples"


@dataclass(frozen=True, eq=False)
class RigidLink:
    """A rigid body of a chain: mass, inertia about its centre of mass (3, 3), and both handles in the body frame."""

    mass: float
    inertia: Array
    left: Array
    right: Array


def rigid_link(seed: int) -> RigidLink:
    """A rigid body with full inertia."""
    rng = np.random.default_rng(seed)
    factor = rng.normal(size=(3, 3))
    left, right = rng.normal(size=(2, 3)) * 0.3
    moments = factor @ factor.T + 3 * np.eye(3)
    return RigidLink(rng.uniform(0.5, 2), 0.05 * (np.trace(moments) * np.eye(3) - moments), left, right)


def cloud(seed: int, count: int = MODES) -> dict[str, Array]:
    """The arrays of a file with a body of point masses and random modes."""
    rng = np.random.default_rng(seed)
    index = np.arange(POINTS, dtype=np.int32)
    modes = rng.uniform(-1, 1, (count + 6, POINTS, 3))
    return {
        "positions": rng.uniform(-0.3, 0.3, (POINTS, 3)),
        "mass_row": index,
        "mass_col": index,
        "mass_value": rng.uniform(0.5, 1.5, POINTS) / POINTS,
        "modes": modes[:count],
        "modal_stiffness": rng.uniform(50, 100, count),
    }


def chain_of_rigid_bodies(count: int, kind: str, folder: Path) -> SpatialScene:
    """A chain of rigid bodies that keep all coordinates."""
    return _scene(f"rigid_{kind}_{count}", [*_rigid_links(count), *_joints([kind] * count)], folder)


def _rigid_links(count: int) -> list[str]:
    """The tables of rigid bodies of a chain, which keep all coordinates."""
    bodies = []
    for i in range(count):
        link = rigid_link(i)
        J = link.inertia
        tensor = [J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2]]
        bodies.append(
            f"[bodies.link{i}]\nmass = {link.mass!r}\ninertia = {_list(tensor)}\nkeep_coordinates = true\n"
            f"markers = {{ left = {_list(link.left)}, right = {_list(link.right)}, middle = [0, 0, 0] }}\n"
        )
    return bodies


def graph_of_rigid_bodies(seed: int, folder: Path) -> SpatialScene:
    """3 to 9 rigid bodies that keep all coordinates, each joined to one before or to the ground; up to two loops."""
    rng = np.random.default_rng(seed)
    count, kinds = int(rng.integers(3, 10)), ("revolute", "spherical", "universal", "fixed", "cylindrical")
    few = rng.permutation(kinds)[: rng.integers(1, 4)]
    pairs = [
        (f"link{k}.left", f"link{j}.right" if (j := int(rng.integers(-1, k))) >= 0 else "ground.base")
        for k in range(count)
    ]
    for _ in range(rng.integers(0, 3)):
        first, second = rng.choice(count, 2, replace=False)
        pairs.append((f"link{first}.middle", f"link{second}.middle"))
    parts = _rigid_links(count)
    for n, (first, second) in enumerate(pairs):
        kind = rng.choice(few) if n < count else "spherical"
        parts.append(f'[joints.joint{n}]\nkind = "{kind}"\nbetween = ["{second}", "{first}"]\n')
    return _scene(f"space_{seed}", parts, folder)


def chain_of_flexible_bodies(count: int, kind: str, folder: Path) -> SpatialScene:
    """A chain of flexible bodies with MODES modes each; a single body without joints if there is no `kind`."""
    parts = [*_flexible_links([MODES] * count, folder), *(_joints([kind] * count) if kind else ())]
    return _scene(f"flexible_{kind or 'free'}_{count}", parts, folder, bool(kind))


def row_of_flexible_bodies(seed: int, folder: Path) -> SpatialScene:
    """A chain of 3 to 5 flexible bodies with up to 6 modes, as many each or not, and one or two kinds of joints."""
    rng = np.random.default_rng(seed)
    count, most = int(rng.integers(3, 6)), int(rng.integers(2, 7))
    modes = [most] * count if rng.random() < 0.7 else [int(n) for n in rng.integers(1, most + 1, count)]
    kinds = rng.permutation(("revolute", "spherical", "universal", "fixed", "cylindrical"))[: rng.integers(1, 3)]
    parts = [*_flexible_links(modes, folder), *_joints([str(kinds[i % len(kinds)]) for i in range(count)])]
    return _scene(f"row_{seed}", parts, folder)


def _flexible_links(modes: Sequence[int], folder: Path) -> list[str]:
    """The tables of flexible bodies of a chain with so many modes, whose files are written."""
    bodies = []
    for i, number in enumerate(modes):
        np.savez(folder / f"cloud_{i}.npz", **cloud(i, number))
        bodies.append(
            f'[bodies.link{i}]\nnodes = "cloud_{i}.npz"\nunits = "SI"\n'
            "markers = { left = { nodes = [0, 1, 2] }, right = { nodes = [17, 18, 19] } }\n"
        )
    return bodies


def free_rod(folder: Path) -> SpatialScene:
    """The rod of the example, alone, with all six modes of its file."""
    rod = f'[bodies.rod]\nnodes = "{EXAMPLES / "spatial_rod.npz"}"\nunits = "SI"\n'
    return _scene("free_rod", [rod], folder, joined=False)


def slider_crank(flexible: bool, folder: Path) -> SpatialScene:
    """The slider-crank of the example, with its flexible rod or with a rigid one of the same mass."""
    text = (
        (EXAMPLES / "spatial_crank_slider.toml").read_text().replace("spatial_rod.npz", f"{EXAMPLES}/spatial_rod.npz")
    )
    if flexible:
        return _read(text, folder)
    start, end = text.index("[bodies.rod]"), text.index("[bodies.slider]")
    rod = (
        "[bodies.rod]\nmass = 0.07536\ninertia = [5e-7, 5.653e-4, 5.656e-4, 0, 0, 0]\n"
        "markers = { ball = [-0.15, 0, 0], middle = [0, 0, 0], "
        "yoke = { at = [0.15, 0, 0], rotation = { x = [0, 0, 1], z = [0, 1, 0] } } }\n"
        "start = { guess = true, position = [0.1, 0.1, 0.05], rotation = { axis = [0, 0, 1], angle = -0.8 } }\n\n"
    )
    named = text[:start] + rod + text[end:]
    return _read(named.replace('name = "spatial_crank_slider"', 'name = "rigid_crank_slider"'), folder)


def reduced_links(scene: SpatialScene) -> list[ReducedBody]:
    """The flexible bodies of a chain as numbers, from its left end."""
    return list(reduced_bodies(scene).values())


def rigid_states(count: int, kind: str, states: int) -> tuple[Array, Array]:
    """q (states, 7 count) and v (states, 6 count) of a chain of rigid bodies that meet all constraints."""
    rng = np.random.default_rng(2)
    qs, vs = [], []
    for _ in range(states):
        position, velocity, R, w = np.zeros(3), np.zeros(3), np.eye(3), np.zeros(3)
        q, v = [], []
        for i in range(count):
            link = rigid_link(i)
            turn, spin = _relative(kind, rng)
            R = R @ turn
            w = turn.T @ w + spin
            centre = position - R @ link.left
            speed = velocity - R @ np.cross(w, link.left)
            q += [*centre, *_quaternion(R)]
            v += [*speed, *w]
            position, velocity = centre + R @ link.right, speed + R @ np.cross(w, link.right)
        qs.append(q)
        vs.append(v)
    return np.array(qs), np.array(vs)


def flexible_states(links: list[ReducedBody], joined: bool, states: int) -> tuple[Array, Array]:
    """q and v of a chain of welded flexible bodies that meet all constraints, or of free bodies in any motion.

    The sections of welded bodies do not turn by deformation, as those by hand do not, but they have angular velocities.
    """
    rng = np.random.default_rng(3)
    qs, vs = [], []
    for _ in range(states):
        position, velocity, w = np.zeros(3), np.zeros(3), np.zeros(3)
        q: list[float] = []
        v: list[float] = []
        for link in links:
            (left, turn_left), (right, turn_right) = ((f.point, f.twists) for f in link.frames)
            alphas = 0.05 * rng.normal(size=MODES)
            rates = 0.3 * rng.normal(size=MODES)
            if not joined:
                e = rng.normal(size=4)
                q += [*rng.normal(size=3), *(e / np.linalg.norm(e)), *alphas]
                v += [*rng.normal(size=6), *rates]
                continue
            twists = np.hstack([turn_left, turn_right])
            alphas -= np.linalg.lstsq(twists.T, twists.T @ alphas, rcond=None)[0]
            w = w - rates @ turn_left
            at, end = (point.position + alphas @ point.shapes for point in (left, right))
            centre = position - at
            speed = velocity - np.cross(w, at) - rates @ left.shapes
            q += [*centre, 1.0, 0.0, 0.0, 0.0, *alphas]
            v += [*speed, *w, *rates]
            position, velocity = centre + end, speed + np.cross(w, end) + rates @ right.shapes
            w = w + rates @ turn_right
        qs.append(q)
        vs.append(v)
    return np.array(qs), np.array(vs)


def any_states(scene_q: int, scene_v: int, quaternions: list[int], states: int) -> tuple[Array, Array]:
    """Random q and v with unit quaternions, which begin at the given places of q."""
    rng = np.random.default_rng(4)
    q, v = rng.uniform(-0.3, 0.3, (states, scene_q)), rng.uniform(-1, 1, (states, scene_v))
    for start in quaternions:
        part = slice(start, start + 4)
        q[:, part] = rng.normal(size=(states, 4))
        q[:, part] /= np.linalg.norm(q[:, part], axis=1, keepdims=True)
    return q, v


def _relative(kind: str, rng: np.random.Generator) -> tuple[Array, Array]:
    """The rotation of a body against the one before it, and its angular velocity in its own frame."""
    if kind == "fixed":
        return np.eye(3), np.zeros(3)
    if kind == "revolute":
        c, s = np.cos(angle := rng.uniform(-2, 2)), np.sin(angle)
        return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]), np.array([0, 0, rng.normal()])
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return turn * np.linalg.det(turn), rng.normal(size=3)


def _quaternion(R: Array) -> Array:
    """The unit quaternion of a rotation matrix, scalar part first."""
    x = np.array([[R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]])
    symmetric = np.block([[np.array([[np.trace(R)]]), x], [x.T, R + R.T - np.trace(R) * np.eye(3)]])
    e: Array = np.linalg.eigh(symmetric)[1][:, -1]
    return e


def _joints(kinds: Sequence[str]) -> list[str]:
    """The joints of a chain, that to the ground first."""
    ends = ["ground.base", *(f"link{i}.right" for i in range(len(kinds) - 1))]
    return [
        f'[joints.joint{i}]\nkind = "{kind}"\nbetween = ["{end}", "link{i}.left"]\n'
        for i, (kind, end) in enumerate(zip(kinds, ends, strict=True))
    ]


def _scene(name: str, parts: list[str], folder: Path, joined: bool = True) -> SpatialScene:
    """A scene of a file; without joints it has no gravity, which the C by hand of a free body does not know."""
    gravity = GRAVITY if joined else 0
    head = f'name = "{name}"\n\n[scene]\ngravity = [0, 0, {gravity}]\n\n[ground.markers]\nbase = [0, 0, 0]\n'
    return _read("\n".join([head, *parts]), folder)


def _read(text: str, folder: Path) -> SpatialScene:
    path = folder / "scene.toml"
    path.write_text(text)
    scene: Any = derive.read(path)
    assert isinstance(scene, SpatialScene)
    return scene


def _list(values: Any) -> str:
    return "[" + ", ".join(repr(float(x)) for x in values) + "]"
