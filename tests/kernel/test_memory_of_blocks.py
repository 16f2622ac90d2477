"""The memory of loops over blocks of bodies: what they keep lies in tiles, and arrays share what they need in turn."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from clouds import in_blocks, state
from test_sums_over_modes import looped, summed

from derive.ir.analysis import accessed_by
from derive.ir.expressions import Element
from derive.ir.indices import LANE, LANES, ElementIndex, Of, variable
from derive.ir.interpreter import interpret
from derive.ir.loop_nests import START, Assign, For, Local, LoopKind, Node, every
from derive.ir.overlaid_arrays import NAME, overlaid
from derive.ir.tiles import FEWEST_COLUMNS, kept_in_tiles, with_kept_in_tiles

COUNT = 6
KEPT = Local("kept", FEWEST_COLUMNS * 8, spacing=8)


def block(*body: Node, stop: int = COUNT) -> For:
    """A loop over blocks of instances."""
    lanes = For(LANE, START, variable(LANE).with_value(LANE, LANES), body, LoopKind.LANES)
    return For("i", START, ElementIndex(stop), (lanes,), step=LANES, overlaps=True)


def own(array: str, component: int = 0) -> Element:
    """A number of the instance that a lane has."""
    return Element(array, ElementIndex(component * KEPT.spacing, (*variable("i").terms, *variable(LANE).terms)))


def test_what_bodies_keep_lies_in_tiles() -> None:
    """The last block overlaps the one before and has a tile of its own, which both loops find."""
    nodes = [KEPT, block(Assign(own("kept", 1), own("q"))), block(Assign(own("v"), own("kept", 1)))]
    kept = kept_in_tiles(nodes, ())
    assert kept == {"kept": KEPT}
    written, read = (with_kept_in_tiles(node, kept) for node in nodes[1:])
    (target,) = (e for node in every([written]) for e in accessed_by(node) if e.array == "kept")
    assert isinstance(target, Element) and target.index
    assert {(term.stride, term.of) for term in target.index.terms} == {
        (FEWEST_COLUMNS * LANES, Of.CEILING),
        (1, Of.VALUE),
    }
    places = [target.index.at({"i": i, LANE: lane}) for i in (0, 2) for lane in range(LANES)]
    assert places == [*range(4, 8), *range(FEWEST_COLUMNS * LANES + 4, FEWEST_COLUMNS * LANES + 8)]
    assert target in [e for node in every([read]) for e in accessed_by(node)]


def test_arrays_that_others_access_stay_in_rows() -> None:
    """Other blocks, elements of other instances, and loops without vectors find their numbers by instances."""
    first = block(Assign(own("kept"), own("q")))
    shifted = replace(own("kept"), index=own("kept").index and own("kept").index.plus(1))
    for other in (
        block(Assign(own("v"), own("kept")), stop=COUNT - 1),
        block(Assign(own("v"), shifted)),
        Assign(Element("v", START), Element("kept", START)),
    ):
        assert not kept_in_tiles([KEPT, first, other], ())
    assert not kept_in_tiles([KEPT, first], ("kept",))
    assert not kept_in_tiles([replace(KEPT, cleared=True), first], ())
    assert not kept_in_tiles([replace(KEPT, count=KEPT.count - KEPT.spacing), first], ())


def test_arrays_share_the_memory_that_they_need_in_turn() -> None:
    """The third array is filled when the first one is not read any more, while the second one still is."""
    a, b, c = (Local(name, size, in_lanes=True) for name, size in (("a", 8), ("b", 4), ("c", 8)))

    def at(array: Local) -> Element:
        return Element(array.array, variable(LANE))

    lines = (
        Assign(at(a), own("q")),
        Assign(at(b), at(a)),
        Assign(at(c), own("q")),
        Assign(own("v"), at(b)),
        Assign(own("v"), at(c)),
    )
    arrays, (lanes,) = overlaid((a, b, c), [For(LANE, START, ElementIndex(LANES), lines, LoopKind.LANES)])
    assert [array.size for array in arrays] == [12]
    assert isinstance(lanes, For)
    places = [node.target.index.offset for node in lanes.body[:3] if isinstance(node, Assign) and node.target.index]
    assert places[0] == places[2] != places[1]
    assert overlaid((a, b), lines[:2]) == ((a, b), lines[:2])


@pytest.mark.parametrize("count", [3, pytest.param(6, marks=pytest.mark.long)])
def test_bodies_with_modes_have_less_memory_with_the_same_results(count: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """The rows of joints lie where the sums over modes were; of six bodies, two blocks keep their numbers in tiles."""
    monkeypatch.setattr("derive.ir.tiles.FEWEST_COLUMNS", 32)
    kernel, nodes = in_blocks(summed(count).kernel("accel"))
    shared = [node for node in nodes if isinstance(node, Local) and node.array.startswith(NAME)]
    assert shared
    places = [e.index for node in every(nodes) for e in accessed_by(node) if e.array.startswith("kept") if e.index]
    in_tiles = any(term.of is Of.CEILING for index in places for term in index.terms)
    assert in_tiles is (count > LANES)
    expected = interpret(looped(count).kernel("accel"), state(kernel))["vdot"]
    found = interpret(kernel, state(kernel), nodes=nodes)["vdot"]
    assert np.abs(np.subtract(found, expected)).max() < 2e-13 * np.abs(expected).max()
