"""The motion of a marker frame of a free body along the axes of this body, in which its levers are those of the body.

It follows from the motion in the inertial frame with the unit tensor for Q: positions and levers are then r, and the
virtual translations of the origin are along the axes of the body.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.multibody.space.frame_motion import KEPT, frame_motion
from derive.mechanics.terms import OwnAxes

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from derive.mechanics.motion.body_motion import Motion
    from derive.mechanics.multibody.bodies.body_type import CrossSection


def own_axes(
    motion: Motion, section: CrossSection, rows: Mapping[str, str], change: Callable[[sp.Expr], sp.Expr]
) -> OwnAxes:
    """The motion of a marker frame of a free body.

    rows: the rows of the body by those of its kind; change: an expression of the kind in symbols of the body.
    """
    frame = frame_motion(motion, section)
    turned = frame_motion(_along_its_axes(motion), section)
    known = {d.symbol: d.expr for d in frame.definitions}
    others: dict[sp.Symbol, sp.Expr] = {}
    for d in turned.definitions:
        if known.get(d.symbol) != d.expr:
            others[d.symbol] = d.expr.xreplace(others)
    at_rest = {row.a: sp.S.Zero for row in motion.rows}

    def changed(expr: sp.Expr) -> sp.Expr:
        return change(expr.xreplace(at_rest).xreplace(others))

    vectors = (turned.acceleration, turned.angular_acceleration, turned.axes, turned.angular_velocity)
    return OwnAxes(
        sp.ImmutableMatrix(motion.rotation.applyfunc(change)),
        tuple((rows[row], changed(work)) for row, work in turned.any_work),
        *(sp.ImmutableMatrix(of.applyfunc(changed)) for of in vectors),
    )


@lru_cache(KEPT)
def _along_its_axes(motion: Motion) -> Motion:
    """The motion with the unit tensor for Q: one for all markers, since the motion of a frame is kept by its body."""
    return replace(motion, rotation=sp.ImmutableMatrix(sp.eye(3)))
