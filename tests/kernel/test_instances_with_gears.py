"""Gears in loops over bodies in space: as in straight-line code, whatever their joints are, in code of one length."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from both_lowerings import OF_LEAST_NORM, System, both, check, results
from random_graphs import Graph, random_state
from test_instances_in_space import BEAMS, LINKS, MIXED, TURNED

import derive
from derive.errors import SpecError
from derive.lowering.flat.lower import lower as lower_flat
from derive.lowering.instances.lower import lower_instances
from derive.lowering.mechanism_costs import estimate_mechanism_costs, is_predicted
from derive.mechanics.multibody.space.mechanism import SpatialMechanism
from derive.spec.toml.read import parse

WHEEL = """
[joints.axle]
kind = "revolute"
between = ["ground.pivot", "wheel.hub"]
[bodies.wheel]
mass = 1
inertia = [0.1, 0.1, 0.1, 0, 0, 0]
markers = { hub = [0, 0, 0] }
[gears.teeth]
joints = ["shaft", "axle"]
ratio = "-1/2"
"""
BETWEEN_HINGES = """
[gears.mesh]
count = {count}
joints = ["hinge[i]", "hinge[i+1]"]
ratio = "-3/2"
"""
AT_THE_GROUND = """
[gears.first]
joints = ["hook", "hinge[0]"]
ratio = 2
"""
RACK = """
name = "rack"
[scene]
gravity = [0.3, 0.5, -9.81]
lowering = "instances"
[ground.markers]
a = { at = [0.1, 0, 0], rotation = { axis = [1, 1, 0], angle = 0.3 } }
b = [0.5, 0.2, 0.1]
[bodies.wheel]
mass = { symbol = "m", default = 1.2 }
inertia = [1e-2, 4e-2, 4e-2, 1e-3, 0, 2e-3]
markers = { hub = [0, 0.02, 0] }
keep_coordinates = true
[bodies.rack]
mass = 0.5
inertia = [1e-2, 2e-2, 2.5e-2, 0, 0, 0]
markers = { tooth = [0.1, 0, 0] }
[joints.axle]
kind = "revolute"
between = ["ground.a", "wheel.hub"]
[joints.guide]
kind = "prismatic"
between = ["rack.tooth", "ground.b"]
[gears.mesh]
joints = ["axle", "guide"]
ratio = { symbol = "r", default = 0.07 }
offset = { symbol = "o", default = 0.1 }
[outputs.held]
kind = "reaction"
joint = "guide"
"""


def links(count: int, gears: str = "") -> str:
    """A chain of hinges with gears."""
    return LINKS.format(kind="revolute", count=count, joints=count - 1, turned=TURNED) + gears


@pytest.mark.parametrize(
    "gears",
    [AT_THE_GROUND, pytest.param(AT_THE_GROUND + BETWEEN_HINGES.format(count=1), marks=pytest.mark.long)],
)
def test_gears_between_hinges_that_have_a_body_in_common(gears: str) -> None:
    check(both(parse(links(3, gears)), True))


@pytest.mark.parametrize("explicit", [True, pytest.param(False, marks=pytest.mark.long)])
def test_a_gear_between_a_driven_mechanism_and_a_wheel_with_minimal_coordinates(explicit: bool) -> None:
    """The gear acts on what both joints, which have eliminated coordinates, leave."""
    of = both(parse(MIXED + WHEEL), explicit)
    assert [m.name for m in of.instances.multipliers][-1] == "teeth"
    check(of)


@pytest.mark.long
def test_a_driven_joint_with_a_gear() -> None:
    drive = '[drives.motor]\njoint = "hinge[0]"\nmotion = "sin(2*t)"\n'
    check(both(parse(links(4, BETWEEN_HINGES.format(count=1) + drive)), False))


@pytest.mark.long
def test_a_gear_between_beams() -> None:
    check(both(parse(BEAMS.format(order=1, kind="revolute", frame='"mean"') + AT_THE_GROUND), True))


def test_derivatives_by_ratios_and_offsets() -> None:
    """Of all functions, with a displacement that a rotation of a body with all coordinates gives."""
    scene = parse(RACK)
    mechanism = derive.derive(scene)
    flat = lower_flat(mechanism.expanded(), sensitivities=True)
    loops = lower_instances(mechanism, sensitivities=True)
    assert "parameter_jacobian" in [kernel.name for kernel in loops.kernels]
    check(Graph(scene, "", flat, loops, random_state(flat, scene, np.random.default_rng(1))))


@pytest.mark.long
def test_redundant_gears() -> None:
    """The third of three gears between three hinges follows from the others: reactions are of least norm."""
    third = AT_THE_GROUND.replace("first", "third").replace("hinge[0]", "hinge[1]").replace("2", "-3")
    scene = parse(links(3, AT_THE_GROUND + BETWEEN_HINGES.format(count=1) + third))
    of = both(scene, True, proximal=True)
    flat, loops = (results(of, model, "solve") for model in (of.flat, of.instances))
    system = System(of)
    assert max(system.residuals(loops["vdot"], loops["lam"])) <= OF_LEAST_NORM
    assert system.norm(loops["vdot"] - flat["vdot"]) <= OF_LEAST_NORM * system.norm(flat["vdot"])
    assert np.allclose(loops["lam"], flat["lam"], rtol=0, atol=OF_LEAST_NORM * abs(flat["lam"]).max())


def test_the_code_does_not_grow_with_the_number_of_gears() -> None:
    """A chain with a gear between each two hinges."""

    def sizes(count: int) -> list[int]:
        scene = parse(links(count, BETWEEN_HINGES.format(count=count - 2)))
        return [len(str(kernel.statements)) for kernel in derive.lower(derive.derive(scene), explicit=True).kernels]

    few, many = sizes(6), sizes(9)
    assert np.abs(np.log(np.array(many) + 1.0) - np.log(np.array(few) + 1.0)).max() < 0.05


def test_long_chains_with_a_gear_get_loops_by_themselves() -> None:
    """Where the compiler would take too long for straight-line code; measured: 0.43 of the time with 12 links."""

    def chosen(count: int) -> str:
        scene = replace(parse(links(count, AT_THE_GROUND)), lowering="auto", coordinates="absolute")
        mechanism = derive.derive(scene)
        assert isinstance(mechanism, SpatialMechanism)
        assert is_predicted(mechanism)
        return estimate_mechanism_costs(mechanism).lowering

    assert [chosen(count) for count in (3, 12)] == ["flat", "instances"]


def test_a_gear_between_bodies_that_drives_move_is_refused() -> None:
    """As in straight-line code: nothing could meet it."""
    drives = "".join(f'[drives.of_{j}]\njoint = "{j}"\nmotion = "t"\n' for j in ("axle", "guide"))
    text = RACK.replace("keep_coordinates = true\n", "") + drives
    messages = []
    for lowering in ("flat", "instances"):
        with pytest.raises(SpecError) as error:
            derive.lower(derive.derive(parse(text.replace('"instances"', f'"{lowering}"'))), explicit=True)
        messages.append([(p.path, p.message) for p in error.value.problems])
    assert messages[0] == messages[1]
