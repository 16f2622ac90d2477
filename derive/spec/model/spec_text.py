"""The texts of specifications for `__repr__`: scenes with the names of their elements, beams, and bodies of nodes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

from derive.short_text import WIDTH, counted, listed, number_text, short_text, summary

ROOM = WIDTH - 14
"""The characters for names beside a label."""


def scene_text(scene: Any, nouns: Mapping[str, str]) -> str:
    """A scene: its bodies and joints by their kinds, all other elements by their nouns, and its simulation.

    nouns: the sections of a scene with the noun for one element.
    """
    sections = {noun: tuple(getattr(scene, section, ())) for section, noun in nouns.items()}
    bodies, joints = sections.pop("body"), sections.pop("joint")
    counts = [counted(len(bodies), "body", "bodies"), counted(len(joints), "joint")]
    others = [counted(len(elements), noun) for noun, elements in sections.items() if elements]
    return summary(
        f"{type(scene).__name__} {scene.name}: {', '.join([*counts, *others])}",
        {
            "bodies": by_kind([(body.name, body_kind(body)) for body in bodies]),
            "joints": by_kind([(joint.name, joint.kind) for joint in joints]),
            "others": by_kind([(of.name, noun) for noun, elements in sections.items() for of in elements]),
            "simulation": simulation_text(scene.simulation),
        },
    )


def body_kind(body: Any) -> str:
    """The kind of a body in a word or two: "rigid", "beam in 3 pieces", "finite elements"."""
    pieces = getattr(body, "pieces", 1)
    return f"{body.kind} in {pieces} pieces" if pieces > 1 else str(body.kind)


def by_kind(pairs: Sequence[tuple[str, str]]) -> str:
    """Names with their kinds, which successive ones of a kind share: "crank_pin, slider_pin (revolute)"."""
    texts = [
        name if after and after[1] == kind else f"{name} ({kind})"
        for (name, kind), after in zip(pairs, [*pairs[1:], None], strict=False)
    ]
    return listed(texts, ROOM)


def simulation_text(simulation: Any) -> str:
    """A simulation: how long, and the time between rows."""
    return f"{simulation.duration:g} s, a row every {simulation.output:g} s" if simulation else ""


def polynomial_text(coefficients: Sequence[Fraction]) -> str:
    """A polynomial in xi by its coefficients, from the constant one on: "1 - xi^2"."""
    terms: list[str] = []
    for power, factor in enumerate(coefficients):
        if factor:
            of = "" if power == 0 else "xi" if power == 1 else f"xi^{power}"
            size = number_text(abs(factor))
            term = size if not of else of if size == "1" else f"{size}*{of}"
            sign = ("-" if factor < 0 else "") if not terms else (" - " if factor < 0 else " + ")
            terms.append(f"{sign}{term}")
    return "".join(terms) or "0"


def shapes_text(ansatz: Any) -> str:
    """The shapes of a beam: polynomials, or a family of modes."""
    if isinstance(ansatz, tuple):
        return listed(map(polynomial_text, ansatz), ROOM)
    return f"the first {counted(ansatz.count, f'{ansatz.kind} mode')}"


def beam_text(beam: Any) -> str:
    """A beam: its frame, its shapes, its constants and its markers."""
    at = "" if beam.frame.at is None else f" at xi = {short_text(beam.frame.at)}"
    constants = (
        ("mass", beam.mass, "kg"),
        ("length", beam.length, "m"),
        ("bending stiffness", beam.bending_stiffness, "N m^2"),
    )
    return summary(
        f"PlanarBeam {beam.name}: {beam.frame.kind} frame{at}, {beam.order.value}",
        {
            "ansatz": shapes_text(beam.ansatz),
            "constants": ", ".join(f"{name} {quantity_text(value, unit)}" for name, value, unit in constants),
            "markers": listed((marker.name for marker in beam.markers), ROOM),
            "simulation": simulation_text(beam.simulation),
        },
    )


def quantity_text(value: Any, unit: str) -> str:
    """A physical constant: its number, or the symbol and the default of its parameter, and its unit."""
    return f"{number_text(value)} {unit}" if isinstance(value, Fraction) else str(value)


def nodal_text(body: Any) -> str:
    """A body that is given by nodes: their number, its modes, its frame and its markers."""
    modes = "the given modes" if body.modes is None else _modes_text(body.modes)
    return summary(
        f"NodalBody {body.name}: {counted(len(body.data.positions), 'node')}, {modes}, {body.frame.kind} frame",
        {
            "markers": listed((marker.name for marker in body.markers), ROOM),
            "simulation": simulation_text(body.simulation),
        },
    )


def _modes_text(modes: Any) -> str:
    """A number of modes, or the error within which as few as possible are selected."""
    return (
        counted(modes, "mode") if isinstance(modes, int) else f"modes within {modes.error:g} up to {modes.up_to:g} Hz"
    )


def symbolic_text(body: Any) -> str:
    """A body whose numbers are all parameters."""
    damped = ", damped" if body.damping else ""
    return f"SymbolicBody {body.name}: {counted(body.modes, 'mode')}, {body.frame} frame{damped}"
