"""The deflection of a marker from the chord between two others, as an output and for plots."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeVar

from derive.algebra import sp
from derive.mechanics.multibody.outputs.marker_motion import MARKER
from derive.mechanics.multibody.outputs.output_type import NamedElements, OutputComponent, OutputComponents, OutputType
from derive.spec.model.keys import KeyType, declared_keys
from derive.spec.model.markers import MarkerRef
from derive.spec.model.plots import Deflection

if TYPE_CHECKING:
    from derive.mechanics.multibody.scene_mechanics import SceneMechanics

CHORD, DIVIDED_BY = (key for key in declared_keys(Deflection) if key.name in ("chord", "divided_by"))

Number = TypeVar("Number")


def distance_from_line(points: Iterable[Any], length: Callable[[Any, Any], Number]) -> Number:
    """The distance of a point to the left of a line: `points` are the point, the start and the end of the line.

    All have two components, which may be expressions or arrays. length: the function that gives the
    length of a vector from its components.
    """
    point, start, end = points
    along, arm = ([b[i] - a[i] for i in range(2)] for a, b in ((start, end), (start, point)))
    distance: Number = (along[0] * arm[1] - along[1] * arm[0]) / length(*along)
    return distance


def deflection_doc(marker: MarkerRef, chord: tuple[MarkerRef, MarkerRef], divided_by: float | None) -> str:
    """The description of a deflection."""
    divisor = "" if divided_by is None else f", divided by {divided_by:g} m"
    return f"deflection of {marker} from the chord {chord[0]} to {chord[1]}{divisor}"


class ChordDeflection(OutputType):
    """The distance of a marker from the chord between two markers."""

    doc = "the distance of a marker from the chord between two markers, positive to its left"
    keys = (MARKER, CHORD, replace(DIVIDED_BY, type=KeyType.POSITIVE))

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Return one component: a length, or a ratio."""
        from derive.mechanics.motion.vectors import length_of

        divisor = values.get("divided_by")
        points = (scene.point(at).position for at in (values["marker"], *values["chord"]))
        distance = distance_from_line(points, lambda x, y: length_of(sp.Matrix([x, y])))
        if divisor is None:
            return OutputComponents((OutputComponent("", "m", distance),))
        return OutputComponents((OutputComponent("", "", distance / divisor),))

    def descriptions(self, values: Mapping[str, Any], mechanism: NamedElements) -> tuple[str, ...]:
        """Return the description of the deflection."""
        divisor = values.get("divided_by")
        return (deflection_doc(values["marker"], values["chord"], None if divisor is None else float(divisor)),)
