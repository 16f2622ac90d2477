"""Given initial values that an initial state cannot have: corrections where they differ by rounding, else an error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from derive.errors import Problem, SpecError
from derive.simulation.initial.targets import Target

ROUNDING = 1e-12
"""Values below this part of what they differ from are rounding errors of zero."""


@dataclass(frozen=True, eq=False)
class Misfit:
    """A target that an initial state misses: the value that it has instead (SI), and the difference relative to what
    counts as 1: rad, the size of the scene, or the largest velocity in it."""

    target: Target
    value: float
    relative: float


@dataclass(frozen=True)
class InitialValue:
    """An initial value of the specification: its key, its unit, the value that is specified and that of the initial
    state (SI); whether it is a first guess; whether it is corrected, as it contradicts others by rounding."""

    name: str
    unit: str
    specified: float
    value: float
    guess: bool
    corrected: bool

    def __str__(self) -> str:
        value = without_rounding(self.value, self.specified)
        return f"{self.name}: {self.specified:.12g} {self.unit} -> {value:.12g} {self.unit}"


def without_rounding(value: float, specified: float) -> float:
    """A value that replaces the specified one, as it is printed: 0 if it is a rounding error of their difference."""
    return 0.0 if abs(value) < ROUNDING * abs(value - specified) else value


def contradiction(misfits: Sequence[Misfit], what: str) -> SpecError:
    """The error of given positions or velocities (`what`) that cannot be kept together; those in conflict are named."""
    largest = max(abs(misfit.relative) for misfit in misfits)
    involved = [misfit for misfit in misfits if abs(misfit.relative) > 0.01 * largest]
    others = len({misfit.target.path for misfit in involved}) > 1
    conflict = "the joints, drives and the other values named here" if others else "the joints and drives"
    return SpecError(
        tuple(
            Problem(
                misfit.target.path,
                f"{misfit.target.label + ': ' if misfit.target.label else ''}{misfit.target.value:g} "
                f"{misfit.target.unit} contradicts {conflict}; the nearest {what} have "
                f"{without_rounding(misfit.value, misfit.target.value):.6g} {misfit.target.unit}. Correct or leave out "
                "one of them, or mark it as a first guess by guess = true",
            )
            for misfit in involved
        )
    )
