"""Mechanisms with their reference motions, and the scenes of them that the package simulates.

Each has the data, the geometry by which its bodies follow from one or a few coordinates, and a text in TOML.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import sympy as sp
from minimal_models import Array, Lagrangian, MovingBody, OneDegree, Path, grid, turned

SQUARE = 0.1
"""The side of the square cross sections of the bars of Bricard's mechanism, m."""


def numbers(values: Array) -> str:
    """An array of one dimension in TOML."""
    return "[" + ", ".join(repr(float(x) + 0.0) for x in values) + "]"


def axes(R: Array) -> str:
    """A rotation matrix in TOML, by its x and y axes."""
    return f"{{ x = {numbers(R[:, 0])}, y = {numbers(R[:, 1])} }}"


# ---- the double pendulum whose second hinge is turned by 45 degrees


@cache
def turned_double_pendulum() -> Lagrangian:
    """Two bars of 1 m and 1 kg; the first turns by a about z, the second by b about an axis between z and x of it."""
    a, b = sp.symbols("a b")
    first = turned("z", a)
    second = first * turned("y", sp.pi / 4) * turned("z", b)
    arm = sp.Matrix([0, -sp.Rational(1, 2), 0])
    x1, x2 = first * arm, 2 * first * arm + second * arm
    inertia = np.diag([1 / 12, 1e-3, 1 / 12]).tolist()
    bodies = [MovingBody(1, inertia, x1, first), MovingBody(1, inertia, x2, second)]
    return Lagrangian([a, b], bodies, sp.Float("9.81") * (x1[1] + x2[1]))


def turned_double_pendulum_scene(a: float, b: float, *, keep: bool = True) -> str:
    """The scene at the angles a and b, at rest. keep: whether the first bar keeps all coordinates."""
    first, second = (sp.lambdify([], R)() for R in _pendulum_rotations(a, b))
    first, second = (np.array(R, float) for R in (first, second))
    kept = str(keep).lower()
    return f"""
name = "turned_double_pendulum"
[scene]
gravity = [0, -9.81, 0]
[ground.markers]
base = [0, 0, 0]
[bodies.upper]
mass = 1
centre = [0, -0.5, 0]
inertia = ["1/12", 1e-3, "1/12", 0, 0, 0]
keep_coordinates = {kept}
markers.root = [0, 0, 0]
markers.tip = {{ at = [0, -1, 0], rotation = {{ axis = [0, 1, 0], angle = {np.pi / 4!r} }} }}
start = {{ position = [0, 0, 0], rotation = {axes(first)} }}
[bodies.lower]
mass = 1
centre = [0, -0.5, 0]
inertia = ["1/12", 1e-3, "1/12", 0, 0, 0]
markers.root = [0, 0, 0]
start = {{ position = {numbers(first @ [0, -1, 0])}, rotation = {axes(second)} }}
[joints.upper_hinge]
kind = "revolute"
between = ["ground.base", "upper.root"]
[joints.lower_hinge]
kind = "revolute"
between = ["upper.tip", "lower.root"]
[simulation]
duration = 2
output = 0.1
tolerance = 1e-11
"""


def _pendulum_rotations(a: float, b: float) -> tuple[sp.Matrix, sp.Matrix]:
    first = turned("z", sp.Float(a, 30)).evalf(20)
    return first, (first * turned("y", sp.pi / 4) * turned("z", sp.Float(b, 30))).evalf(20)


# ---- the rigid slider-crank in space

CRANK, ROD = 0.08, 0.3
BEARING = np.array([0.0, 0.1, 0.12])
UP = np.array([0.0, 1.0, 0.0])
CRANK_INERTIA, ROD_INERTIA, SLIDER_INERTIA = (1e-4, 1e-5, 1e-4), (4e-4, 4e-3, 4e-3), (1e-4, 1e-4, 1e-4)
SLIDER_CRANK_MASSES = (0.12, 0.5, 2.0)


def crank_pin(angle: Array) -> Array:
    """The positions of the pin (..., 3): at the angle 0 the crank points along z, and it turns about x."""
    across = np.stack([0 * angle, -np.sin(angle), np.cos(angle)], axis=-1)
    return np.asarray(BEARING + CRANK * across)


def slider(angle: Array) -> Array:
    """The displacement of the slider along x."""
    pin = crank_pin(angle)
    return np.asarray(pin[..., 0] + np.sqrt(ROD**2 - pin[..., 1] ** 2 - pin[..., 2] ** 2))


def rod_rotation(angle: Array) -> Array:
    """The rotations of the rod (..., 3, 3): x along it to the pin, y normal to the y axis of the slider (UP)."""
    ends = slider(angle)[..., None] * np.array([1.0, 0, 0])
    along = (crank_pin(angle) - ends) / ROD
    across = np.cross(UP, along)
    across = across / np.linalg.norm(across, axis=-1, keepdims=True)
    return np.stack([along, across, np.cross(along, across)], axis=-1)


def crank_rotation(angle: Array) -> Array:
    """The rotations of the crank: its y axis points along it, its z axis is the inertial x."""
    along = (crank_pin(angle) - BEARING) / CRANK
    z = np.broadcast_to([1.0, 0, 0], along.shape)
    return np.stack([np.cross(along, z), along, z], axis=-1)


@cache
def slider_crank() -> OneDegree:
    """The mechanism in the angle of the crank, under gravity along -y."""
    s = grid()
    ends = slider(s)[:, None] * np.array([1.0, 0, 0])
    crank, rod, mass = SLIDER_CRANK_MASSES
    # the moments of the crank about its axes: that about its length is the small one
    return OneDegree(
        [
            Path(crank, np.diag(CRANK_INERTIA), BEARING + (crank_pin(s) - BEARING) / 2, crank_rotation(s)),
            Path(rod, np.diag(ROD_INERTIA), (ends + crank_pin(s)) / 2, rod_rotation(s)),
            Path(mass, np.diag(SLIDER_INERTIA), ends, np.broadcast_to(np.eye(3), (len(s), 3, 3))),
        ],
        [0, -9.81, 0],
    )


def slider_crank_scene(speed: float, *, keep: bool = True, angle: float = 0.0) -> str:
    """The scene at an angle of the crank; revolute, spherical, universal and prismatic joints leave one degree."""
    at = np.array(angle)
    crank, rod, mass = SLIDER_CRANK_MASSES
    kept = str(keep).lower()

    def six(values: tuple[float, ...]) -> str:
        return numbers(np.array([*values, 0, 0, 0]))

    return f"""
name = "spatial_slider_crank"
[scene]
gravity = [0, -9.81, 0]
[ground.markers]
bearing = {{ at = {numbers(BEARING)}, rotation = {{ x = [0, 1, 0], z = [1, 0, 0] }} }}
guide = {{ at = [0, 0, 0], rotation = {{ x = [0, 1, 0], z = [1, 0, 0] }} }}
[bodies.crank]
mass = {crank}
centre = [0, {CRANK / 2}, 0]
inertia = {six(CRANK_INERTIA)}
keep_coordinates = {kept}
markers = {{ bearing = [0, 0, 0], pin = [0, {CRANK}, 0] }}
start = {{ position = {numbers(BEARING)}, rotation = {axes(crank_rotation(at))}, angular_velocity = [0, 0, {speed}] }}
[bodies.rod]
mass = {rod}
centre = [{ROD / 2}, 0, 0]
inertia = {six(ROD_INERTIA)}
markers.pin = [{ROD}, 0, 0]
markers.slider = {{ at = [0, 0, 0], rotation = {{ x = [0, 1, 0], z = [1, 0, 0] }} }}
start = {{ position = {numbers(np.array([slider(at), 0, 0]))}, rotation = {axes(rod_rotation(at))} }}
[bodies.slider]
mass = {mass}
inertia = {six(SLIDER_INERTIA)}
keep_coordinates = {kept}
markers.guide = {{ at = [0, 0, 0], rotation = {{ x = [0, 1, 0], z = [1, 0, 0] }} }}
markers.rod = {{ at = [0, 0, 0], rotation = {{ x = [1, 0, 0], z = [0, 1, 0] }} }}
start = {{ position = {numbers(np.array([slider(at), 0, 0]))} }}
[joints.bearing]
kind = "revolute"
between = ["ground.bearing", "crank.bearing"]
[joints.pin]
kind = "spherical"
between = ["crank.pin", "rod.pin"]
[joints.cross]
kind = "universal"
between = ["slider.rod", "rod.slider"]
[joints.guide]
kind = "prismatic"
between = ["ground.guide", "slider.guide"]
[simulation]
duration = 2
output = 0.05
tolerance = 1e-11
"""


# ---- Bricard's mechanism

TWISTS = (1, -1, 1, -1, 1, -1)


def bricard_angles(s: Array) -> tuple[Array, Array]:
    """The angles (theta, phi) of odd and even hinges, on cos theta cos phi + cos theta + cos phi = 0.

    s is the direction from (0, 0) of that point in the plane of both angles; at s = pi/4 both are a right angle.
    """
    c, d, radius = np.cos(s), np.sin(s), np.full(np.shape(s), 2.1)
    for _ in range(60):  # Newton's method, along a ray
        a, b = np.cos(radius * c), np.cos(radius * d)
        slope = -c * np.sin(radius * c) * (1 + b) - d * np.sin(radius * d) * (1 + a)
        radius = radius - (a * b + a + b) / slope
    return radius * c, radius * d


def bricard_chain(s: Array) -> tuple[list[Array], list[Array]]:
    """Starting points (..., 3) and rotations (..., 3, 3) of the bars 1 to 6, of which bar 6 is the ground.

    A bar points along its x axis; hinge i turns bar i about the z axis behind bar i - 1, which each bar twists by a
    right angle, to one side and the other by turns.
    """
    theta, phi = bricard_angles(s)
    R = np.broadcast_to(np.eye(3), (*np.shape(s), 3, 3))
    x = np.broadcast_to(np.zeros(3), (*np.shape(s), 3))
    starts, rotations = [], []
    for i, twist in enumerate(TWISTS):
        angle = theta if i % 2 == 0 else phi
        c, d, zero, one = np.cos(angle), np.sin(angle), 0 * angle, 1 + 0 * angle
        turn = np.stack([np.stack(row, axis=-1) for row in ((c, -d, zero), (d, c, zero), (zero, zero, one))], axis=-2)
        R = R @ turn
        starts.append(x)
        rotations.append(R)
        x = x + R[..., 0]
        R = R @ np.array([[1, 0, 0], [0, 0, -twist], [0, twist, 0]])
    return [*starts, x], [*rotations, R]


@cache
def bricard() -> OneDegree:
    """Five bars of 1 m and 1 kg between two hinges of a fixed bar, in the coordinate s; gravity along -y."""
    starts, rotations = bricard_chain(grid())
    inertia = np.diag([SQUARE**2 / 6, (1 + SQUARE**2) / 12, (1 + SQUARE**2) / 12])
    bodies = [Path(1.0, inertia, x + R[..., 0] / 2, R) for x, R in zip(starts[:5], rotations[:5], strict=True)]
    return OneDegree(bodies, [0, -9.81, 0])


def bricard_scene(s: float) -> str:
    """The scene at s, at rest: six hinges, of which no five are enough and one equation is redundant."""
    starts, rotations = bricard_chain(np.array(s))
    lines = [
        'name = "bricard"',
        "[scene]",
        "gravity = [0, -9.81, 0]",
        "[ground.markers]",
        "first = [0, 0, 0]",
        f"last = {{ at = {numbers(starts[5])}, rotation = {axes(rotations[5])} }}",
    ]
    inertia = numbers(np.array([SQUARE**2 / 6, (1 + SQUARE**2) / 12, (1 + SQUARE**2) / 12, 0, 0, 0]))
    for i in range(5):
        twist = f"{{ x = [1, 0, 0], z = [0, {-TWISTS[i]}, 0] }}"
        lines += [
            f"[bodies.bar{i + 1}]",
            "mass = 1",
            "centre = [0.5, 0, 0]",
            f"inertia = {inertia}",
            "keep_coordinates = true",
            "markers.near = [0, 0, 0]",
            f"markers.far = {{ at = [1, 0, 0], rotation = {twist} }}",
            f"start = {{ position = {numbers(starts[i])}, rotation = {axes(rotations[i])} }}",
        ]
    ends = ["ground.first", *(f"bar{i}.{end}" for i in range(1, 6) for end in ("near", "far")), "ground.last"]
    for i in range(6):
        lines += [f"[joints.hinge{i + 1}]", 'kind = "revolute"', f'between = ["{ends[2 * i]}", "{ends[2 * i + 1]}"]']
    lines += ["[simulation]", "duration = 2", "output = 0.05", "tolerance = 1e-11"]
    return "\n".join(lines) + "\n"


# ---- the flyball governor, with springs in place of the lower rods

BAR_MASS, BALL_MASS, SLIDER_MASS = 0.3, 5.0, 3.0
HALF_WIDTH, SPRING_LENGTH = 0.05, 0.5
STIFFNESS, DAMPING = 8e5, 4e4
BAR_INERTIA = BAR_MASS / 12 * (1 + 1e-4), BAR_MASS / 12 * (1 + 1e-4), BAR_MASS / 12 * 2e-4


@cache
def flyball_governor(damping: float = DAMPING) -> Lagrangian:
    """The shaft turns by psi about z; both rods are inclined by a from the vertical; the slider is at s on the shaft.

    A rod of 1 m hangs from a hinge at the top of the shaft, 1 m high, and has a ball at its end and a spring from its
    middle to the slider.
    """
    psi, a, s = sp.symbols("psi a s")
    shaft = turned("z", psi)
    bodies = [
        MovingBody(BAR_MASS, np.diag(BAR_INERTIA).tolist(), sp.Matrix([0, 0, sp.Rational(1, 2)]), shaft),
        MovingBody(SLIDER_MASS, (np.eye(3) * SLIDER_MASS * 0.01 / 6).tolist(), sp.Matrix([0, 0, s]), shaft),
    ]
    weight = SLIDER_MASS * s
    for side in (1, -1):
        top = sp.Matrix([side * HALF_WIDTH, 0, 1])
        along = sp.Matrix([side * sp.sin(a), 0, -sp.cos(a)])
        R = shaft * turned("y", -side * a)
        bodies.append(MovingBody(BAR_MASS, np.diag(BAR_INERTIA).tolist(), shaft * (top + along / 2), R))
        bodies.append(MovingBody(BALL_MASS, np.zeros((3, 3)).tolist(), shaft * (top + along), R))
        weight += BAR_MASS * (top + along / 2)[2] + BALL_MASS * (top + along)[2]
    distance = sp.sqrt((sp.sin(a) / 2) ** 2 + (1 - sp.cos(a) / 2 - s) ** 2)
    V = sp.Float("9.81") * weight + sp.Float(STIFFNESS) * (distance - SPRING_LENGTH) ** 2

    def dissipation(rates: sp.Matrix) -> sp.Expr:
        return sp.Float(damping) * (distance.diff(a) * rates[1] + distance.diff(s) * rates[2]) ** 2

    return Lagrangian([psi, a, s], bodies, V, dissipation)


GOVERNOR_START = (0.0, np.pi / 3, 0.5)
GOVERNOR_SPEED = 2 * np.pi


def flyball_governor_scene(*, keep: bool = True) -> str:
    """The scene at a = 60 degrees and s = 0.5 m, turning with a revolution each second. Balls are parts of the rods."""
    mass = BAR_MASS + BALL_MASS
    centre = -(BAR_MASS * 0.5 + BALL_MASS) / mass
    about = BAR_INERTIA[0] + BAR_MASS * (0.5 + centre) ** 2 + BALL_MASS * (1 + centre) ** 2
    rod_inertia = numbers(np.array([about, about, BAR_INERTIA[2], 0, 0, 0]))
    a, kept = GOVERNOR_START[1], str(keep).lower()
    across = "{ x = [1, 0, 0], z = [0, 1, 0] }"
    lines = [
        f"""
name = "flyball_governor"
[scene]
gravity = [0, 0, -9.81]
[ground.markers]
base = [0, 0, 0]
[bodies.shaft]
mass = {BAR_MASS}
centre = [0, 0, 0.5]
inertia = {numbers(np.array([*BAR_INERTIA, 0, 0, 0]))}
keep_coordinates = {kept}
markers.foot = [0, 0, 0]
markers.right = {{ at = [{HALF_WIDTH}, 0, 1], rotation = {across} }}
markers.left = {{ at = [{-HALF_WIDTH}, 0, 1], rotation = {across} }}
start = {{ position = [0, 0, 0], rotation = [1, 0, 0, 0], angular_velocity = [0, 0, {GOVERNOR_SPEED!r}] }}
[bodies.slider]
mass = {SLIDER_MASS}
inertia = {numbers(np.array([*[SLIDER_MASS * 0.01 / 6] * 3, 0, 0, 0]))}
markers = {{ centre = [0, 0, 0], right = [{HALF_WIDTH}, 0, 0], left = [{-HALF_WIDTH}, 0, 0] }}
start = {{ position = [0, 0, 0.5], rotation = [1, 0, 0, 0] }}
[joints.bearing]
kind = "revolute"
between = ["ground.base", "shaft.foot"]
[joints.sleeve]
kind = "prismatic"
between = ["shaft.foot", "slider.centre"]
"""
    ]
    for name, side in (("right", 1), ("left", -1)):
        R = np.array([[np.cos(a), 0, -side * np.sin(a)], [0, 1, 0], [side * np.sin(a), 0, np.cos(a)]])
        lines.append(f"""
[bodies.{name}_rod]
mass = {mass}
centre = [0, 0, {centre!r}]
inertia = {rod_inertia}
markers.top = {{ at = [0, 0, 0], rotation = {across} }}
markers.middle = [0, 0, -0.5]
start = {{ position = [{side * HALF_WIDTH}, 0, 1], rotation = {axes(R)} }}
[joints.{name}_hinge]
kind = "revolute"
between = ["shaft.{name}", "{name}_rod.top"]
[springs.{name}_spring]
between = ["slider.{name}", "{name}_rod.middle"]
stiffness = {STIFFNESS}
damping = {DAMPING}
rest = {SPRING_LENGTH}
""")
    lines.append("[simulation]\nduration = 0.5\noutput = 0.05\ntolerance = 1e-10\n")
    return "".join(lines)
