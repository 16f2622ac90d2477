"""Section forces of beams in space: the planar beam's, statics, reactions, and sums over slices."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss
from rods_in_space import PLANAR_ROD, ROD

import derive
from derive.mechanics.bodies.spatial_beam_part import spatial_part
from derive.runtime.interpreted_scene import InterpretedScene
from explicit_motion import moved
from some_functions import only

GRAVITY = ("1", "-9.81", "2")
SECTION_KINDS = ("axial_force", "shear_force", "twisting_moment", "bending_moment")


def sections(*markers: str) -> dict[str, Any]:
    """The outputs of all forces and moments in sections of the rod."""
    return {f"{m}_{kind}": {"kind": kind, "section": f"rod.{m}"} for m in markers for kind in SECTION_KINDS}


def observed(scene: Any, q: Any, v: Any) -> Mapping[str, float]:
    """The outputs of a scene in a state at t = 0."""
    with only("solve", "outputs", "markers"):
        native = InterpretedScene(derive.lower(derive.derive(scene), explicit=True))
    k = native.setup(native.defaults) if native.nk else np.empty(0)
    values = native.evaluate_outputs(0.0, q, v, *native.solve(0.0, q, v, k), k)
    return dict(zip(native.outputs, values, strict=True))


def state(scene: Any, seed: int, size: float = 0.02, still: bool = False) -> tuple[Any, Any]:
    """A random state of a rod alone: its motion, and small amplitudes, which vanish if it is to be undeformed."""
    rng = np.random.default_rng(seed)
    equations = derive.derive(scene).expanded()
    n = len(equations.rows) - 6
    quaternion = rng.normal(size=4)
    a, rates = (np.zeros(n) if still else s * rng.normal(size=n) for s in (size, 0.3))
    q = np.r_[rng.normal(size=3), quaternion / np.linalg.norm(quaternion), a]
    return q, np.r_[rng.normal(size=6), rates]


# ---- planar motion


@pytest.mark.parametrize("order", [1, 2])
def test_section_outputs_are_those_of_the_planar_beam(order: int) -> None:
    """In a motion in a plane forces, moments, curvatures and strains are those of the planar beam."""
    rod = PLANAR_ROD | {"order": order, "frame": "chord", "damping": {"stiffness": "1/50", "mass": "1/10"}}
    markers = {"left": -1, "place": "1/3", "right": 1}
    planar = rod | {"markers": markers} | ({"terms": "truncated"} if order == 2 else {})
    kinds: dict[str, dict[str, Any]] = {kind: {} for kind in ("axial_force", "shear_force", "bending_moment")}
    kinds |= {"curvature": {}, "strain": {"height": "1/20"}}
    outputs = {kind: {"kind": kind, "section": "rod.place", **more} for kind, more in kinds.items()}
    joint = derive.Joint("h", "revolute", derive.MarkerRef("ground", "o"), derive.MarkerRef("rod", "left"))
    plane = derive.scene(
        "plane",
        ground={"o": (0, 0)},
        gravity=("1", "-9.81"),
        bodies={"rod": planar},
        joints=[joint],
        forces={"f": {"at": "rod.right", "components": [3, -2]}},
        outputs=outputs,
    )
    space = derive.spatial_scene(
        "space",
        ground={"o": (0, 0, 0)},
        gravity=("1", "-9.81", 0),
        bodies={"rod": rod | {"rotary_inertia": "1/50", "markers": markers}},
        joints={"h": {"kind": "revolute", "between": ["ground.o", "rod.left"]}},
        forces={"f": {"at": "rod.right", "force": [3, -2, 0]}},
        outputs=outputs,
    )
    # The section at xi = 1/3 has no slope: in the plane its angle is the slope, in space 2 arctan(slope/2).
    a, rates, half = np.array([0.02, 0.02, 0.003]), np.array([0.3, -0.2, 0.05]), 0.35
    ours = observed(plane, np.r_[0.3, 0.7, 2 * half, a], np.r_[0.1, 0.2, 2.0, rates])
    nothing = np.zeros(2)
    q = np.r_[0.3, 0.7, 0, np.cos(half), 0, 0, np.sin(half), a[:2], nothing, a[2]]
    both = observed(space, q, np.r_[0.1, 0.2, 0, 0, 0, 2.0, rates[:2], nothing, rates[2]])
    pairs = {"axial_force": "axial_force", "shear_force": "shear_force_2", "curvature": "curvature_3"}
    pairs |= {"bending_moment": "bending_moment_3", "bending_moment_curvature": "bending_moment_curvature3"}
    pairs |= {"strain": "strain"}
    assert pairs.keys() == ours.keys()
    for of_plane, of_space in pairs.items():
        assert both[of_space] == pytest.approx(ours[of_plane], rel=1e-12, abs=1e-13), of_plane
    out_of_plane = ("shear_force_3", "bending_moment_2", "bending_moment_curvature2", "curvature_1", "curvature_2")
    assert not any(both[name] for name in out_of_plane)


# ---- statics and dynamics


@pytest.mark.parametrize("order", [pytest.param(1, marks=pytest.mark.long), 2])
def test_statics_of_a_cantilever(order: int) -> None:
    """A cantilever with an end load and an end torque has V = F, M = F (l - x) and the torque in each section."""
    rod = ROD | {"order": order, "frame": {"kind": "tangent", "at": -1}, "markers": {"left": -1, "x": "1/5", "end": 1}}
    force, torque = np.array([3e-8, 2e-8]), 5e-8
    scene = derive.spatial_scene(
        "statics",
        ground={"o": (0, 0, 0)},
        bodies={"rod": rod},
        joints={"h": {"kind": "fixed", "between": ["ground.o", "rod.left"]}},
        forces={"f": {"at": "rod.end", "force": [0, *map(Fraction, force)]}},
        torques={"t": {"on": "rod.end", "torque": [Fraction(torque), 0, 0]}},
        outputs=sections("x"),
        start="equilibrium",
    )
    run = moved(scene, duration=1e-3, output=1e-3)
    lever = 1.5 * 0.4
    expected = {"x_shear_force_2": force[0], "x_shear_force_3": force[1], "x_twisting_moment": torque}
    expected |= {"x_bending_moment_2": -force[1] * lever, "x_bending_moment_3": force[0] * lever}
    expected |= {"x_twisting_moment_twist": torque, "x_axial_force": 0}
    expected |= {f"x_bending_moment_curvature{k}": expected[f"x_bending_moment_{k}"] for k in (2, 3)}
    found = {name: run[name][0] for name in expected}
    assert found == pytest.approx(expected, rel=1e-6, abs=1e-14)


FEW = {
    "ansatz": ["1", "xi", "xi^2"],
    "lateral": {"bending_stiffness": 12},
    "torsion": {"ansatz": ["xi"], "stiffness": 7},
}
FULL = FEW | {"order": 2, "terms": "full", "frame": "chord"}


def test_parts_of_full_beams_have_their_field_weights() -> None:
    """All symbols of the inertia of a part have values; without them a full beam could not be monitored."""
    (rod,) = derive.spatial_scene("alone", bodies={"rod": ROD | FULL}).bodies
    body, rows = spatial_part(rod, Fraction(1, 3), ())
    known = {c.symbol for c in body.constants}
    weights = {s for row in rows for s in row.free_symbols if str(s).startswith("z_")}
    assert weights
    assert weights <= known


@pytest.mark.parametrize(
    "kept",
    [
        {"order": 1, "frame": "mean"},
        {"order": 2, "frame": {"kind": "point", "at": "1/3"}},
        pytest.param(FULL, marks=pytest.mark.long),
    ],
    ids=["first", "truncated", "full"],
)
def test_force_at_the_root_is_the_reaction(kept: dict[str, Any]) -> None:
    """The section force and moment at an end that a joint holds are the joint's, whatever the motion."""
    one = {key: FEW["ansatz"] if key == "ansatz" else of for key, of in ROD["lateral"].items()}
    rod = ROD | {"lateral": one, "torsion": FEW["torsion"]} | kept  # two shapes along e2, one along each other axis
    rod |= {"centre": ["1/30", "-1/20"], "markers": {"left": -1, "right": 1}}
    rod["loads"] = {
        "wind": {"force": ["xi", 2, "xi^2"], "torque": [1, "xi", 0], "time": "1 + t"},
        "jet": {"force": ["1 + xi", "xi", 1], "frame": "body"},
    }
    mass = {"mass": "1/3", "centre": ["1/10", 0, "1/20"], "inertia": [0.01, 0.02, 0.02, 0.001, 0, 0]}
    rod["masses"] = {"inner": {"at": "1/2", **mass}, "tip": {"at": 1, **mass}}
    scene = derive.spatial_scene(
        "root",
        ground={"o": (0, 0, 0), "far": (2, 1, 0)},
        gravity=GRAVITY,
        bodies={"rod": rod},
        joints={"h": {"kind": "fixed", "between": ["ground.o", "rod.left"]}},
        springs={"s": {"kind": "linear", "between": ["ground.far", "rod.right"], "stiffness": 20, "rest": 1}},
        torques={"t": {"on": "rod.right", "torque": [1, -2, 3]}},
        outputs=sections("left") | {"held": {"kind": "reaction", "joint": "h", "frame": "rod.left"}},
    )
    found = observed(scene, *state(scene, 3))
    names = ("axial_force", "shear_force_2", "shear_force_3", "twisting_moment", "bending_moment_2", "bending_moment_3")
    ours = [-found[f"left_{name}"] for name in names]
    reaction = [found[f"held_{name}"] for name in ("1", "2", "3", "torque1", "torque2", "torque3")]
    assert ours == pytest.approx(reaction, rel=1e-11, abs=1e-11 * max(map(abs, reaction)))


@pytest.mark.parametrize("bent", [False, True])
def test_force_within_the_rod_is_that_of_its_slices(bent: bool) -> None:
    """The force and the moment in a section are those of the slices beyond it: mass times acceleration, less weight.

    A bent rod has no torsion, no offset of its centres of mass and no inertia about its axis: these are truncated.
    """
    at = Fraction(-1, 4)
    points, weights = leggauss(6)
    xi = [Fraction(float(x)) for x in (1 - float(at)) / 2 * points + (1 + float(at)) / 2]
    markers = {"place": str(at), "right": 1} | {f"g{i}": str(x) for i, x in enumerate(xi)}
    e, J = (np.zeros(3), 1e-14) if bent else (np.array([0, 1 / 30, -1 / 20]), 1 / 50)
    changes: dict[str, Any] = {"markers": markers, "centre": [0, 0] if bent else ["1/30", "-1/20"]}
    changes |= {"torsion": None, "rotary_inertia": "1e-14"} if bent else {}
    rod = {key: of for key, of in (ROD | changes | {"frame": "chord"}).items() if of is not None}
    motions = ("position", "acceleration", "angular_velocity", "angular_acceleration")
    moving = {f"{kind}{i}": {"kind": kind, "marker": f"rod.g{i}"} for i in range(len(xi)) for kind in motions}
    axes = {f"axis{k}": {"kind": "position", "marker": f"ground.{'xyz'[k]}", "frame": "rod.place"} for k in range(3)}
    positions = {name: {"kind": "position", "marker": f"rod.{of}"} for name, of in (("p", "place"), ("end", "right"))}
    positions["o"] = {"kind": "position", "marker": "ground.o", "frame": "rod.place"}
    scene = derive.spatial_scene(
        "slices",
        ground={"o": (0, 0, 0), "x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)},
        gravity=GRAVITY,
        bodies={"rod": rod},
        joints={"held": {"kind": "fixed", "between": ["ground.o", "rod.right"]}},
        outputs=sections("place") | {"held": {"kind": "reaction", "joint": "held"}} | moving | axes | positions,
    )
    found = observed(scene, *state(scene, 5, still=not bent))

    def vector(name: str) -> Any:
        return np.array([found[name + k] for k in ("_1", "_2", "_3")])

    A = np.array([vector(f"axis{k}") - vector("o") for k in range(3)])  # columns: the axes of the section
    force = vector("held")
    torque = np.array([found[f"held_torque{k}"] for k in (1, 2, 3)]) + np.cross(vector("end") - vector("p"), force)
    g = np.array(GRAVITY, float)
    for i, weight in enumerate(weights):
        part = weight * float(1 - at) / 4
        x, a, w, wdot = (vector(f"{kind}{i}") for kind in motions)
        arm = A @ e
        inertia = 2 * part * (a + np.cross(wdot, arm) + np.cross(w, np.cross(w, arm)) - g)
        force -= inertia
        about = A @ np.diag([J * part, 0, 0]) @ A.T
        torque -= np.cross(x + arm - vector("p"), inertia) + about @ wdot + np.cross(w, about @ w)
    names = ("axial_force", "shear_force_2", "shear_force_3", "twisting_moment", "bending_moment_2", "bending_moment_3")
    ours = [found[f"place_{name}"] for name in names]
    assert ours == pytest.approx([*(A.T @ force), *(A.T @ torque)], rel=1e-9, abs=1e-9)
