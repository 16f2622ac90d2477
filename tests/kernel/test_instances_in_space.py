"""Loops over bodies in space compute what straight-line code computes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from both_lowerings import OF_LEAST_NORM, System, both, check, results

import derive
from corpus.generator import corpus_scene
from derive.lowering.mechanism_costs import estimate_mechanism_costs, is_predicted
from derive.mechanics.multibody.space.mechanism import SpatialMechanism
from derive.simulation.observables.default_plots import default_plots
from derive.spec.toml.read import parse

TURNED = "rotation = { z = [0, 1, 0], x = [1, 0, 0] }"
LINKS = """
name = "links"
[scene]
gravity = [0.5, 0, -9.81]
lowering = "instances"
[ground.markers]
hook = {{ at = [0, 0, 0], {turned} }}
[bodies.link]
count = {count}
mass = "1 + i/10"
keep_coordinates = true
centre = [0.5, 0, 0]
inertia = [0.02, 0.09, 0.1, 0.003, -0.004, 0.005]
[bodies.link.markers]
a = {{ at = [0, 0, 0], {turned} }}
b = {{ at = [1, 0, 0], {turned} }}
[joints.hook]
kind = "{kind}"
between = ["ground.hook", "link[0].a"]
[joints.hinge]
count = {joints}
kind = "{kind}"
between = ["link[i].b", "link[i+1].a"]
[outputs.all]
kind = "energy"
"""
MIXED = """
name = "mixed"
[scene]
gravity = [0, 0, -9.81]
lowering = "instances"
[ground.markers]
pivot = { at = [0, 0, 0], rotation = { z = [0, 1, 0], x = [1, 0, 0] } }
aside = [3, 1, 0]
[bodies.arm]
mass = 2
centre = [0.4, 0.1, 0]
inertia = [0.02, 0.09, 0.1, 0, 0, 0]
markers = { hub = [0, 0, 0], end = [1, 0, 0] }
[bodies.ball]
count = 2
mass = 1
inertia = [0.02, 0.03, 0.04, 0, 0, 0.001]
markers = { left = [-0.3, 0, 0], right = [0.4, 0.1, 0] }
[joints.shaft]
kind = "revolute"
between = ["ground.pivot", "arm.hub"]
[joints.socket]
kind = "spherical"
between = ["arm.end", "ball[0].left"]
[joints.slide]
kind = "prismatic"
between = ["ball[0].right", "ball[1].left"]
[drives.push]
joint = "slide"
motion = "0.1*sin(3*t)"
[forces.blow]
at = "ball[1].right"
force = ["3*t", 0, 1]
frame = "body"
[springs.rope]
between = ["ball[1].right", "ground.aside"]
stiffness = 30
rest = 0.5
damping = 0.2
[torques.brake]
joint = "shaft"
value = "2 - t"
[outputs.place]
kind = "position"
marker = "ball[1].right"
frame = "arm.end"
[outputs.all]
kind = "energy"
[outputs.flow]
kind = "power"
[outputs.held]
kind = "reaction"
joint = "slide"
frame = "ball[1].left"
[outputs.borne]
kind = "reaction"
joint = "shaft"
[outputs.pushed]
kind = "drive"
drive = "push"
[outputs.pulled]
kind = "spring"
spring = "rope"
[outputs.braked]
kind = "joint_load"
load = "brake"
"""
TWICE = """
[joints.again]
kind = "{kind}"
between = ["ground.hook", "link[0].a"]
"""
CLOSED = """
name = "closed"
[scene]
gravity = [0, 0.3, -9.81]
lowering = "instances"
[ground.markers]
left = { at = [0, 0, 0], rotation = { z = [0, 1, 0], x = [1, 0, 0] } }
right = { at = [1.1, 0.1, 0], rotation = { z = [0, 1, 0], x = [1, 0, 0] } }
[bodies.link]
count = 3
mass = 1
keep_coordinates = true
inertia = [0.02, 0.09, 0.1, 0.003, -0.004, 0.005]
markers = { a = [-0.2, 0, 0], b = { at = [0.3, 0, 0], rotation = { z = [0, 1, 0], x = [1, 0, 0] } } }
[joints.crank]
kind = "revolute"
between = ["ground.left", "link[0].a"]
[joints.ball]
kind = "spherical"
between = ["link[0].b", "link[1].a"]
[joints.cross]
kind = "universal"
between = ["link[1].b", "link[2].a"]
[joints.rocker]
kind = "revolute"
between = ["link[2].b", "ground.right"]
"""
BEAMS = """
name = "beams"
[scene]
gravity = [0.5, 0, -9.81]
lowering = "instances"
[ground.markers]
hook = [0, 0, 0]
[bodies.rod]
count = 3
length = 0.4
mass = "0.3 + i/10"
rotary_inertia = 1e-5
bending_stiffness = 3.5
lateral = {{ bending_stiffness = 2.1 }}
torsion = {{ ansatz = ["xi"], stiffness = 1.3 }}
ansatz = ["1", "xi", "xi^2", "xi^3"]
order = {order}
frame = {frame}
damping = {{ ratio = 0.01 }}
markers = {{ left = -1, right = {{ at = 1, rotation = {{ z = [0, 1, 0], x = [1, 0, 0] }} }} }}
[joints.hook]
kind = "{kind}"
between = ["ground.hook", "rod[0].left"]
[joints.hinge]
count = 2
kind = "{kind}"
between = ["rod[i].right", "rod[i+1].left"]
[outputs.all]
kind = "energy"
[outputs.held]
kind = "reaction"
joint = "hinge[0]"
"""


def chain(kind: str, count: int) -> derive.SpatialScene:
    """A chain of links that hangs from the ground, all with joints of one kind; the masses differ."""
    return parse(LINKS.format(kind=kind, count=count, joints=count - 1, turned=TURNED))


@pytest.mark.parametrize(
    "kind", ["spherical", *(pytest.param(k, marks=pytest.mark.long) for k in ("revolute", "fixed"))]
)
def test_chains(kind: str) -> None:
    check(both(chain(kind, 3), kind == "spherical"))


@pytest.mark.parametrize("explicit", [True, pytest.param(False, marks=pytest.mark.long)])
def test_a_drive_a_spring_a_force_and_an_output_of_motion(explicit: bool) -> None:
    """One body has minimal coordinates, and the joint that slides has axes that move with a body."""
    of = both(parse(MIXED), explicit)
    assert len(of.instances.multipliers) == 3 + 6
    check(of)


def test_the_code_does_not_grow_with_the_number_of_bodies() -> None:
    """From two bodies between the first and the last on."""
    few, many = (derive.lower(derive.derive(chain("spherical", count)), explicit=True) for count in (4, 12))
    sizes = [[len(str(kernel.statements)) for kernel in model.kernels] for model in (few, many)]
    assert many.lowering == "instances"
    assert np.abs(np.diff(np.log(np.array(sizes) + 1.0), axis=0)).max() < 0.2


def test_loops_are_chosen_where_they_are_faster() -> None:
    """With the reason and the times; measured ratios of the times, loops to straight-line code, are beside."""

    def lowered(kind: str, count: int, **options: bool) -> tuple[str, str]:
        scene = replace(chain(kind, count), lowering="auto")
        model = derive.lower(derive.derive(scene), explicit=True, **options)
        return model.lowering, model.choice

    def chosen(text: str) -> str:
        mechanism = derive.derive(parse(text))
        assert isinstance(mechanism, SpatialMechanism)
        assert is_predicted(mechanism)
        return estimate_mechanism_costs(mechanism).lowering

    def links(kind: str, count: int) -> str:
        return LINKS.format(kind=kind, count=count, joints=count - 1, turned=TURNED)

    form, choice = lowered("spherical", 3, sensitivities=True)  # 0.53
    assert form == "instances"
    assert choice.startswith("looped over instances, the faster form; predicted evaluation time")
    form, choice = lowered("revolute", 2)  # 1.47
    assert form == "flat"
    assert choice.startswith("unrolled, the faster form; predicted evaluation time")
    assert [chosen(links("revolute", count)) for count in (4, 5)] == ["instances"] * 2  # 0.84, 0.44
    assert [chosen(links("fixed", count)) for count in (3, 8)] == ["flat"] * 2  # 1.31, 1.38
    assert chosen(links("universal", 5)) == "instances"  # 0.12
    stars = {
        (kind, n): links(kind, n).replace("link[i].b", "link[0].b") for kind, n in (("spherical", 6), ("revolute", 5))
    }
    assert [chosen(star) for star in stars.values()] == ["flat"] * 2  # 1.03, 3.25
    assert chosen(CLOSED.replace("universal", "spherical")) == "flat"  # 1.32


def test_default_plots_name_the_columns_of_instances() -> None:
    """The angular velocities are columns under their names for people."""
    model = both(parse(MIXED), True).instances
    curves = [plot.quantity for plot in default_plots(replace(parse(MIXED), outputs=()), model)]
    assert any("ball[1]_omega2" in getattr(curve, "y", ()) for curve in curves)


@pytest.mark.parametrize("explicit", [True, pytest.param(False, marks=pytest.mark.long)])
def test_closed_loops(explicit: bool) -> None:
    """A crank and a rocker with a coupler between a ball and a cross: each joint is coupled with the next one."""
    check(both(parse(CLOSED), explicit))


def test_redundant_joints() -> None:
    """A joint that is there twice has reactions of least norm, which are equal to half of those of one joint."""
    links = LINKS.format(kind="spherical", count=2, joints=1, turned=TURNED)
    of = both(parse(links + TWICE.format(kind="spherical")), True, proximal=True)
    assert of.instances.proximal
    flat, loops = (results(of, model, "solve") for model in (of.flat, of.instances))
    system = System(of)
    motion, joints = system.residuals(loops["vdot"], loops["lam"])
    assert max(motion, joints) <= OF_LEAST_NORM
    assert system.norm(loops["vdot"] - flat["vdot"]) <= OF_LEAST_NORM * system.norm(flat["vdot"])
    assert np.allclose(loops["lam"], flat["lam"], rtol=0, atol=OF_LEAST_NORM * abs(flat["lam"]).max())
    names = [m.name for m in of.instances.multipliers]
    once, again = ([loops["lam"][k] for k, n in enumerate(names) if n.startswith(j)] for j in ("hook", "again"))
    assert np.allclose(once, again, rtol=OF_LEAST_NORM)


@pytest.mark.parametrize(
    "seed", [2007, 2010, *(pytest.param(seed, marks=pytest.mark.long) for seed in (2000, 2004, 2024))]
)
def test_scenes_of_the_corpus(seed: int, tmp_path: Path) -> None:
    """Random scenes in space; that of 2000 has outputs of powers."""
    scene = derive.read(corpus_scene(seed).write(tmp_path))
    assert isinstance(scene, derive.SpatialScene)
    check(both(replace(scene, lowering="instances"), False))
