"""The choice between straight-line code and loops over links for trees in relative coordinates.

Straight-line code of n links took 30, 44, 49, 56 ns for each of 3, 6, 10, 16 revolute links in a chain, loops 55, 50,
50, 47 ns (gcc 12, -O3 -march=x86-64-v3, AMD EPYC, family 26); the compiler took 6, 23, 66, 81 s for the functions of
explicit integration in straight-line code, and some 7 s for those in loops. Loops have no derivatives, so that models
that need these stay in straight-line code as long as a compiler takes it.
"""

from __future__ import annotations

from collections.abc import Collection

from derive.enumerations import enumeration
from derive.lowering.trees.joint_outputs import LOOPED, MOST_UNROLLED, joint_outputs
from derive.lowering.trees.links import refusals
from derive.mechanics.multibody.space.mechanism import SpatialMechanism

MOST_WITH_DERIVATIVES = 24
"""The largest number of links for which models with derivatives are straight-line code."""


def chosen(mechanism: SpatialMechanism, explicit: bool, functions: Collection[str] = ()) -> tuple[bool, str]:
    """Whether a mechanism in relative coordinates is looped over its links, and a line that says why.

    explicit: whether derivatives are not needed; functions: those on request.
    """
    links = len(mechanism.rows) - 5 * sum(len(of.coordinates.rows) == 6 for of in mechanism.instances)
    flat, looped = links * (29 + 1.7 * links), 30 + 45 * links
    times = f"predicted evaluation time of the accelerations: {flat:.0f} ns unrolled, {looped:.0f} ns looped over links"
    has_others = len(mechanism.rows) > MOST_UNROLLED and joint_outputs(mechanism) is None
    if any(refusals(mechanism)) or has_others:
        return False, "unrolled, since loops over links do not have all that the scene has"
    if not {*functions} <= LOOPED:
        return False, f"unrolled, for {enumeration([*functions])}"
    if looped > flat:
        return False, f"unrolled, the faster form; {times}"
    if explicit or links > MOST_WITH_DERIVATIVES:
        return True, f"looped over links, the faster form; {times}"
    return False, f"unrolled, since loops over links have no derivatives; {times}"
