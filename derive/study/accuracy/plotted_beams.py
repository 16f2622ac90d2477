"""The beams that a plot shows: those whose deflection, coordinates or outputs it draws."""

from __future__ import annotations

from collections.abc import Iterator

from derive.mechanics.symbols import Family, amplitude, owned, quantity, vector
from derive.simulation.observables.beams import beam_bodies, fields_of, piece_names
from derive.simulation.observables.default_plots import output_columns
from derive.spec.model.markers import MarkerRef
from derive.spec.model.plots import Deflection, Plot
from derive.spec.model.scene import BeamBody, Scene


def plotted_beams(plot: Plot, scene: Scene) -> tuple[str, ...]:
    """The names of the beams that a plot shows, in the order of the scene.

    Empty where it shows none of them alone, such as an energy or the reaction of a joint between rigid bodies.
    """
    shown = (
        {plot.quantity.marker.body} if isinstance(plot.quantity, Deflection) else _of_columns(plot.quantity.y, scene)
    )
    return tuple(beam.name for beam in beam_bodies(scene) if beam.name in shown)


def _of_columns(columns: tuple[str, ...], scene: Scene) -> set[str]:
    """The bodies to whose coordinates or outputs the columns belong."""
    bodies = {column: {beam.name} for beam in beam_bodies(scene) for column in _coordinates(beam)}
    for output in scene.outputs:
        own = set(_bodies(list(output.values.values()), scene))
        bodies |= dict.fromkeys(output_columns(output), own)
    return {body for column in columns for body in bodies.get(column, ())}


def _coordinates(beam: BeamBody) -> Iterator[str]:
    """The names of the coordinates of a beam and of their rates."""
    for order in (0, 1):
        symbols = [*vector(Family.TRANSLATION, 2, order), quantity(Family.ANGLE, derivative=order)]
        symbols += [amplitude(i + 1, order) for i in range(len(fields_of(beam)))]
        yield from (owned(symbol, piece).name for piece in piece_names(beam) for symbol in symbols)


def _bodies(values: list[object], scene: Scene) -> Iterator[str]:
    """The bodies of the markers and joints among the values of an output."""
    joints = {joint.name: (joint.first, joint.second) for joint in scene.joints}
    for value in values:
        if isinstance(value, MarkerRef):
            yield value.body
        elif isinstance(value, (tuple, list)):
            yield from _bodies([*value], scene)
        elif isinstance(value, str) and value in joints:
            yield from (end.body for end in joints[value])
