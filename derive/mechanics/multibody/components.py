"""Components: the bodies of the equations of motion, one or several for each body of a specification."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from derive.mechanics.body import Body
from derive.mechanics.motion.material_points import MaterialPoint
from derive.mechanics.terms import ModelConstant


@dataclass(frozen=True)
class CrossSection:
    """A material point, and the rotations of the body's section there by each shape (none in a rigid body)."""

    point: MaterialPoint
    rotations: tuple[ModelConstant, ...] = ()


@dataclass(frozen=True)
class Component:
    """A body with coordinates of its own: `name` begins the names of these, `group` those of its constants.

    Pieces of one rod share their constants, so `body` is one for all of them. `sections` are its material points by
    their names, `markers` those that the specification names.
    """

    name: str
    group: str
    body: Body
    sections: Mapping[str, CrossSection]
    markers: tuple[str, ...]
