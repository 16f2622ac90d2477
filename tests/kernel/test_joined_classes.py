"""Bodies at the ends of chains are in the lanes of those between, and what they compute too much has no effect."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import derive
from derive.backends.c.source import CBackend
from derive.ir.analysis import reads
from derive.ir.interpreter import interpret
from derive.ir.model import Model
from derive.lowering.flat.lower import lower
from derive.lowering.instances.loop_code.context import InstanceContext
from derive.lowering.instances.lower import lower_instances
from derive.mechanics.multibody.mechanism import Mechanism

ROD = {"ansatz": ["1", "xi", "xi^2"], "frame": "mean", "length": 1, "bending_stiffness": 30}
ENDS = {"markers": {"left": -1, "right": 1}}
OTHERS = {"markers": {"left": -1, "right": 1, "middle": 0}}


def chain(
    kinds: Sequence[str], markers: Sequence[dict[str, object]] = (), backwards: bool = False, driven: bool = False
) -> Mechanism:
    """Rods of different masses in a row from the ground on, each with the joint before it, or numbered from its end."""
    count = len(kinds)
    own = [*markers, *([ENDS] * (count - len(markers)))]
    bodies = {f"b{n}": {**ROD, "mass": n + 2, **own[n]} for n in range(count)}
    joints = {}
    for n, kind in enumerate(kinds):
        before = "ground.hook" if n == 0 else f"b{n - 1}.right"
        joints[f"j{n}"] = {"kind": kind, "between": [before, f"b{n}.left"]}
    if backwards:
        bodies, joints = dict(reversed(bodies.items())), dict(reversed(joints.items()))
    drives = {"motor": {"joint": "j0", "motion": "t + t^2/3"}} if driven else {}
    scene = derive.scene("row", ground={"hook": [0, 0]}, gravity=[0, -9], bodies=bodies, joints=joints, drives=drives)
    made = derive.derive(scene)
    assert isinstance(made, Mechanism)
    return made


def members(of: Mechanism) -> list[list[str]]:
    """The bodies of each class in lanes."""
    return [[m.instance.name for m in code.of.members] for code in InstanceContext(of).classes_in_lanes]


PINNED = ("revolute", "weld", "weld", "weld")


@cache
def row(driven: bool = False) -> Mechanism:
    return chain(PINNED, driven=driven)


def test_the_ends_join_the_bodies_between_them() -> None:
    """A pin at the wall removes the first two motions of a weld, and the free end has no joint."""
    assert members(row()) == [["b0", "b1", "b2", "b3"]]
    assert [len(code.of.members) for code in InstanceContext(row()).classes] == [1, 2, 1]
    assert members(row(True)) == members(row())


def test_classes_join_where_vectors_then_take_less() -> None:
    """Five rods are a full vector and one that is left; two of them have nothing to join."""
    assert members(chain(("revolute", *["weld"] * 4))) == [["b0", "b1", "b2", "b3"], ["b4"]]
    assert members(chain(("revolute", "weld"))) == [["b0"], ["b1"]]


@pytest.mark.parametrize(("count", "classes"), [(73, [72, 1]), (77, [77])])
def test_a_class_less_is_worth_a_vector_more_among_many(count: int, classes: list[int]) -> None:
    long = chain(("revolute", *["weld"] * (count - 1)))
    assert [len(names) for names in members(long)] == classes


def test_other_bodies_stay_apart() -> None:
    """A rod whose markers or whose joint are others computes something else."""
    assert members(chain(PINNED, [OTHERS])) == [["b0"], ["b1", "b2", "b3"]]
    assert members(chain(("translational", "weld", "weld", "weld"))) == [["b0"], ["b1", "b2", "b3"]]


def test_places_stay_equally_spaced() -> None:
    """The spare place is behind all others, so that a chain that begins with its free end keeps this apart."""
    assert ["b3"] in members(chain(PINNED, backwards=True))


def accelerations(model: Model) -> np.ndarray:
    kernel = model.kernel("solve")
    rng = np.random.default_rng(2)
    given = {name: rng.uniform(-0.3, 0.3, len(model.coordinates)).tolist() for name in ("q", "v")} | {"t": 0.0}
    given["k"] = interpret(model.kernel("setup"), {"p": list(model.defaults)})["k"]
    return np.array(interpret(kernel, {a.name: given[a.name] for a in kernel.arguments})["vdot"])


@cache
def looped(driven: bool = False, proximal: bool = False) -> Model:
    return lower_instances(row(driven), proximal=proximal)


@pytest.mark.parametrize(("driven", "proximal"), [(False, False), (False, True), (True, False)])
def test_accelerations_are_those_of_straight_line_code(driven: bool, proximal: bool) -> None:
    """Each rod has numbers of its own, and the rows that joints do not have leave nothing in the system."""
    expected = accelerations(lower(row(driven).expanded()))
    found = accelerations(looped(driven, proximal))
    assert np.abs(found - expected).max() < 1e-10 * np.abs(expected).max()


def test_functions_that_are_not_in_lanes_keep_their_classes() -> None:
    """A joined class has rows to compute that nobody reads, which vectors alone are worth."""
    names = {
        name: {array for section in looped().kernel(name).sections for s in section.body for array in reads(s)}
        for name in ("solve", "project_velocity")
    }
    assert "kept_joined_b1" in names["solve"]
    assert "kept_b1" in names["project_velocity"] and "kept_joined_b1" not in names["project_velocity"]


def test_checks_of_several_bodies_in_one_loop_have_names_of_their_own() -> None:
    """A rod with other markers is apart, and batches check its results and those of another one in the same loop."""
    model = lower_instances(chain(["revolute"] * 3, [ENDS, ENDS, OTHERS]))
    kernels = tuple(k if k.name in ("setup", "accel") else replace(k, sections=(), constants=()) for k in model.kernels)
    _, source = CBackend().files(replace(model, kernels=kernels), "")
    loops = source.text.split("TISSERAND_STATES for")
    names = [re.findall(r"const double (finite\w*) =", loop) for loop in loops]
    assert max(map(len, names)) == 2
    assert all(len({*own}) == len(own) for own in names)
