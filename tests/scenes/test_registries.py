"""Joints, bodies, forces and outputs from outside the package: read from TOML, compiled, and compared with physics.

The toys know nothing of the rest but the types that they derive from: a rod without mass that keeps the distance of two
markers, a disc that is described by its radius, a spring with a cubic law, a force that turns with the body it acts on,
a torque that brakes, and the speed of a marker.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp

import derive
from derive.extensions import (
    NORMAL_TO_AXIS,
    BodyType,
    Constant,
    Drawing,
    ForceType,
    GeneralisedForce,
    JointType,
    Key,
    KeyType,
    OutputComponent,
    OutputComponents,
    OutputType,
    RelativeMotion,
    RelativeRow,
    force_terms,
    marker_constants,
    quantity_expression,
    rigid_component,
    torque_terms,
)
from derive.simulation.observables.player_data import player_data
from derive.spec.tables.json_schema import json_schema
from derive.spec.toml.read import parse
from derive.visual.mechanism import mechanism_picture
from derive.visual.undeformed_poses import initial_poses
from explicit_motion import moved

G = 9.81


def stretched(joint, d, rotation):
    length = joint.values["distance"]
    return (d.dot(d) - length**2) / (2 * length)


LENGTH = Key("distance", KeyType.POSITIVE_QUANTITY, "m", "The distance of the markers, m.", required=True)


class Distance(JointType):
    """A rod without mass: the distance of two markers is constant."""

    doc = "the distance of the markers is constant"
    removes = (RelativeRow("tension", "{markers} keep their distance", "m", stretched, (LENGTH,)),)
    drawing = Drawing(lines=(((-1, -2), (1, 2)),))


def test_rows_of_a_joint_are_along_its_axes():
    with pytest.raises(TypeError, match="Slot: normal: along other axes than INERTIAL"):

        class Slot(JointType):
            removes = (NORMAL_TO_AXIS,)


class Disc(BodyType):
    """A homogeneous disc."""

    doc = "a homogeneous disc"
    identifying_keys = ("radius",)
    keys = (
        Key("radius", KeyType.POSITIVE, "m", "Its radius, m.", required=True),
        Key("mass", KeyType.POSITIVE_QUANTITY, "kg", "Its mass, kg.", required=True),
    )

    def components(self, body, gravity):
        return (self.about(body, None, gravity),)

    def about(self, body, marker, gravity):
        mass, radius = quantity_expression(body.values["mass"]), sp.Rational(body.values["radius"])
        inertia = mass * radius**2 / 2
        return rigid_component(body.name, mass, inertia, sp.zeros(2, 1), body.markers, marker, gravity)

    def constants(self, body):
        yield Constant(body.values["mass"], f"mass of {body.name}", positive=True)
        yield from marker_constants(body.name, body.markers)


class CubicSpring(ForceType):
    """A spring whose force is stiffness * displacement^3; it has neither damping nor rest length."""

    section = "springs"
    doc = "with a cubic law"
    keys = (Key("stiffness", KeyType.NOT_NEGATIVE_QUANTITY, "N/m^3", "Stiffness, N/m^3.", required=True),)

    def generalised_force(self, element, points, values, rows):
        first, second = points
        d, _, _ = RelativeMotion(first, second).displacement
        squared = sp.expand(d.dot(d))
        force = values["stiffness"] * squared * d
        name = f"spring {element.name}"
        terms = force_terms(name, second, -force, rows) + force_terms(name, first, force, rows)
        return GeneralisedForce(terms, (), sp.expand(values["stiffness"] * squared**2) / 4)


class Follower(ForceType):
    """A force along a direction that is fixed to the section that it acts on."""

    section = "forces"
    doc = "that turns with the section"
    keys = (
        Key("size", KeyType.FUNCTION, "N", "The force, N: a number, or a function of t.", required=True),
        Key("direction", KeyType.DIRECTION, "", "Its direction in the frame of the section.", required=True),
    )

    def generalised_force(self, element, points, values, rows):
        (at,) = points
        cosine, sine = sp.cos(at.rotation), sp.sin(at.rotation)
        unit = values["direction"] / sp.sqrt(values["direction"].dot(values["direction"]))
        force = values["size"] * sp.Matrix([[cosine, -sine], [sine, cosine]]) * unit
        return GeneralisedForce(force_terms(f"force {element.name}", at, force, rows))


class Viscous(ForceType):
    """A torque against the relative angular velocity."""

    section = "torques"
    doc = "of a viscous bearing"
    keys = (Key("drag", KeyType.POSITIVE_QUANTITY, "N m s", "Torque over angular velocity, N m s.", required=True),)

    def generalised_force(self, element, points, values, rows):
        at, against = points
        torque = -values["drag"] * (at.angular_velocity - against.angular_velocity)
        name = f"torque {element.name}"
        terms = torque_terms(name, at, torque, rows) + torque_terms(name, against, -torque, rows)
        return GeneralisedForce(terms)


class Speed(OutputType):
    """The absolute value of the velocity of a marker."""

    doc = "the speed of a marker"
    keys = (Key("marker", KeyType.MARKER, "", "The marker.", required=True),)

    def components(self, name, values, scene):
        velocity = scene.point(values["marker"]).velocity
        return OutputComponents((OutputComponent("", "m/s", sp.sqrt(velocity.dot(velocity))),))


FORCES = {"cubic": CubicSpring(), "follower": Follower(), "viscous": Viscous()}


@pytest.fixture
def toys():
    derive.JOINTS.register("distance", Distance())
    derive.BODIES.register("disc", Disc())
    for kind, force_type in FORCES.items():
        derive.FORCES.register(kind, force_type)
    derive.OUTPUTS.register("speed", Speed())
    yield
    derive.OUTPUTS.unregister("speed")
    derive.JOINTS.unregister("distance")
    derive.BODIES.unregister("disc")
    for kind in FORCES:
        derive.FORCES.unregister(kind)


HEAD = f'name = "toy"\nground.markers = {{ pivot = [0, 0] }}\nscene.gravity = [0, -{G}]\n'
RUN = "\n[simulation]\nduration = 1.0\noutput = 0.05\ntolerance = 1e-10\n"

POINT = """
[bodies.bob]
mass = 2
inertia = 0.1
markers = { centre = [0, 0] }
start = { position = [0.3, -0.4], guess = true }
[joints.rope]
kind = "distance"
between = ["ground.pivot", "bob.centre"]
distance = { symbol = "L", default = 0.5 }
"""

ROLLED = """
[bodies.wheel]
radius = 0.2
mass = { symbol = "m", default = 3 }
markers = { rim = [0, 0.2] }
start = { position = [0.2, 0], angle = 1.5707963267948966 }
[joints.pin]
kind = "revolute"
between = ["ground.pivot", "wheel.rim"]
"""

SPRUNG = """
[bodies.block]
mass = 2
inertia = 1
markers = { middle = [0, 0] }
start = { position = [0.1, 0], velocity = [0.7, 0] }
[joints.guide]
kind = "translational"
between = ["ground.pivot", "block.middle"]
[springs.hard]
kind = "cubic"
between = ["ground.pivot", "block.middle"]
stiffness = 500
"""

PUSHED = """
[bodies.puck]
mass = 2
inertia = 0.1
markers = { centre = [0, 0] }
start = { spin = 3 }
[forces.thrust]
kind = "follower"
at = "puck.centre"
size = "4*t"
direction = [0, 2]
"""

BRAKED = """
[bodies.wheel]
mass = 2
inertia = 0.5
markers = { hub = [0, 0] }
start = { spin = 8 }
[joints.bearing]
kind = "revolute"
between = ["ground.pivot", "wheel.hub"]
[torques.brake]
kind = "viscous"
at = "wheel.hub"
against = "ground.pivot"
drag = { symbol = "D", default = 1.5 }
"""


FAST = """
[outputs.fast]
kind = "speed"
marker = "wheel.hub"
"""


def solution(derivative, start, times):
    """An accurate solution of an ordinary differential equation at the times."""
    tolerances = {"rtol": 1e-12, "atol": 1e-12}
    return solve_ivp(derivative, (0, times[-1]), start, "DOP853", times, **tolerances).y[0]


def pendulum(length, angle, times):
    """The angle of a pendulum from the vertical, which starts at rest."""
    return solution(lambda t, y: [y[1], -G / length * np.sin(y[0])], [angle, 0.0], times)


def test_a_joint_that_keeps_a_distance(toys):
    scene = parse(HEAD + POINT + RUN)
    assert scene.joints[0].values["distance"] == derive.Parameter("L", "m", 0.5)
    assert derive.validated(scene) == scene
    found = moved(scene)
    x, y = found["bob_c1"], found["bob_c2"]
    np.testing.assert_allclose(np.hypot(x, y), 0.5, rtol=1e-9)
    np.testing.assert_allclose(np.arctan2(x, -y), pendulum(0.5, np.arctan2(0.3, 0.4), found.t), atol=1e-8)
    # The rope pulls with m g cos + m v^2 / L, towards the ground.
    cosine, speed = -y / 0.5, np.hypot(found["bob_c1dot"], found["bob_c2dot"])
    np.testing.assert_allclose(np.abs(found["lambda_rope_tension"]), 2 * (G * cosine + speed**2 / 0.5), rtol=1e-7)


def test_a_joint_is_drawn_as_it_declares(toys):
    scene = parse(HEAD + POINT.replace("default = 0.5", "default = 0.6") + RUN)
    x, y, _ = initial_poses(scene)["bob"]  # closed by the equations of the joint, which the picture knows nothing of
    assert np.hypot(x, y) == pytest.approx(0.6)
    assert '<polyline class="fixed"' in mechanism_picture(scene)
    (joint,) = player_data(moved(scene).motion, [])["joints"]
    assert joint["lines"] == Distance.drawing.lines and "axis" not in joint


def test_a_body_that_is_described_by_its_radius(toys):
    scene = parse(HEAD + ROLLED + RUN)
    assert scene.bodies[0].kind == "disc"
    assert derive.validated(scene) == scene
    found = moved(scene)
    assert found.q.shape[1] == 1  # the revolute joint eliminates the other coordinates
    # About the rim J = 3/2 m r^2, so that the reduced length is 3/2 r.
    np.testing.assert_allclose(found["wheel_phi"], pendulum(0.3, np.pi / 2, found.t), atol=1e-8)
    assert derive.scene("two", bodies=[*scene.bodies]).bodies == scene.bodies


def test_a_spring_with_a_cubic_law(toys):
    found = moved(parse(HEAD + SPRUNG + RUN))
    exact = solution(lambda t, y: [y[1], -250 * y[0] ** 3], [0.1, 0.7], found.t)
    np.testing.assert_allclose(found["block_s"], exact, atol=1e-8)


def test_a_force_that_turns_with_the_body(toys):
    scene = parse(HEAD.replace(f"-{G}", "0") + PUSHED + RUN)
    assert derive.validated(scene) == scene
    found = moved(scene)
    # The spin w stays 3 rad/s, and xddot = -2 t sin(w t), from rest.
    w, t = 3.0, found.t
    np.testing.assert_allclose(found["puck_c1dot"], 2 * (t * np.cos(w * t) / w - np.sin(w * t) / w**2), atol=1e-8)
    assert 'class="drive" cx=' in mechanism_picture(scene) and ">thrust<" in mechanism_picture(scene)


def test_a_torque_against_the_angular_velocity(toys):
    scene = parse(HEAD + BRAKED + RUN)
    assert derive.validated(scene) == scene
    assert scene.torques[0].values["drag"] == derive.Parameter("D", "N m s", 1.5)
    found = moved(scene)
    np.testing.assert_allclose(found["wheel_phidot"], 8 * np.exp(-1.5 / 0.5 * found.t), atol=1e-8)
    assert derive.scene("two", bodies=[*scene.bodies], torques=[*scene.torques], ground={"pivot": [0, 0]}).torques


def test_an_output_of_the_speed_of_a_marker(toys):
    scene = parse(HEAD + ROLLED.replace("rim =", "hub = [0, 0], rim =") + FAST + RUN)
    found = moved(scene)
    np.testing.assert_allclose(found["fast"], 0.2 * np.abs(found["wheel_phidot"]), rtol=1e-12)


def refused(text: str) -> str:
    with pytest.raises(derive.SpecError) as caught:
        parse(HEAD + text)
    return str(caught.value)


def test_what_is_registered_is_in_the_schema_and_in_messages(toys):
    assert "the distance of the markers is constant" in json_schema()
    assert "needs the key `distance`: the distance of the markers, m" in refused(POINT.replace("distance =", "# "))
    message = 'a revolute joint has no distance; leave `distance` out, or choose "distance"'
    assert message in refused(POINT.replace('"distance"', '"revolute"'))
    assert 'unknown key; did you mean "radius"?' in refused(ROLLED.replace("mass =", "radus = 1\nmass ="))
    assert "bodies.wheel.mass: this key is missing; write mass = 1.0" in refused(ROLLED.replace("mass =", "# "))
    message = 'a cubic spring has no damping; leave `damping` out, or choose "linear" or "rotational"'
    assert message in refused(SPRUNG + "damping = 1\n")
    message = 'a follower force has no components; leave `components` out, or choose "force"'
    assert message in refused(PUSHED + "components = [1, 2]\n")
    assert "a follower force needs the key `size`: the force, N" in refused(PUSHED.replace("size =", "# "))
    assert "a force has no size; leave `size` out" in refused(PUSHED.replace('"follower"', '"force"'))
    unspecified = PUSHED.split("kind =", maxsplit=1)[0] + 'at = "puck.centre"\n'
    assert "a force needs the key `components`" in refused(unspecified)
    assert '"brake_drag" is taken: it is a name of the torque brake' in refused(BRAKED.replace('"D"', '"brake_drag"'))
    twice = refused(POINT.replace("mass = 2", 'mass = { symbol = "L" }'))
    assert '"L" is the symbol of mass of the body bob, with the unit kg, not m' in twice


def test_a_kind_that_is_not_registered_is_an_error():
    assert 'the joint is one of "revolute", "weld", "fixed", "translational", not "distance"' in refused(POINT)
    assert "the distance of the markers is constant" not in json_schema()
    scene = parse(HEAD + SPRUNG.replace('"cubic"', '"linear"'))
    bad_joint = replace(scene.joints[0], kind="hinge")
    with pytest.raises(derive.UnknownNameError, match='no joint "hinge"; known: revolute, weld, fixed, translational'):
        derive.derive(replace(scene, joints=(bad_joint,)))
    with pytest.raises(derive.UnknownNameError, match='there is no body "cone"'):
        derive.derive(replace(scene, bodies=(derive.CustomBody("c", "cone"),)))
    with pytest.raises(derive.UnknownNameError, match='there is no force "magnet"'):
        derive.derive(replace(scene, springs=(replace(scene.springs[0], kind="magnet"),)))
