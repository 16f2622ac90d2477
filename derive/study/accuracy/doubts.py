"""The doubts of monitors about the models of a ladder, beside the measured errors, and why the two differ."""

from __future__ import annotations

from collections.abc import Sequence

from derive.percentages import implied_percent, percent
from derive.study.accuracy.measurement import Line
from derive.study.spin_notes import spin_notes

CAUSES = {
    "deflection": "the deflection",
    "axial_force": "the axial force",
    "bending_moment": "the bending moment",
    "mass_matrix": "the mass matrix",
    "lateral_buckling": "the lateral stiffness",
    "twisting_moment": "the twisting moment",
}
"""The texts of the causes of monitors by their values."""
SMALLER = 2
"""A measured error that is smaller than the implied one by this factor needs a reason."""


def doubt(line: Line, shown: Sequence[str]) -> str:
    """The error that a monitor implies for a line, the measured one, and the doubt; or why a run failed; or nothing.

    shown: the names of the beams that the plot shows.
    """
    if line.warning is None or not line.points:
        return doubt_reason(line, shown)
    return f"{implied_percent(line.warning.error)} implied, {percent(line.best)} measured: {doubt_reason(line, shown)}"


def doubt_reason(line: Line, shown: Sequence[str]) -> str:
    """The doubt of a monitor on a line, and why the measured error may be smaller; or why a run failed, or what it
    notes of finite-element bodies; or nothing."""
    warning = line.warning
    if warning is None:
        few = [f"the modes of {of.body} are too few" for of in line.missed]
        softer = ["stiffness that loads or spin add is missing"] if line.spins else []
        return line.failure or "; ".join([*few, *softer])
    text = f"{CAUSES[warning.cause.value]} of {warning.beam} is in doubt"
    if shown and warning.beam not in shown:
        return f"{text}, and the plot shows {' and '.join(shown)}"
    if line.points and not line.best > warning.error / SMALLER:
        return f"{text}; the estimate is of all of {warning.beam}, the measurement of what the plot shows"
    return text


def doubt_lines(lines: Sequence[Line], shown: Sequence[str], drawn: bool = False) -> list[str]:
    """The models with doubts or notes, with implied and measured errors, and those that failed, by their reasons.

    drawn: for a chart, with how it draws them, and with the stiffness that models miss, which texts have as a note.
    """
    reasons: dict[str, list[str]] = {}
    noted: dict[str, list[str]] = {}
    failures: dict[str, list[str]] = {}
    adaptive = [line for line in lines if line.integrator == "adaptive"]
    for line in adaptive:
        if line.warning is not None:
            measured = percent(line.best) if line.points else "not measured"
            models = reasons.setdefault(doubt_reason(line, shown), [])
            models.append(f"{line.label} ({implied_percent(line.warning.error)}, {measured})")
        for of in line.missed:
            text = f"{line.label} ({implied_percent(of.error)}, {percent(line.best)})"
            noted.setdefault(f"the modes of {of.body}", []).append(text)
    for line in lines:
        if line.failure:
            failures.setdefault(line.failure, []).append(line.label)
    dashed, hollow = (" (hollow, dashed)", " (hollow)") if drawn else ("", "")
    valid = f"Not valid{dashed}, with the error that a monitor implies, and the measured one:"
    modes = f"With too few modes{hollow}, the error of the deformation that is implied, and the measured one of what "
    groups = ((valid, reasons), (f"{modes}the plot shows:", noted), ("Without a result:", failures))
    result = [
        line
        for heading, of in groups
        if of
        for line in (heading, *(f"{reason}: {'; '.join(models)}" for reason, models in of.items()))
    ]
    softer = spin_notes((line.label, line.spins) for line in adaptive) if drawn else []
    return [*result, *([f"Without stiffness that loads or spin add{hollow}:", *softer] if softer else [])]
