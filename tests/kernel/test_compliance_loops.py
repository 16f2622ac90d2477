"""Bodies with many modes in loops: their compliance in loops over the rows of their joints."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from clouds import chain, in_blocks, state

import derive
from derive.backends.c.loop_text import filled_by_few
from derive.ir.interpreter import interpret
from derive.ir.loop_nests import Assign, For, LoopKind, every
from derive.ir.model import Model
from derive.ir.statements import ForEach, inside
from derive.ir.sums_over_modes import with_sums_over_modes
from derive.lowering.instances.functions.compliance_loops import COLUMN, ROW
from derive.lowering.instances.functions.marker_modes import LABEL
from derive.lowering.instances.lower import lower_instances
from derive.mechanics.multibody.space.mechanism import SpatialMechanism
from some_functions import only


@cache
def looped(count: int, kinds: tuple[str, ...], alike: bool = False, straight: bool = False) -> Model:
    mechanism = derive.derive(chain(count, kinds, alike))
    assert isinstance(mechanism, SpatialMechanism)
    with only("accel"), pytest.MonkeyPatch.context() as patch:
        if straight:
            patch.setattr("derive.lowering.instances.functions.local_system.ComplianceLoops", lambda *_: None)
        return lower_instances(mechanism, explicit=True)


def variables(model: Model) -> list[str]:
    loops = (s for s in model.kernel("accel").statements if isinstance(s, ForEach))
    return [item.variable for loop in loops for item in inside(loop) if isinstance(item, ForEach)]


@pytest.mark.parametrize(
    ("kinds", "alike", "blocks"),
    [
        (("fixed",), False, 10),
        *(
            pytest.param(*of, marks=pytest.mark.long)
            for of in (((("revolute",), False, 10), (("spherical",), False, 0), (("fixed",), True, 10)))
        ),
        pytest.param(("prismatic",), False, 0, marks=pytest.mark.long),
    ],
)
def test_loops_over_rows_have_the_values_of_straight_lines(kinds: tuple[str, ...], alike: bool, blocks: int) -> None:
    """Small blocks, whose halves are stored without gaps, and rows along axes that move stay a straight line."""
    model, straight = looped(3, kinds, alike), looped(3, kinds, alike, straight=True)
    used = variables(model)
    assert (used.count(COLUMN), used.count(LABEL)) == (blocks, 1)
    assert used.count(ROW) >= blocks
    assert not {ROW, COLUMN} & {*variables(straight)}
    given = state(model.kernel("accel"))
    expected, found = (interpret(of.kernel("accel"), given)["vdot"] for of in (straight, model))
    assert np.abs(np.subtract(found, expected)).max() < 1e-12 * np.abs(expected).max()


def test_three_bodies_store_whole_vectors_where_there_is_room() -> None:
    """Arrays with elements at other places, such as those behind the joint of the ground, get three elements each."""
    _, nodes = in_blocks(with_sums_over_modes(looped(3, ("fixed",))).kernel("accel"))
    whole = filled_by_few(nodes)
    few = [loop for loop in every(nodes) if isinstance(loop, For) and loop.kind is LoopKind.FEW]
    stored = {node.target.array for loop in few for node in every(loop.body) if isinstance(node, Assign)}
    assert {"second_diagonal", "coupling"} <= whole & stored
    assert {"first_diagonal", "vdot"} <= stored - whole
