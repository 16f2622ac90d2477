"""Components: the bodies of the equations of motion, one or several for each body of a specification."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from derive.mechanics.body import Body
from derive.mechanics.motion.material_points import MaterialPoint
from derive.mechanics.terms import ModelConstant


@dataclass(frozen=True)
class CrossSection:
    """A cross-section of a body: its material point, and its rotation by each assumed mode (none in a rigid body)."""

    point: MaterialPoint
    rotations: tuple[ModelConstant, ...] = ()


@dataclass(frozen=True)
class Component:
    """A body with its own coordinates, whose names begin with `name`; the names of its constants begin with `group`.

    The pieces of a rod share their constants, and therefore `body`. `sections` are the cross-sections of the component
    by their names; `markers` are the names of those that the specification declares.
    """

    name: str
    group: str
    body: Body
    sections: Mapping[str, CrossSection]
    markers: tuple[str, ...]
