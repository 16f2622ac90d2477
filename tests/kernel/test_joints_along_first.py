"""Joints of bodies with many modes, whose accelerations have rows along the axes of their first bodies."""

from __future__ import annotations

from dataclasses import replace

import pytest
from both_lowerings import both, check
from clouds import chain

import derive
from derive.algebra import sp
from derive.ir.indices import constant
from derive.ir.statements import ForEach, Let
from derive.lowering.instances.functions.constant_modes import _translations
from derive.lowering.instances.loop_code.context import InstanceContext
from derive.lowering.instances.lower import lower_instances
from derive.mechanics.motion.rotations import SCALE, THETA, inverse_tangent, section_rotation
from derive.mechanics.multibody.space.mechanism import SpatialMechanism
from derive.mechanics.symbols import Family, Identity, local
from some_functions import only


def has_rows_along_first(scene: derive.SpatialScene, proximal: bool = False) -> bool:
    mechanism = derive.derive(scene)
    assert isinstance(mechanism, SpatialMechanism)
    return InstanceContext(mechanism, proximal=proximal).along_first


def test_joints_that_hold_a_point_have_them() -> None:
    """Of bodies with few modes, or with least multipliers, and with joints along axes that move, constraints stay."""
    scene = chain(2, ("spherical", "revolute"))
    assert has_rows_along_first(scene)
    assert not has_rows_along_first(scene, proximal=True)
    assert not has_rows_along_first(chain(2, ("fixed", "prismatic")))
    first, second = scene.bodies
    assert isinstance(first, derive.FlexibleBody)
    few = replace(first, body=replace(first.body, modes=2))
    assert not has_rows_along_first(replace(scene, bodies=(few, second)))


@pytest.mark.long
def test_trees_turned_joints_and_closed_loops() -> None:
    """Two joints at one marker, a body that is the second one of both of its joints, and one that closes a loop."""
    scene = chain(3, ("fixed", "spherical"))
    base, elbow, tip = scene.joints
    tip = replace(tip, first=tip.second, second=elbow.first)
    end = replace(elbow, name="end", first=replace(tip.first, marker="right"), second=base.first)
    changed = replace(scene, joints=(base, elbow, tip, end))
    assert has_rows_along_first(changed)
    check(both(changed, True))


def test_rates_of_rotation_vectors_follow_from_angular_velocities() -> None:
    _, tangent, _ = section_rotation()
    scale = 1 / (1 + sum(theta**2 for theta in THETA) / 4)
    product = sp.Matrix(tangent).xreplace({SCALE: scale}) * inverse_tangent()
    assert product.applyfunc(sp.cancel) == sp.eye(3)
    assert not any(sp.denom(entry).free_symbols for entry in inverse_tangent())


def test_a_translation_along_constants_of_modes_is_found() -> None:
    """All rows of a marker have to have equal factors of it and of the constants."""
    along = [Identity(Family.POINT_SHAPE, components=(k,), point="left") for k in (1, 2)]
    a, b, c, d = (local(name) for name in "abcd")
    turned = [({0: a, 1: b, 5: c}, {along[0]: a, along[1]: b}), ({0: c, 1: d}, {along[0]: c, along[1]: d})]
    assert _translations(turned) == {along[0]: 0, along[1]: 1}
    assert _translations([turned[0], ({0: c, 1: d}, {along[0]: c, along[1]: a})]) == {along[0]: 0}
    assert _translations([turned[0], ({0: d, 1: c}, {along[0]: c, along[1]: d})]) == {}


def test_what_a_first_body_has_in_common_is_no_factor() -> None:
    """The first body of a joint has constants, so that the second one alone reads a tensor from the joint."""
    mechanism = derive.derive(chain(5, ("fixed",)))
    assert isinstance(mechanism, SpatialMechanism)
    for group in InstanceContext(mechanism).joints_in_lanes:
        assert {side: len(of) for side, of in group.factors.items() if of} == {1: 18}


def test_a_body_reads_each_of_its_numbers_once() -> None:
    """Four bodies are in one vector, and the last one by itself."""
    mechanism = derive.derive(chain(5, ("fixed",)))
    assert isinstance(mechanism, SpatialMechanism)
    with only("accel"):
        model = lower_instances(mechanism, explicit=True)
    loops = [s for s in model.kernel("accel").statements if isinstance(s, ForEach)]
    for loop in loops:
        names = [item.name for item in loop.body if isinstance(item, Let)]
        assert len(names) == len({*names})
    assert any(loop.stop == constant(1) for loop in loops)
