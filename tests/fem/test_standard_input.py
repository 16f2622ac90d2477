"""`tisserand import` of standard input data: the body has the integrals of the file, and moves as that it came from."""

from __future__ import annotations

import sys
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import derive
from conftest import ROOT
from derive.cli.main import main
from derive.reduction import body_properties, reduce
from derive.sid import write
from derive.spec.model.body import Damping, NodalBody
from derive.spec.model.spatial_scene import SpatialScene
from explicit_motion import moved

sys.path.insert(0, str(Path(__file__).parents[1] / "reduction"))
import bodies_of_nodes as bodies
import second_order_bodies as stiff

DAMPED = bodies.nodal(bodies.cloud(4), bodies.GIVEN, orthonormal=False, damping=Damping(Fraction(1, 50)))
PROPORTIONAL = replace(DAMPED, damping=Damping(mass=Fraction(1, 3), stiffness=Fraction(1, 10**4)))
SECOND_ORDER = stiff.stiffened(3, bodies.MEAN)[0]


def imported(folder: Path, text: str, *options: str) -> NodalBody | SpatialScene:
    """The specification that the command writes for a file with this text."""
    (folder / "part.sid").write_text(text)
    assert main(["import", str(folder / "part.sid"), *options, "--out", str(folder / "part.toml")]) == 0
    return derive.read(folder / "part.toml")  # type: ignore[return-value]


@pytest.mark.parametrize("body", [DAMPED, PROPORTIONAL, SECOND_ORDER], ids=["damped", "proportional", "second order"])
def test_integrals_stiffness_and_damping_are_those_of_the_file(body: NodalBody, tmp_path: Path) -> None:
    first = reduce(body)
    result = imported(tmp_path, write(first))
    assert isinstance(result, NodalBody)
    second = reduce(result)
    for name in ("c1", "c2", "C3", "C4", "C5", "c6", "c7", "c8", "stiffness", "damping", "c9", "c10"):
        one, other = getattr(first, name), getattr(second, name)
        assert (one is None) == (other is None), name
        if one is not None:
            size = np.abs(one).max()
            assert np.abs(one - other).max() <= 1e-13 * size, name
    assert set(first.zeros) <= set(second.zeros)
    for point, other in zip(first.points, second.points, strict=True):
        assert np.array_equal(point.shapes, other.shapes) and np.array_equal(point.position, other.position)
        assert (point.second is None) == (other.second is None)
        assert point.second is None or np.allclose(point.second, other.second, rtol=1e-14, atol=0)
    assert body_properties(result).frequencies == pytest.approx(body_properties(body).frequencies, rel=1e-10)


def test_other_frames_are_those_of_the_point_masses(tmp_path: Path) -> None:
    """The moments of the mean frame follow from point masses that have those of the file."""
    result = imported(tmp_path, write(reduce(DAMPED)))
    assert isinstance(result, NodalBody)
    mean = replace(result, frame=bodies.MEAN, orthonormal=True, damping=Damping())
    expected = reduce(replace(DAMPED, frame=bodies.MEAN, orthonormal=True, damping=Damping()))
    assert reduce(mean).stiffness == pytest.approx(expected.stiffness, rel=1e-10)
    assert np.trace(reduce(mean).C3) == pytest.approx(np.trace(expected.C3), rel=1e-12)


CRANK = """
[scene]
gravity = [0, -9.81, 3.0]
[ground.markers]
axle = [0, 0, 0]
[joints.hinge]
kind = "revolute"
between = ["ground.axle", "rod.ball"]
[bodies.disc]
mass = 0.2
inertia = [1e-4, 1e-4, 2e-4, 0, 0, 0]
markers = { hub = [0, 0, 0] }
[joints.end]
kind = "fixed"
between = ["rod.yoke", "disc.hub"]
[outputs.end]
kind = "position"
marker = "disc.hub"
[simulation]
duration = 0.1
output = 0.02
tolerance = 1e-11
"""


def test_a_mechanism_of_the_body_moves_as_before(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A rod hangs at a hinge and carries a disc: frames displace and rotate as the sets of nodes did."""
    rod = 'nodes = "NODES"\nunits = "SI"\nmodes = 4\ndamping = { ratio = 0.02 }\n[bodies.rod.markers]\n'
    rod = rod.replace("NODES", f"{ROOT}/examples/spatial_rod.npz")
    sets = "ball = { nodes = [0, 1, 2, 3] }\nyoke = { nodes = [-4, -3, -2, -1] }\n"
    count = len(np.load(ROOT / "examples/spatial_rod.npz")["positions"])
    for k in range(1, 5):
        sets = sets.replace(f"-{k}", str(count - k))
    (tmp_path / "first.toml").write_text(f'name = "first"\n[bodies.rod]\n{rod}{sets}{CRANK}')
    assert main(["sid", str(tmp_path / "first.toml")]) == 0
    text = capsys.readouterr().out
    (tmp_path / "rod.sid").write_text(text)
    options = ["--scene", "--interface", "ball,yoke", "--out", str(tmp_path / "second.toml")]
    assert main(["import", str(tmp_path / "rod.sid"), *options]) == 0
    written = (tmp_path / "second.toml").read_text()
    body = written[written.index("[bodies.rod]") : written.index("[joints.ball]")]
    (tmp_path / "second.toml").write_text(f'name = "second"\n{body}{CRANK}')
    one, two = (moved(derive.read(tmp_path / f"{name}.toml")) for name in ("first", "second"))
    for axis in (1, 2, 3):
        assert np.ptp(one["end_2"]) > 0.01
        assert np.abs(one[f"end_{axis}"] - two[f"end_{axis}"]).max() < 1e-10


def test_a_body_of_second_order_spins_as_before(tmp_path: Path) -> None:
    """Its moments belong to no distribution of mass, since C5 contains K0omega."""
    spec = derive.read(ROOT / "scenes/solid_beam.toml")
    assert isinstance(spec, NodalBody)
    result = imported(tmp_path, write(reduce(spec)))
    start = derive.SpatialStart(angular_velocity=(0.0, 400.0, 0.0), amplitudes=(0.0, 1e-3))
    times = {"duration": 0.01, "output": 0.005, "tolerance": 1e-11}
    one, two = (moved(replace(body, start=start), **times) for body in (spec, result))
    assert one.q[-1] == pytest.approx(two.q[-1], abs=1e-10)


def test_faults_have_their_lines(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = write(reduce(DAMPED))
    (tmp_path / "part.sid").write_text(text.replace("mass = ", "mass = -", 1).replace("new node = 1", "new nodes = 1"))
    assert main(["import", str(tmp_path / "part.sid")]) == 2
    assert "part.sid:5: the mass has to be positive, not -" in capsys.readouterr().err
    (tmp_path / "part.sid").write_text(text)
    assert main(["import", str(tmp_path / "part.sid"), "--interface", "first"]) == 2
    assert "the file has modes of its own and no stiffness" in capsys.readouterr().err
    assert main(["import", str(tmp_path / "part.sid"), "--error", "0.1", "--up-to", "10"]) == 2
    assert "an error selects computed modes, and the files have modes of their own" in capsys.readouterr().err


def test_damping_that_a_specification_cannot_have_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    first = reduce(DAMPED)
    other = replace(first, damping=np.diag([1.0, 0.1, 3.0, 0.2]))
    result = imported(tmp_path, write(other))
    assert not np.any(reduce(result).damping)  # type: ignore[arg-type]
    assert "warning: the damping (De) is neither a fraction of critical damping nor" in capsys.readouterr().out


def test_moments_are_checked() -> None:
    body = {"positions": [[0, 0, 0]], "modes": np.zeros((1, 1, 3)), "modal_stiffness": [[1.0]]}
    with pytest.raises(derive.SpecError, match=r"1 modes need \(7, 7\)"):
        derive.nodal_body("part", {**body, "moments": np.eye(6)}, units="SI")
    with pytest.raises(derive.SpecError, match="leave out the mass of the nodes, or moments"):
        derive.nodal_body("part", {**body, "moments": np.eye(7), "mass": [1.0]}, units="SI")
    with pytest.raises(derive.SpecError, match="the first of the moments, is 0; a body needs a positive one"):
        derive.nodal_body("part", {**body, "moments": np.diag([0.0] + 6 * [1.0])}, units="SI")
