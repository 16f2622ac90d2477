"""Random trees of rigid bodies in space with flexible ones on them: beams, and the block of `scenes/`.

A boom at the end of an arm, appendages of a free base, flexible bodies between two links, and flexible bodies that
close a loop. Rigid bodies leave their coordinates to their joints, so that they have those of trees.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from corpus.spatial_actions import act_in_space
from corpus.spatial_beams import beam_body, tip

if TYPE_CHECKING:
    from corpus.spatial_scenes import SolidBody, SpatialDraft

SHARE = 0.12
"""The part of the scenes in space that are such trees."""
NAME = "flexible tree"
LINKAGES = ("boom", "boom", "appendages", "between", "between", "closing")
LINKS = ("revolute", "revolute", "prismatic", "cylindrical", "universal", "spherical", "fixed", "screw", "planar")
HELD = ("revolute", "revolute", "fixed", "spherical", "universal", "cylindrical", "prismatic")
"""How links and flexible bodies hang on those before them."""
CLOSED = (("universal", "spherical"), ("spherical", "spherical"), ("spherical", "universal"))
"""The joints of a flexible body that closes a loop, at its root and at its tip; a node has a spherical one."""

Vector = np.ndarray


@dataclass(frozen=True)
class Limb:
    """A flexible body with its ends at t = 0; root_marker, tip_marker: those that it has already, else "".

    A marker at one node has no rotation, so that a joint there is spherical.
    """

    body: SolidBody
    root: Vector
    tip: Vector
    root_marker: str = ""
    tip_marker: str = ""


def flexible_tree(draft: SpatialDraft) -> str:
    """Draw such a scene; its linkage."""
    draws = draft.draws
    linkage = draws.choice(LINKAGES)
    draft.looped = linkage == "closing"
    if linkage == "appendages":
        links = _links(draft, [_rigid(draft)], draws.whole(0, 2))
    else:
        links = _links(draft, [], draws.whole(2, 3) if draft.looped else draws.whole(1, 3))
    for _ in range(draws.whole(1, 2) if linkage == "appendages" else 1):
        base = draws.choice(links) if linkage in ("appendages", "between") else links[-1]
        root, end = draws.choice(CLOSED) if draft.looped else (draws.choice(HELD), draws.choice(HELD))
        limb = _limb(draft, base.x + draft.vector(draft.size))
        _hang(draft, root, base, limb)
        if draft.looped:
            _hold_tip(draft, end, limb, draws.choice([draft.ground, links[0]]))
        elif linkage == "between" or draws.chance(0.3):
            behind = _rigid(draft)
            _hold_tip(draft, end, limb, behind)
            if draws.chance(0.4):
                _links(draft, [behind], 1)
    act_in_space(draft)
    return f"{NAME}: {linkage}"


def _rigid(draft: SpatialDraft) -> SolidBody:
    """A rigid body that leaves its coordinates to its joint."""
    body = draft.body(flexible=False)
    draft.section("bodies")[body.name].pop("keep_coordinates", None)
    return body


def _links(draft: SpatialDraft, bodies: list[SolidBody], count: int) -> list[SolidBody]:
    """`bodies` with more links, the first one on the ground if there are none, each other one on one of them."""
    draws, result = draft.draws, [*bodies]
    for _ in range(count):
        base = result[-1] if result and draws.chance(0.7) else draws.choice(result or [draft.ground])
        link = _rigid(draft)
        ends = (base, link) if draws.chance(0.7) else (link, base)
        draft.joint(draws.choice(LINKS), *ends, base.x + draft.vector(draft.size), draft.rotation())
        result.append(link)
    return result


def _limb(draft: SpatialDraft, at: Vector) -> Limb:
    """A beam from a point on, or the block."""
    from corpus.spatial_scenes import block_with_ends

    if draft.draws.chance(0.6):
        beam = beam_body(draft, at)
        return Limb(beam, at, tip(beam))
    block, root, end = block_with_ends(draft)
    return Limb(block, root, end, f"{block.name}.root", f"{block.name}.end")


def _hang(draft: SpatialDraft, kind: str, base: SolidBody, limb: Limb) -> None:
    """Join the root of a flexible body to a body."""
    if not limb.root_marker:
        ends = (base, limb.body) if draft.draws.chance(0.7) else (limb.body, base)
        draft.joint(kind, *ends, limb.root, draft.rotation())
        return
    pair = [draft.marker(base, limb.root, limb.body.R), limb.root_marker]
    draft.section("joints")[draft.name("joints")] = {"kind": kind, "between": pair}


def _hold_tip(draft: SpatialDraft, kind: str, limb: Limb, by: SolidBody) -> None:
    """Join the tip of a flexible body to a body."""
    if not limb.tip_marker:
        draft.joint(kind, limb.body, by, limb.tip, draft.rotation())
        return
    pair = [limb.tip_marker, draft.marker(by, limb.tip, by.R)]
    draft.section("joints")[draft.name("joints")] = {"kind": "spherical", "between": pair}
