"""Outputs of sections of beams in loops in space: beams of a class have one code for them where their numbers agree."""

from __future__ import annotations

import pytest
from both_lowerings import both, check

import derive
from derive.lowering.instances.classes.body_classes import body_classes
from derive.spec.toml.read import parse

RODS = """
name = "rods"
[scene]
gravity = [0.5, 0, -9.81]
lowering = "instances"
[ground.markers]
hook = [0, 0, 0]
[bodies.rod]
count = {count}
length = "0.4 + {more}*i"
mass = 0.3
rotary_inertia = 1e-5
bending_stiffness = 3.5
ansatz = ["1", "xi", "xi^2"]
torsion = {{ ansatz = ["xi"], stiffness = 1.3 }}
markers = {{ left = -1, inner = 0.25 }}
[joints.hook]
count = {count}
kind = "spherical"
between = ["ground.hook", "rod[i].left"]
[outputs.strain]
count = {count}
kind = "strain"
section = "rod[i].inner"
height = 0.01
"""
FORCES = """
[outputs.cut]
count = {count}
kind = "{kind}"
section = "rod[i].inner"
[outputs.held]
count = {count}
kind = "reaction"
joint = "hook[i]"
"""


@pytest.mark.parametrize("kind", ["", pytest.param("bending_moment", marks=pytest.mark.long)])
def test_lengths_that_differ(kind: str) -> None:
    """The factors of the strain are numbers of each beam, which are not those of the first one of the class."""
    scene = parse(RODS.format(count=2, more="1/10") + (FORCES.format(count=2, kind=kind) if kind else ""))
    (of,) = body_classes(derive.derive(scene))
    assert len(of.members) == 2
    check(both(scene, True))


def test_the_code_of_section_forces_does_not_grow_with_the_number_of_beams() -> None:
    """They depend on the loads and the joints of their own beam alone."""

    def size(count: int) -> int:
        scene = parse(RODS.format(count=count, more="0") + FORCES.format(count=count, kind="shear_force"))
        model = derive.lower(derive.derive(scene), explicit=True)
        return len(str(model.kernel("outputs").statements))

    assert size(6) < 1.01 * size(3)
