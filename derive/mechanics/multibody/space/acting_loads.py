"""The loads of forces, torques and springs on a marker of a finite-element body, as outputs that a simulation adds."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from derive.algebra import sp
from derive.mechanics.axes import AXES
from derive.mechanics.motion.vectors import dot
from derive.mechanics.multibody.bodies.rigid import BODY_FRAME
from derive.mechanics.multibody.space.marker_outputs import MARKER
from derive.mechanics.multibody.space.output_parts import SpatialComponent, SpatialOutputType, SpatialParts
from derive.spec.model.keys import Key, KeyType
from derive.spec.model.markers import MarkerRef

NUMBER = Key("number", KeyType.CHOICE, "", "1 to 3, forces along the axes of the body; 4 to 6, torques.", required=True)


def _acting_load(values: Mapping[str, Any], parts: SpatialParts) -> tuple[SpatialComponent, ...]:
    marker, number = values[MARKER.name], values[NUMBER.name] - 1
    loads = [load for action in parts.actions for load in action.on(marker.body) if load.marker == marker]
    axes = sp.Matrix(parts.at(MarkerRef(marker.body, BODY_FRAME)).frame)
    turns, axis = divmod(number, len(AXES))
    total = sp.Add(*(dot(axes[:, axis], load.torque if turns else load.force) for load in loads))
    noun, unit = ("torque", "N m") if turns else ("force", "N")
    return (SpatialComponent("", unit, f"{noun} of actions on {marker} along e{axis + 1}", total),)


ACTING_LOAD = SpatialOutputType(
    "load of actions on a marker, in the frame of its body", (MARKER, NUMBER), ("",), _acting_load
)
"""The total of forces, torques and springs, without joints and gravity."""
