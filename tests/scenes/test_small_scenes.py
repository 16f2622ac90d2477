"""Small scenes at the edges: numbers that are no fractions, constants, few coordinates; compared with the oracle."""

from __future__ import annotations

import numpy as np
import pytest
from made import Made, close, make, state
from oracle import Oracle

from derive.roles import Role
from derive.runtime.loading import load
from derive.spec.toml.read import parse

STRICT = ("-std=c99", "-O0", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror")

GROUND = 'name = "small"\n[ground.markers]\na = [0, 0]\nb = [1, 0.5]\n'
ROD = "[bodies.rod]\nmass = 1\nlength = 1\nbending_stiffness = 2\nmarkers = { left = -1, inside = '1/3', right = 1 }\n"
ARM = "[bodies.arm]\nmass = 1\ninertia = 1\nmarkers = { hub = [0.1, 0], end = [1, 0] }\n"


def joint(name: str, kind: str, first: str, second: str, more: str = "") -> str:
    return f'[joints.{name}]\nkind = "{kind}"\nbetween = ["{first}", "{second}"]\n{more}\n'


SHAFT = joint("shaft", "revolute", "ground.a", "arm.hub")
PIN = joint("pin", "revolute", "arm.end", "rod.left")


def driven(motion: str) -> str:
    """A driven arm that carries the rod."""
    return GROUND + ROD + ARM + SHAFT + PIN + f'[drives.motor]\njoint = "shaft"\nmotion = "{motion}"\n'


def fixed(angle: str) -> str:
    """An arm fixed at an angle: no coordinates are left of it."""
    return GROUND + ROD + ARM + PIN + joint("base", "fixed", "ground.a", "arm.hub", f"angle = {angle}")


SLIDER = "[bodies.s]\nmass = 1\ninertia = 1\nmarkers = { p = [0, 0.1] }\n"
RAIL = joint("rail", "translational", "arm.end", "s.p", "axis = [1, 1]")
GUIDE = joint("guide", "translational", "ground.b", "arm.end", "axis = [1, 1]\nangle = 1")
SPRINGS = """
[springs.none]
between = ["ground.a", "ground.b"]
stiffness = 2
rest = 0.1
[springs.p]
between = ["ground.b", "arm.end"]
stiffness = 2
rest = { symbol = "r0", default = 0 }
damping = { symbol = "d0", default = 0 }
[springs.z]
between = ["ground.b", "rod.left"]
stiffness = 0
"""

SCENES = {
    "a root in a drive": driven("sqrt(2)*t - cos(sqrt(3)*t)"),
    "a drive that stands still": driven("sin(2)"),
    "quotients in a drive": driven("t/(1 + t^2)^2 + (1 + t)^3/7 - t^3"),
    "fixed at one radian": fixed("1"),
    "fixed at half a turn": fixed("3.141592653589793"),
    "a rod fixed at its third": GROUND + ROD + joint("base", "fixed", "ground.b", "rod.inside", "angle = -2"),
    "a rail on a fixed arm": fixed("1") + SLIDER + RAIL,
    "a rail on a driven arm": driven("t") + SLIDER + RAIL,
    "springs": GROUND + ROD + ARM + SHAFT + SPRINGS,
    "a guide, at an angle": GROUND + ARM + GUIDE,
    "a pendulum": 'name = "small"\n[scene]\ngravity = [0, -9.81]\n' + GROUND[15:] + ARM + SHAFT,
    "a free body": 'name = "small"\n' + ARM,
    "given shapes": 'name = "small"\n' + ROD + 'frame = "given"\nansatz = ["xi^2", "xi^3"]\n',
}  # fmt: skip


@pytest.fixture(scope="module", params=SCENES)
def made(request: pytest.FixtureRequest) -> Made:
    return make(parse(SCENES[request.param]), complete=True)


def test_they_are_what_the_oracle_says(made: Made) -> None:
    native = made.native
    t, q, v = state(native, 3)
    k = native.setup()
    seen = Oracle(made.spec, native.coordinates, native.multipliers, native.markers).see(t, q, v)
    vdot, lam = native.solve(t, q, v, k)
    close(vdot, seen.vdot, 1e-12)
    close(lam, seen.lam, 1e-12)
    close(native.constraints(t, q, k), seen.g, 1e-14)
    close(native.poses(t, q, k), seen.poses, 1e-14)
    close(native.energy(q, v, k), seen.energy, 1e-14)
    close(made.python["accel"](t, q, v, k), seen.vdot, 1e-12)


@pytest.mark.parametrize(
    ("scene", "roles"),
    [
        ("a guide, at an angle", (Role.DISPLACEMENT,)),
        ("a pendulum", (Role.ROTATION,)),
        ("a free body", (Role.TRANSLATION, Role.TRANSLATION, Role.ROTATION)),
        ("given shapes", (Role.TRANSLATION, Role.TRANSLATION, Role.ROTATION, Role.AMPLITUDE, Role.AMPLITUDE)),
    ],
)
def test_roles_of_the_coordinates(scene: str, roles: tuple[Role, ...]) -> None:
    assert make(parse(SCENES[scene]), complete=True).native.roles == roles


def test_batches_of_c_are_the_same_bit_for_bit(made: Made) -> None:
    native = made.native
    t, q, v = state(native, 3)
    k = native.setup()
    batch = native.accel_batch(t, np.array([q, q]), np.array([v, v]), k)
    assert np.array_equal(batch[1], native.accel(t, q, v, k))


def test_their_code_compiles_without_a_warning(made: Made) -> None:
    load(made.files, STRICT)


def test_a_joint_called_g() -> None:
    """Its multipliers g_1, g_2 beside the output g of the constraints: the centripetal force m r omega^2 of a rod."""
    made = make(
        parse(
            'name = "spinning_rod"\n[ground.markers]\no = [0, 0]\n'
            "[bodies.rod]\nmass = 2\ninertia = 1\nkeep_coordinates = true\nmarkers = { end = [-0.5, 0] }\n"
            '[joints.g]\nkind = "revolute"\nbetween = ["ground.o", "rod.end"]\n'
        )
    )
    k, q, v = made.native.setup(), np.array([0.5, 0.0, 0.0]), np.array([0.0, 1.5, 3.0])
    assert made.native.multipliers == ("g_1", "g_2")
    assert made.native.constraints(0.0, q, k) == pytest.approx([0, 0], abs=1e-15)
    _, lam = made.native.solve(0.0, q, v, k)
    assert lam == pytest.approx([-2 * 0.5 * 3.0**2, 0], abs=1e-14)
