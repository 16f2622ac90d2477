"""Outputs of markers in space in moving frames, from positions and axes of material frames alone, in 60 digits.

A state is moved along its velocities and accelerations; what an observer in a frame measures are differences of
A0^T (x - x0) and of A0^T A, which know nothing of Coriolis.
"""

from __future__ import annotations

from decimal import Decimal
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from decimal_vectors import STEP, Array, about, array, floats, number, precise
from space_kernels import SpaceModel, random_state, space_model
from space_kinematics import SpaceState

from conftest import ROOT
from derive.errors import SpecError
from derive.simulation.observables.plots import plot_curves
from derive.simulation.prepared_run import PreparedRun
from derive.spec.toml.read import parse

SCENE = """
name = "observed"
[scene]
gravity = [1, 2, -9]
[ground.markers]
base = { at = [0.1, -0.2, 0.3], rotation = { axis = [1, 2, 3], angle = 0.7 } }
[bodies.block]
nodes = "block.npz"
units = "SI"
frame = "given"
orthonormal = false
markers = { face = { nodes = [0, 1, 2, 3], rotation = { axis = [1, 0, 1], angle = 0.4 } }, corner = 5, edge = 4 }
[bodies.bob]
mass = 2
centre = [0.1, -0.1, 0.3]
inertia = [0.3, 0.4, 0.5, 0.05, -0.02, 0.01]
markers.top = { at = [0.2, 0, -0.3], rotation = { axis = [2, -1, 1], angle = 1.1 } }
markers.end = [0.5, 0.4, 0.1]
[joints.hinge]
kind = "revolute"
between = ["ground.base", "bob.top"]
[springs.strut]
between = ["bob.end", "block.corner"]
stiffness = 30
rest = 0.1
"""
FRAMES = (None, "bob.top", "block.face", "ground.base")
VECTORS = ("position", "velocity", "acceleration", "rotation", "angular_velocity", "angular_acceleration")
CHORDS = {
    "sag": ("block.corner", "block.face", "block.edge"),
    "arc": ("bob.end", "block.face", "ground.base"),
}
"""Deflections: a marker, and the ends of a chord."""


def observed() -> str:
    """All outputs in all frames."""
    lines = [SCENE]
    for i, frame in enumerate(FRAMES):
        given = f'frame = "{frame}"\n' if frame else ""
        for kind in VECTORS:
            lines.append(f'[outputs.{kind}{i}]\nkind = "{kind}"\nmarker = "block.face"\n{given}')
        for axis in "xyz":
            ends = f'between = ["bob.end", "block.corner"]\naxis = "{axis}"\n{given}'
            lines.append(f'[outputs.angle{axis}{i}]\nkind = "angle"\n{ends}')
        lines.append(f'[outputs.pull{i}]\nkind = "spring"\nspring = "strut"\n{given}')
        lines.append(f'[outputs.bearing{i}]\nkind = "reaction"\njoint = "hinge"\n{given}')
    lines.append('[outputs.bent]\nkind = "deflection"\nmarker = "block.corner"\n')
    for name, markers in CHORDS.items():
        marker, *chord = (f'"{marker}"' for marker in markers)
        of_chord = f'kind = "deflection"\nmarker = {marker}\nchord = [{", ".join(chord)}]\n'
        lines.append(f"[outputs.{name}]\n{of_chord}[outputs.{name}_part]\n{of_chord}divided_by = 0.25\n")
    return "".join(lines)


@cache
def model(folder: Path) -> SpaceModel:
    rng = np.random.default_rng(4)
    half = rng.uniform(-1, 1, (2, 2))
    nodes = {"positions": rng.uniform(-1, 1, (6, 3)), "mass": rng.uniform(0.1, 0.5, 6)}
    modes = {"modes": rng.uniform(-0.5, 0.5, (2, 6, 3)), "modal_stiffness": half @ half.T * 20 + np.eye(2)}
    np.savez(folder / "block.npz", **nodes, **modes)
    path = folder / "observed.toml"
    path.write_text(observed())
    return space_model(path, complete=False)


@pytest.fixture(scope="module")
def observed_model(tmp_path_factory: pytest.TempPathFactory) -> SpaceModel:
    return model(tmp_path_factory.getbasetemp())


class Observer:
    """Markers along a motion through a state, and derivatives of what a frame sees of them."""

    def __init__(self, of: SpaceModel, t: float, q: Array, v: Array, a: Array) -> None:
        self.oracle, self.t = of.oracle, number(t)
        self.start, self.v, self.a = of.oracle.columns.state(q), array(v), array(a)

    def frame(self, marker: str | None, s: Decimal) -> tuple[Array, Array]:
        """Position and axes of a marker at a time s later."""
        if marker is None:
            return array([0, 0, 0]), array(np.eye(3).ravel()).reshape(3, 3)
        state: SpaceState = self.oracle.columns.moved(self.start, self.v + s / 2 * self.a, s)
        return self.oracle.frame(marker, state, self.oracle.poses(self.t + s, state))

    def seen(self, marker: str, frame: str | None, s: Decimal = Decimal(0)) -> tuple[Array, Array]:
        """The position and the axes of a marker along the axes of a frame."""
        (x, A), (x0, A0) = self.frame(marker, s), self.frame(frame, s)
        return A0.T @ (x - x0), A0.T @ A

    def derivatives(self, marker: str, frame: str | None) -> dict[str, Array]:
        """The motion of the marker as the frame measures it."""
        (s, R), (ahead, Ra), (behind, Rb) = (self.seen(marker, frame, x) for x in (Decimal(0), STEP, -STEP))
        Rdot, Rddot = (Ra - Rb) / (2 * STEP), (Ra - 2 * R + Rb) / STEP**2
        spin, rate = Rdot @ R.T, Rddot @ R.T + Rdot @ Rdot.T
        axial = ((2, 1), (0, 2), (1, 0))
        return {
            "position": s,
            "velocity": (ahead - behind) / (2 * STEP),
            "acceleration": (ahead - 2 * s + behind) / STEP**2,
            "angular_velocity": np.array([spin[i] for i in axial], dtype=object),
            "angular_acceleration": np.array([rate[i] for i in axial], dtype=object),
        }


def evaluated(of: SpaceModel, t: float, q: Array, v: Array, a: Array) -> dict[str, float]:
    native = of.native
    values = native.evaluate_outputs(t, q, v, a, np.arange(1.0, native.nlambda + 1), native.setup())
    return dict(zip(native.outputs, values, strict=True))


def column(values: dict[str, float], name: str, prefix: str = "") -> np.ndarray:
    return np.array([values[f"{name}_{prefix}{k}"] for k in (1, 2, 3)])


@pytest.mark.parametrize("seed", [1, 2])
def test_what_frames_see(observed_model: SpaceModel, seed: int) -> None:
    t, q, v = random_state(observed_model.native, seed)
    a = np.random.default_rng(seed + 50).uniform(-3, 3, len(v))
    values = evaluated(observed_model, t, q, v, a)
    with precise():
        observer = Observer(observed_model, t, q, v, a)
        for i, frame in enumerate(FRAMES):
            for kind, expected in observer.derivatives("block.face", frame).items():
                assert column(values, f"{kind}{i}") == pytest.approx(floats(expected), abs=1e-12), (kind, frame)
            theta = column(values, f"rotation{i}")
            _, R = observer.seen("block.face", frame)
            assert floats(about(array(theta))) == pytest.approx(floats(R), abs=1e-14), frame
            assert np.linalg.norm(theta) <= np.pi
            (near, _), (far, _) = (observer.seen(marker, frame) for marker in ("bob.end", "block.corner"))
            line = floats(far - near)
            for k, axis in enumerate("xyz"):
                assert values[f"angle{axis}{i}"] == pytest.approx(np.arccos(line[k] / np.linalg.norm(line)), abs=1e-14)
            _, A = observer.frame(frame, Decimal(0))
            for name, prefixes in ((f"pull{i}", ("", "torque")), (f"bearing{i}", ("", "torque"))):
                for prefix in prefixes:
                    inertial = column(values, f"{name[:-1]}0", prefix)
                    assert floats(A) @ column(values, name, prefix) == pytest.approx(inertial, abs=1e-11)
        assert np.abs(column(values, "bearing0", "torque")).max() > 0.1 and np.abs(column(values, "pull0")).max() > 0.1


def test_a_deflection_is_the_displacement_from_the_undeformed_body(observed_model: SpaceModel) -> None:
    t, q, v = random_state(observed_model.native, 3)
    q *= np.array([1e-6 if "alpha" in name else 1 for name in observed_model.native.coordinates])
    values = evaluated(observed_model, t, q, v, np.zeros(len(v)))
    with precise():
        state = observed_model.oracle.columns.state(q)
        _, marker = observed_model.oracle.marker("block.corner")
        moved = marker.at(observed_model.oracle.amplitudes("block", state)) - marker.position
    found = column(values, "bent")
    assert np.abs(found).max() > 1e-9
    assert found == pytest.approx(floats(moved), rel=1e-13)  # no digits are lost to the position itself


@pytest.mark.parametrize("name", CHORDS)
def test_a_deflection_from_a_chord_is_the_shortest_way_to_it(observed_model: SpaceModel, name: str) -> None:
    """From the nearest point of the line, along the axes of the body of the marker; also divided by a length."""
    t, q, v = random_state(observed_model.native, 4)
    values = evaluated(observed_model, t, q, v, np.zeros(len(v)))
    with precise():
        oracle = observed_model.oracle
        state = oracle.columns.state(q)
        poses = oracle.poses(number(t), state)
        x, start, end = (floats(oracle.frame(marker, state, poses)[0]) for marker in CHORDS[name])
        R = floats(poses[CHORDS[name][0].split(".")[0]].R)
    found = R @ column(values, name)
    line = end - start
    assert found @ line == pytest.approx(0, abs=1e-12)
    (share,) = np.linalg.lstsq(line[:, None], x - start, rcond=None)[0]
    assert found == pytest.approx(x - start - share * line, abs=1e-12) and np.linalg.norm(found) > 0.1
    assert column(values, f"{name}_part") == pytest.approx(4 * column(values, name), rel=1e-14)


SAGGING = """
name = "sagging"
[ground.markers]
o = { at = [0.3, 0, 0.2], rotation = { axis = [1, 1, 0], angle = 0.4 } }
[bodies.arm]
mass = 2
inertia = [1, 2, 2.5, 0, 0, 0]
markers = { o = [0, 0, 0], tip = [0.4, 0.3, 0] }
[bodies.block]
nodes = "BLOCK"
units = "SI"
modes = 1
markers = { left = 0, middle = 5, right = 7 }
start = { angular_velocity = [20, 30, -10], amplitudes = [1e-3] }
[joints.hinge]
kind = "revolute"
between = ["ground.o", "arm.o"]
[drives.motor]
joint = "hinge"
speed = 3
[outputs.sag]
kind = "deflection"
marker = "block.middle"
chord = ["block.left", "block.right"]
divided_by = 0.5
[outputs.away]
kind = "deflection"
marker = "block.middle"
chord = ["ground.o", "arm.tip"]
[plots.sags]
deflection = "block.middle"
chord = ["block.left", "block.right"]
divided_by = 0.5
[plots.apart]
deflection = "block.middle"
chord = ["ground.o", "arm.tip"]
over = "motor"
[simulation]
duration = 0.04
output = 0.01
"""


def test_plots_of_deflections_show_the_lengths_of_outputs() -> None:
    """From chords on the deforming body, and between the ground and a body that a drive carries."""
    run = PreparedRun(parse(SAGGING.replace("BLOCK", str(ROOT / "scenes/block.npz"))), complete=False).trajectory()
    plots = {plot.name: plot_curves(plot, run, "")[0] for plot in run.motion.scene.plots}
    for plot, output in (("sags", "sag"), ("apart", "away")):
        vectors = np.array([run[f"{output}_{k}"] for k in (1, 2, 3)])
        assert plots[plot].y == pytest.approx(np.linalg.norm(vectors, axis=0), rel=1e-12) and np.ptp(plots[plot].y) > 0
    assert plots["apart"].x == pytest.approx(3 * run.t)


@pytest.mark.parametrize(
    ("output", "message"),
    [
        ('kind = "rotation"\nmarker = "block.corner"', "outputs.x.marker: the marker block.corner is a node"),
        (
            'kind = "position"\nmarker = "bob.end"\nframe = "block.corner"',
            "outputs.x.frame: the marker block.corner is a node",
        ),
        ('kind = "deflection"\nmarker = "bob.end"', "outputs.x.marker: the marker bob.end is on a rigid body"),
        ('kind = "deflection"\nmarker = "ground.base"', "outputs.x.marker: the marker ground.base is on the ground"),
        (
            'kind = "deflection"\nmarker = "bob.end"\nchord = ["block.edge", "block.edge"]',
            "outputs.x.chord: a chord is between two markers, and these are the same",
        ),
        (
            'kind = "energy"\n[plots.p]\ndeflection = "bob.end"\nchord = ["bob.top", "bob.top"]\nover = "engine"',
            "plots.p.chord: a chord is between two markers, and these are the same",
        ),
        (
            'kind = "energy"\n[plots.p]\ndeflection = "bob.end"\nchord = ["bob.top", "bob.end"]\nover = "engine"',
            'plots.p.over: there is no drive "engine"',
        ),
        (
            'kind = "energy"\n[plots.p]\ndeflection = "bob.end"\nchord = ["bob.top", "bob.end"]\ncut = "block"',
            "plots.p.cut: the body block is no beam, and beams alone are cut into pieces",
        ),
        ('kind = "velocity"\nmarker = "bob.end"\nframe = "bob.ent"', "outputs.x.frame: "),
        ('kind = "angle"\nbetween = ["bob.end", "bob.top"]\naxis = "w"', "outputs.x.axis: "),
        (
            'kind = "angle"\nbetween = ["bob.end", "bob.end"]\naxis = "x"',
            "outputs.x.between: a line is between two markers, and these are the same",
        ),
        (
            'kind = "angle"\nbetween = ["bob.end", "ground.base"]\naxis = "x"\n[joints.ball]\n'
            'kind = "spherical"\nbetween = ["ground.base", "bob.end"]',
            "outputs.x.between: the joint ball holds both markers at one place",
        ),
        (
            'kind = "deflection"\nmarker = "bob.top"\nchord = ["bob.end", "ground.base"]\n[joints.ball]\n'
            'kind = "spherical"\nbetween = ["ground.base", "bob.end"]\n[springs.s]\nstiffness = 1\n'
            'between = ["bob.end", "ground.base"]',
            "outputs.x.chord: the joint ball holds both markers at one place",
        ),
        ('kind = "energy"\nframe = "bob.end"', "outputs.x"),
    ],
)
def test_outputs_without_a_meaning(output: str, message: str) -> None:
    text = SCENE.replace("block.npz", str(ROOT / "scenes/block.npz"))
    text = text.replace('frame = "given"\northonormal = false', "modes = 1")
    with pytest.raises(SpecError) as error:
        parse(f"{text}[outputs.x]\n{output}\n")
    assert message in str(error.value)
