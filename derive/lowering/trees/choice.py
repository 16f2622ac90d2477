"""The choice between straight-line code and loops over links for trees in relative coordinates.

Straight-line code of n links took 30, 44, 53, 56 ns for each of 3, 6, 10, 16 revolute links in a chain with any axes;
of robots, whose axes are along each other or normal, 23 ns for each of 6 links, 25 of 18, 28 to 36 of 35, and 41 of 38
with some others. Loops took 44, 45, 45 and 46 ns for chains of 8, 10, 30 and 100, 38 to 45 for robots (gcc 12, -O3
-march=x86-64-v3, AMD EPYC, family 26). The compiler took 28 s for the straight-line code of 35 links without
derivatives, and 2 s for loops.

In loops iteration matrices and sensitivities come column by column, each of which runs over all links: those of a
chain of 24 took 125 us in place of 60, of 13 28 us in place of 8. But the code of 24 links with these was derived,
written and compiled in 6 s in place of 111, and had 0.4 MB in place of 13.
"""

from __future__ import annotations

from collections.abc import Collection

from derive.enumerations import enumeration
from derive.lowering.mechanism_costs import LONG
from derive.lowering.trees.joint_outputs import LOOPED, MOST_UNROLLED, other_outputs
from derive.lowering.trees.links import TreeLink, refusals, tree_of
from derive.mechanics.multibody.space.mechanism import SpatialMechanism

MOST_SECONDS = 300.0
"""The time (s) that the compiler may take for straight-line code with derivatives, whose matrices are sparse."""
SLOWER_SECONDS = 30.0
"""The same where the accelerations in straight-line code are the slower ones."""


def chosen(mechanism: SpatialMechanism, explicit: bool, functions: Collection[str] = ()) -> tuple[bool, str]:
    """Whether a mechanism in relative coordinates is looped over its links, and a line that says why.

    explicit: whether no derivatives are needed; functions: those on request.
    """
    refused = next(refusals(mechanism), "")
    if refused:
        return False, f"unrolled, since {refused}"
    other = next(other_outputs(mechanism), "") if len(mechanism.rows) > MOST_UNROLLED else ""
    if other:
        return False, f"unrolled, since outputs in loops over links are motions of joints, and {other} is another one"
    if not {*functions} <= LOOPED:
        return False, f"unrolled, for {enumeration([*functions])}"
    if mechanism.scene.redundant == "resolve":
        return False, "unrolled, since loops over links have no multipliers of least norm"
    links = tree_of(mechanism).links
    count, along = len(links), sum(map(_is_along, links))
    flat = (count - along) * (29 + 1.9 * count) + along * (20 + 0.3 * count)
    looped = 30 + 42 * count
    times = f"predicted evaluation time of the accelerations: {flat:.0f} ns unrolled, {looped:.0f} ns looped over links"
    seconds = (0.023 if explicit else 0.1) * count**2
    if seconds > (LONG if explicit else MOST_SECONDS):
        return (
            True,
            f"looped over links, since straight-line code would take the compiler some {seconds:.0f} s; {times}",
        )
    if has_constraints(mechanism):
        return False, f"unrolled, since the scene has constraints; without them the {times}"
    if not explicit and (seconds < SLOWER_SECONDS or flat < looped):
        return False, f"unrolled, since derivatives in loops over links come column by column; {times}"
    return looped < flat, f"{'looped over links' if looped < flat else 'unrolled'}, the faster form; {times}"


def has_constraints(mechanism: SpatialMechanism) -> bool:
    """Whether joints close loops, drives prescribe coordinates, or gears couple them."""
    return bool(mechanism.joints or mechanism.gears or mechanism.scene.drives)


def _is_along(link: TreeLink) -> bool:
    """Whether the axes of a link are along those of the link before it, so that most products with them vanish."""
    return all(abs(entry) in (0, 1) for row in link.axes for entry in row)
