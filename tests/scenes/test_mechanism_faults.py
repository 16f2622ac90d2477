"""Scenes with flexible bodies that cannot start, or cannot go on: the messages, and the residuals in them.

Rigid ones are in `tests/simulation`. A beam does not stretch, but to first order its ends come nearer or get further
apart as it bends, so that what is singular for straight beams need not be for bent ones.
"""

from __future__ import annotations

import numpy as np
import pytest
from made import Made, of

from constraint_analysis import analyse_constraints
from derive.simulation.errors import (
    DriveCannotBeFollowed,
    ExcessiveDeformation,
    RedundantConstraints,
    SingularConfiguration,
)
from derive.simulation.initial.closest_consistent_state import closest_consistent_state
from derive.simulation.integration.scipy_methods import integrate

ONE_BEAM = ("pieces = 3 ", "pieces = 1 ")


def changed(text: str, *changes: tuple[str, str]) -> str:
    """A text with some of it replaced, once each, and without its plots."""
    text = text[: text.index("[plots.")]
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


def folding(text: str) -> str:
    """A crank as long as the rod, turned slowly: it folds after a quarter of a turn."""
    slider = "start = { position = [0.45, 0] }\n\n[joints.crank_bearing]"
    return changed(
        text,
        ONE_BEAM,
        (slider, slider.replace("0.45", "0.6")),
        ("pin = [0.15, 0]", "pin = [0.3, 0]"),
        ("position = [0.3, 0]", "position = [0.45, 0]"),
        ("speed = 150", "speed = 1"),
    )


def pushed(text: str) -> str:
    """A crank with inertia; the slider is driven, from where all is in line to where the crank is folded back."""
    hub = "markers = { hub = [0, 0], pin = [0.15, 0] }"
    heavy = f"mass = 0.1\ninertia = 1e-3\ncentre = [0.075, 0]\n{hub}"
    given = 'joint = "crank_bearing"\nspeed = 150'
    return changed(text, ONE_BEAM, (hub, heavy), (given, 'joint = "guide"\nmotion = "0.45 - 0.3*t"'))


def straight(made: Made, angle: float) -> tuple[float, np.ndarray]:
    """The time at which the slider is where that crank angle has it, and the coordinates there; the rod is not bent."""
    tilt = -np.arcsin(np.sin(angle) / 2)
    pin, end = 0.15 * np.exp(1j * angle), 0.15 * np.cos(angle) + 0.3 * np.cos(tilt)
    q = dict.fromkeys(made.native.coordinates, 0.0)
    q |= {"crank_phi": angle, "rod_c1": (pin.real + end) / 2, "rod_c2": pin.imag / 2, "rod_phi": tilt}
    return (0.45 - end) / 0.3, np.array([*q.values()])


def turned(made: Made, angle: float) -> np.ndarray:
    """Coordinates of a folding crank-slider whose rod is straight, as rigid bodies would have it."""
    q = dict.fromkeys(made.native.coordinates, 0.0)
    pin = 0.3 * np.exp(1j * angle)
    q |= {"rod_c1": 1.5 * pin.real, "rod_c2": pin.imag / 2, "rod_phi": -angle, "slider_s": 2 * pin.real}
    return np.array([*q.values()])


def test_a_crank_as_long_as_the_rod_is_singular_where_it_folds() -> None:
    """The smallest singular value of scaled constraints goes with cos(phi) for a straight rod, and is zero there."""
    made = of("crank_slider_3", folding)
    k = made.native.setup()
    smallest = []
    for t in (1.5, 1.56, np.pi / 2):
        q = turned(made, t)
        assert np.abs(made.native.constraints(t, q, k)).max() < 1e-15
        found = analyse_constraints(made.native, k, t, q)
        smallest.append(found.smallest)
    assert smallest[0] / np.cos(1.5) == pytest.approx(smallest[1] / np.cos(1.56), rel=0.01)
    assert smallest[2] < 1e-15
    assert found.rank == 3
    assert found.involved == ("crank_pin_2", "slider_pin_2")


def test_a_crank_that_comes_to_where_it_folds_cannot_be_followed() -> None:
    made = of("crank_slider_3", folding)
    with pytest.raises(DriveCannotBeFollowed, match=r"at t = 1.5707.*crank_pin_2 and slider_pin_2") as error:
        made.run(np.linspace(0, 2, 201))
    assert error.value.smallest < 1e-6
    assert error.value.t == pytest.approx(np.pi / 2, abs=1e-5)
    assert not error.value.locked  # it could go on, in two ways


@pytest.mark.parametrize("angle", [0.0, np.pi])
def test_a_slider_that_is_driven_cannot_start_in_line(angle: float) -> None:
    made = of("crank_slider_3", pushed)
    t, q = straight(made, angle)
    rigid = np.array(["alpha" not in name for name in made.native.coordinates])
    with pytest.raises(SingularConfiguration, match=r"dead centre at t = .*crank_pin_1 and slider_pin_1") as error:
        closest_consistent_state(made.native, made.native.setup(), q, 0 * q, rigid, t)
    assert error.value.t == pytest.approx(t)
    assert error.value.smallest < 1e-9


def test_a_slider_that_is_driven_into_line_cannot_be_followed() -> None:
    """It comes to where the crank is folded back at t = 1 s, and would have to go on."""
    made = of("crank_slider_3", pushed)
    t, q = straight(made, 2.0)
    k, native = made.native.setup(), made.native
    rigid = np.array(["alpha" not in name for name in native.coordinates])
    start = closest_consistent_state(native, k, q, 0 * q, rigid, t)
    assert start.q == pytest.approx(q, abs=1e-14) and start.velocity_error < 1e-14
    with pytest.raises(DriveCannotBeFollowed, match="crank_pin_1 and slider_pin_1") as error:
        integrate(native, k, start.q, start.v, np.linspace(t, 1.2, 31), tolerance=1e-7)
    assert error.value.t == pytest.approx(1, abs=1e-4)
    assert error.value.smallest < 1e-3


def twice(text: str) -> str:
    """The four-bar with one of its joints given once more, the other way round."""
    return changed(text) + '[joints.again]\nkind = "revolute"\nbetween = ["rocker.right", "coupler.right"]\n'


def test_a_joint_that_is_there_twice_is_named() -> None:
    made = of("four_bar", twice)
    with pytest.raises(RedundantConstraints, match=r"again_1 is implied by rocker_pin_1\n.*again_2 is") as error:
        made.start()
    assert [(d.name, d.on) for d in error.value.redundant] == [
        ("again_1", ("rocker_pin_1",)),
        ("again_2", ("rocker_pin_2",)),
    ]


def clamped(text: str) -> str:
    """The spinning beam without spin, held at both ends."""
    ends = "[ground.markers]\na = [-0.5, 0]\nb = [0.5, 0]\n"
    for end, side in (("a", "left"), ("b", "right")):
        ends += f'[joints.{end}]\nkind = "fixed"\nbetween = ["ground.{end}", "beam.{side}"]\n'
    quartic = ('"xi^3"]', '"xi^3", "xi^4"]')
    return changed(text, ("start = { spin = 25 }", ""), quartic) + ends


def test_a_beam_that_is_clamped_twice_is_held_along_its_axis_twice() -> None:
    """Its axis does not stretch. With six constraints on six coordinates a shape is left to move."""
    made = of("spinning_beam", clamped)
    with pytest.raises(RedundantConstraints) as error:
        made.start()
    assert [(d.name, d.on) for d in error.value.redundant] == [("b_1", ("a_1",))]


def test_a_four_bar_closes_from_a_poor_guess() -> None:
    """The guess is metres and radians away; no link is bent, and rates are those of the drive, which is at rest."""
    made = of("four_bar")
    k, native = made.native.setup(), made.native
    rigid = np.array(["alpha" not in name for name in native.coordinates])
    for seed in range(5):
        rng = np.random.default_rng(seed)
        found = closest_consistent_state(
            native, k, rng.uniform(-2, 2, native.nq) * rigid, rng.uniform(-3, 3, native.nv) * rigid, rigid
        )
        assert found.position_error < 1e-12 and found.velocity_error < 1e-11
        assert not found.deformed and not np.any(found.q[~rigid])


def apart(text: str) -> str:
    """A ground link of 4 m, which all others together do not span."""
    return changed(text, ("right = [1.2, 0]", "right = [4, 0]"))


def test_links_that_are_too_short_to_close_are_not_bent_until_they_do() -> None:
    """They could be, by more than twice the length of the rocker."""
    with pytest.raises(ExcessiveDeformation, match=r"only by bending .*rocker by 2\.\d+ of the length"):
        of("four_bar", apart).start()
