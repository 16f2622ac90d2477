"""Joints, springs and outputs in space from outside the package: read from TOML, and compared with physics."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp

import derive
from derive.extensions import (
    ActionLoads,
    Key,
    KeyType,
    MarkerLoad,
    SpatialComponent,
    SpatialJointType,
    SpatialOutputType,
    SpatialSpringType,
)
from derive.spec.tables.json_schema import json_schema
from derive.spec.toml.read import parse

G = 9.81

SLIDER = SpatialJointType("the second point stays in the plane normal to z of the first marker", ("z",))


def cubic(spring, frames, values, turns):
    """A spring whose force is stiffness * displacement^3; it has neither damping nor rest length."""
    d = sp.Matrix(frames[1].position - frames[0].position)
    squared = d.dot(d)
    force = values["stiffness"] * squared * d
    loads = (MarkerLoad(spring.second, -force, sp.zeros(3, 1)), MarkerLoad(spring.first, force, sp.zeros(3, 1)))
    return ActionLoads(spring, loads, potential=values["stiffness"] * squared**2 / 4)


STIFFNESS = Key("stiffness", KeyType.NOT_NEGATIVE_QUANTITY, "N/m^3", "Stiffness, N/m^3.", required=True)
CUBIC = SpatialSpringType("with a cubic law", (STIFFNESS,), cubic, along_line=True)


def speed(values, parts):
    velocity = sp.Matrix(parts.at(values["marker"]).velocity)
    return (SpatialComponent("", "m/s", f"speed of {values['marker']}", sp.sqrt(velocity.dot(velocity))),)


SPEED = SpatialOutputType("speed of a marker", (Key("marker", KeyType.MARKER, "", "", required=True),), ("",), speed)


@pytest.fixture(autouse=True)
def toys() -> Iterator[None]:
    registries = (derive.SPATIAL_JOINTS, derive.SPATIAL_SPRINGS, derive.SPATIAL_OUTPUTS)
    names = ("slider", "cubic", "speed")
    for registry, name, member in zip(registries, names, (SLIDER, CUBIC, SPEED), strict=True):
        registry.register(name, member)
    yield
    for registry, name in zip(registries, names, strict=True):
        registry.unregister(name)


PUCK = """
name = "puck"
scene.gravity = [0, 0, {gravity}]
[ground.markers]
o = {{ at = [0, 0, 0], rotation = {{ axis = [0, 1, 0], angle = 0.5 }} }}
[bodies.puck]
mass = 2
inertia = [0.1, 0.1, 0.1, 0, 0, 0]
markers = {{ centre = [0, 0, 0] }}
start = {{ position = [{x}, 0, 0], velocity = [{v}, 0, 0] }}
[outputs.fast]
kind = "speed"
marker = "puck.centre"
[simulation]
duration = 1
output = 0.1
tolerance = 1e-10
"""
SLOPE = '[joints.slope]\nkind = "slider"\nbetween = ["ground.o", "puck.centre"]\n'
SPRING = """
[springs.mount]
kind = "cubic"
between = ["ground.o", "puck.centre"]
stiffness = { symbol = "K", default = 500 }
"""


def test_a_joint_that_keeps_a_point_in_a_plane_and_an_output_of_its_speed() -> None:
    scene = parse(PUCK.format(gravity=-G, x=0, v=0) + SLOPE)
    assert derive.validated(scene) == scene
    found = derive.simulate(scene)
    np.testing.assert_allclose(found["fast"][1:], G * np.sin(0.5) * found.t[1:], rtol=1e-9)
    np.testing.assert_allclose(np.abs(found.lam), 2 * G * np.cos(0.5), rtol=1e-9)


def test_a_spring_with_a_cubic_law_in_space() -> None:
    scene = parse(PUCK.format(gravity=0, x=0.1, v=0.7) + SPRING)
    assert derive.validated(scene) == scene
    assert scene.springs[0].values["stiffness"] == derive.Parameter("K", "N/m^3", 500.0)
    found = derive.simulate(scene)
    exact = solve_ivp(
        lambda t, y: [y[1], -250 * y[0] ** 3], (0, 1), [0.1, 0.7], "DOP853", found.t, rtol=1e-12, atol=1e-12
    ).y
    np.testing.assert_allclose(found["puck_c1"], exact[0], atol=1e-8)


def test_the_schema_and_messages_know_them() -> None:
    assert all(f'"{name}"' in str(json_schema()).replace("'", '"') for name in ("slider", "cubic", "speed"))
    with pytest.raises(derive.SpecError, match='stiffnes: unknown key; did you mean "stiffness"'):
        parse(PUCK.format(gravity=0, x=0, v=0) + SPRING.replace("stiffness", "stiffnes"))
