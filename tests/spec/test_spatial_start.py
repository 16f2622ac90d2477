"""The initial state of a body in space: quaternions, axes and angles, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

import derive
from conftest import ROOT
from derive.spec.toml.read import parse

BLOCK = (ROOT / "scenes/block.toml").read_text()
SOURCE = str(ROOT / "scenes/block.toml")


def read(start: str, rest: str = "") -> derive.NodalBody:
    text = BLOCK.replace("[body.markers]", f"start = {{ {start} }}\n{rest}\n[body.markers]")
    return parse(text, SOURCE)  # type: ignore[return-value]


def test_a_rotation_is_a_quaternion_or_an_axis_with_an_angle() -> None:
    """A quarter turn about e3 is (cos 45, 0, 0, sin 45), whatever the length of the axis."""
    root = np.sqrt(0.5)
    turned = read(f"rotation = {{ axis = [0, 0, 3], angle = {np.pi / 2!r} }}, velocity = [1, 2, 3]").start
    assert turned.quaternion == pytest.approx((root, 0, 0, root), abs=1e-15) and turned.velocity == (1, 2, 3)
    assert read("rotation = [0.6, 0, 0.8, 0]").start.quaternion == (0.6, 0, 0.8, 0)
    found = read("amplitudes = [1e-3, 2e-3]", "[simulation]\nduration = 2\noutput = 0.5")
    assert found.start.amplitudes == (1e-3, 2e-3) and found.simulation == derive.Simulation(2.0, 0.5)
    again = derive.validated(found)
    assert (again.start, again.simulation) == (found.start, found.simulation)


@pytest.mark.parametrize(
    ("start", "message"),
    [
        ("rotation = [1, 1, 0, 0]", "block.toml:15: body.start.rotation: a unit quaternion is needed, and the length"),
        ("rotation = [1, 0, 0]", "body.start.rotation: a list of 4 numbers is needed, such as [1, 0, 0, 0], not 3"),
        ("rotation = { axis = [0, 0, 0], angle = 1 }", "body.start.rotation.axis: [0, 0, 0] is no direction"),
        ("rotation = { axis = [0, 0, 1] }", "body.start.rotation.angle: this key is missing; write angle = 0.5"),
        ("velocity = [1, 2]", "body.start.velocity: a list of 3 numbers is needed"),
        ("amplitudes = 1", "body.start.amplitudes: a list of numbers is needed"),
        ("spin = 3", 'body.start.spin: unknown key; did you mean "angular_velocity"?'),
    ],
)
def test_wrong_initial_states(start: str, message: str) -> None:
    with pytest.raises(derive.SpecError) as error:
        read(start)
    assert message in str(error.value)


def test_a_quaternion_is_one_up_to_rounding_errors() -> None:
    assert read("rotation = [1.0009, 0, 0, 0]").start.quaternion[0] == 1.0009
    with pytest.raises(derive.SpecError, match=r"the length of this one is 1\.0011"):
        read("rotation = [1.0011, 0, 0, 0]")


def test_a_symbolic_body_has_nothing_to_simulate() -> None:
    text = (ROOT / "scenes/body_symbolic.toml").read_text() + "\n[simulation]\nduration = 1\noutput = 0.1\n"
    with pytest.raises(derive.SpecError, match="simulation: a symbolic body has no numbers to simulate with"):
        parse(text)
