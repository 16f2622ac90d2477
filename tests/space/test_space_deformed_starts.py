"""Initial values of joints at markers of deformed bodies: the frames turn and move with the deformation."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import derive
from conftest import QUICK, ROOT
from derive.backends.model_files import explicit_files
from derive.simulation.prepared_run import PreparedRun
from derive.simulation.space.marker_frames import deformed_frame, frame_of
from derive.simulation.space.poses import SpatialPoses
from derive.simulation.trajectory import Trajectory
from derive.spec.toml.read import parse

SCENE = """
name = "bent"
[ground.markers]
o = { at = [0.1, 0, 0.2], rotation = { angles = [0.2, 0.5, -0.1], sequence = "xyz" } }
[bodies.rod]
nodes = "NODES"
units = "SI"
modes = 4
start = { amplitudes = [0.02, -0.01, 0.004, 0.002], amplitude_rates = [1.0, 0.5, -0.3, 0.2] }
[bodies.rod.markers]
end = { nodes = [0, 1, 2, 3, 4, 5, 6, 7, 8], rotation = { x = [0, 0, 1], z = [0, 1, 0] } }
tip = { nodes = [108, 109, 110, 111, 112, 113, 114, 115, 116] }
[joints.hinge]
kind = "KIND"
between = ["BETWEEN"]
start = { START, speed = 2 }
[outputs.motion]
kind = "joint"
joint = "hinge"
[outputs.rate]
kind = "joint_speed"
joint = "hinge"
[simulation]
duration = 1e-5
output = 1e-5
""".replace("NODES", (ROOT / "examples" / "spatial_rod.npz").as_posix())


@cache
def run(kind: str, start: str, between: str) -> Trajectory:
    """The first instants of the rod."""
    text = SCENE.replace("KIND", kind).replace("START", start).replace("BETWEEN", between)
    return PreparedRun(parse(text), complete=False).trajectory()


SECOND, FIRST = 'ground.o", "rod.end', 'rod.end", "ground.o'


@pytest.mark.parametrize(
    ("kind", "start", "between"),
    [
        pytest.param("revolute", "angle = 0.3", SECOND),
        pytest.param("prismatic", "displacement = 0.05", FIRST),
        pytest.param("revolute", "angle = 0.3", FIRST, marks=pytest.mark.long),
        pytest.param("prismatic", "displacement = 0.05", SECOND, marks=pytest.mark.long),
    ],
    ids=["revolute-second", "prismatic-first", "revolute-first", "prismatic-second"],
)
def test_the_stated_motion_of_a_joint_holds_at_a_deformed_marker(kind: str, start: str, between: str) -> None:
    """Of the undeformed frame it would be missed: the marker has turned by more than 0.01 rad."""
    trajectory = run(kind, start, between)
    assert trajectory["motion"][0] == pytest.approx(float(start.rsplit(maxsplit=1)[-1]), abs=1e-9)
    assert trajectory["rate"][0] == pytest.approx(2.0, abs=1e-7)
    assert trajectory["rod_alpha1"][0] == pytest.approx(0.02, abs=1e-9)


def test_frames_move_with_the_amplitudes() -> None:
    """Positions are those of the generated code; the derivatives are those of differences."""
    trajectory = run("revolute", "angle = 0.3", SECOND)
    scene = trajectory.scene
    model = derive.lower(derive.derive(scene), explicit=True, functions=["marker_rotations"])
    native = derive.load_scene(explicit_files(model, scene), QUICK)
    k, q = native.setup(), trajectory.q[0]
    tip = scene.joints[0].second
    poses = SpatialPoses(native, k, 0.0, q, 1.0)
    assert frame_of(scene, poses, tip).position == pytest.approx(
        native.marker("rod_end", q, np.zeros(native.nv), k)[0], abs=1e-14
    )
    now = deformed_frame(scene, poses, tip)
    assert now is not None
    turned = now.frame.axes @ np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]])
    assert np.arccos((np.trace(turned) - 1) / 2) > 0.01
    for n, column in enumerate(now.columns):
        i = native.coordinates.index(native.velocities[column].removesuffix("dot"))
        ends = []
        for sign in (1, -1):
            moved = q.copy()
            moved[i] += sign * 1e-6
            ends.append(deformed_frame(scene, SpatialPoses(native, k, 0.0, moved, 1.0), tip))
        plus, minus = ends
        assert plus and minus
        assert (plus.frame.position - minus.frame.position) / 2e-6 == pytest.approx(now.moves[:, n], abs=1e-8)
        spin = (plus.frame.axes - minus.frame.axes) / 2e-6 @ now.frame.axes.T
        assert [spin[2, 1], spin[0, 2], spin[1, 0]] == pytest.approx(now.turns[:, n], abs=1e-6)


def test_a_body_whose_rates_are_not_given_starts_without_deforming() -> None:
    """The heavy slider moves as if the rod were rigid: by the least energy alone a stretching rod would leave it at
    rest, which is a blow."""
    text = (ROOT / "examples" / "spatial_crank_slider.toml").read_text(encoding="utf-8")
    text = text.replace('"spatial_rod.npz"', f'"{(ROOT / "examples" / "spatial_rod.npz").as_posix()}"')
    text = text.replace("modes = 4", 'modes = 6\ninterface = ["ball", "yoke"]')
    run = PreparedRun(
        parse(text.replace("duration = 0.2\noutput = 5e-4", "duration = 1e-6\noutput = 1e-6"))
    ).trajectory()
    assert run["slider_sdot"][0] == pytest.approx(2.4)
    assert np.abs([run[f"rod_alpha{i}dot"][0] for i in range(1, 7)]).max() < 1e-12
