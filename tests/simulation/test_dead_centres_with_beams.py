"""Parallel cranks with a beam between them pass the positions in which they are in line with it.

There the beam loads the cranks unequally, so that the reactions that keep them parallel grow without bound.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from derive.simulation.errors import TooNearDeadCentre
from derive.simulation.prepared_run import PreparedRun
from derive.simulation.trajectory import Trajectory
from derive.spec.model.scene import Scene
from derive.spec.toml.read import parse

G, STIFFNESS = 9.81, 200
CRANK = """[bodies.NAME]
mass = 1
inertia = "1/12"
markers = { bearing = [0, -0.5], pin = [0, 0.5] }
start = { position = [X, 0.5], spin = SPIN }
[joints.foot_NAME]
kind = "revolute"
between = ["ground.NAME", "NAME.bearing"]
[joints.pin_NAME]
kind = "revolute"
between = ["NAME.pin", "beam.NAME"]
"""
SCENE = f"""name = "cranks"
[scene]
gravity = [0, -{G}]
redundant = "REDUNDANT"
[ground.markers]
a = [0, 0]
b = [1, 0]
c = [2, 0]
[bodies.beam]
length = 2
mass = 1
bending_stiffness = {STIFFNESS}
SHAPES
markers = {{ a = -1, b = 0, c = 1 }}
start = {{ position = [1, 1] }}
{"".join(CRANK.replace("NAME", name).replace("X", str(x)) for x, name in enumerate("abc"))}
[simulation]
duration = 1.5
output = 0.05
tolerance = TOLERANCE
"""
MEAN = 'frame = "mean"\nansatz = ["1", "xi", "xi^2", "xi^3"]'
CHORD = MEAN.replace("mean", "chord")
VIBRATING = MEAN.replace('"xi^3"', '"xi^3", "xi^4"')


def moved(shapes: str, spin: float, tolerance: float = 1e-9, redundant: str = "resolve") -> Trajectory:
    text = SCENE
    for name, value in (("SHAPES", shapes), ("SPIN", spin), ("TOLERANCE", tolerance), ("REDUNDANT", redundant)):
        text = text.replace(name, str(value))
    scene = parse(text)
    assert isinstance(scene, Scene)
    return PreparedRun(scene, "adaptive", complete=False).trajectory()


def motion(times: np.ndarray, spin: float, flexible: bool) -> np.ndarray:
    """The angle of the cranks in minimal coordinates.

    The second one is the amplitude of (1 - x^2) x^2, the only deflection that moves none of the pins: integrals of the
    shape, of its square and of the square of its second derivative are 4/15, 16/315 and 33.6.
    """
    first, second, stiffness = 4 / 15 / 2, 16 / 315 / 2, 33.6 * STIFFNESS

    def rates(_: float, y: np.ndarray) -> list[float]:
        angle, amplitude, rate, change = y
        sine, cosine = np.sin(angle), np.cos(angle)
        mass = np.array([[2, -first * sine], [-first * sine, second]])
        load = np.array([2.5 * G * sine, first * (cosine * rate**2 - G) - stiffness * amplitude])
        return [rate, change, *(np.linalg.solve(mass, load) if flexible else (load[0] / 2, 0))]

    start = [0, 0, spin, 0]
    solution = solve_ivp(rates, (0, times[-1]), start, "DOP853", times, rtol=1e-12, atol=1e-12)
    return np.asarray(solution.y[0])


@pytest.mark.parametrize(
    ("shapes", "spin"),
    [(MEAN, -1), (CHORD, -1.3), *(pytest.param(*case, marks=pytest.mark.long) for case in ((MEAN, -1.3), (CHORD, -1)))],
)
def test_a_beam_that_its_pins_hold_straight_moves_as_a_rod(shapes: str, spin: float) -> None:
    """The motion passes the position once, after 1.2 s."""
    of = moved(shapes, spin)
    expected = motion(of.t, spin, False)
    assert expected[-1] < -1.5 * np.pi
    for crank in "abc":
        assert of[f"{crank}_phi"] == pytest.approx(expected, abs=1e-7)


@pytest.mark.long
def test_a_beam_that_vibrates_between_its_pins_passes_as_well() -> None:
    of = moved(VIBRATING, -1, 1e-8)
    expected = motion(of.t, -1, True)
    assert np.abs(expected - motion(of.t, -1, False)).max() > 5e-5
    for crank in "abc":
        assert of[f"{crank}_phi"] == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("redundant", ["auto", pytest.param("resolve", marks=pytest.mark.long)])
def test_steps_that_are_too_short_to_pass_are_reported(redundant: str) -> None:
    """Vibrations allow no longer ones."""
    with pytest.raises(TooNearDeadCentre, match="a larger tolerance, such as 1e-09, or of generalised-alpha"):
        moved(VIBRATING, -1, 1e-10, redundant)
