"""The parts of initial deflections that the shapes of a beam cannot describe."""

from __future__ import annotations

from collections.abc import Iterator

from derive.mechanics.bodies.beam_functions import BeamFunction
from derive.mechanics.bodies.deflection_projection import projection
from derive.percentages import percent
from derive.simulation.observables.beams import beam_bodies, shape_functions
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.scene import Scene


def deflection_remainders(scene: Scene) -> tuple[str, ...]:
    """A line on each initial deflection that is approximated by the nearest one that the shapes of its beam have."""
    beams = beam_bodies(scene)
    return tuple(line for beam in beams for line in remainder_lines(beam, shape_functions(beam), beam.pieces))


def remainder_lines(
    beam: BeamBody, shapes: tuple[BeamFunction, ...], pieces: int, what: str = "the shapes"
) -> Iterator[str]:
    """A line on the initial deflection of a beam, and on its rate, unless these shapes of its pieces describe them.

    what: the words for these shapes.
    """
    for key, curve in (("deflection", beam.start.deflection), ("deflection_rate", beam.start.deflection_rate)):
        remainder = projection(curve, shapes, pieces).remainder if curve else 0.0
        if remainder:
            yield remainder_line(beam.name, key, remainder, what)


def remainder_line(beam: str, key: str, remainder: float, what: str, part: str = "") -> str:
    """The line on the remainder of a curve; part: the words for that part of the curve that has it."""
    return (
        f"bodies.{beam}.start.{key}: {percent(remainder)} of it{part} (rms) is not in {what} of {beam}; the motion "
        "starts with the nearest that is"
    )
