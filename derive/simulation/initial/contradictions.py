"""Given initial values that an initial state cannot have: corrections where they differ by rounding, else an error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from derive.errors import Problem, SpecError
from derive.simulation.initial.targets import Target


@dataclass(frozen=True, eq=False)
class Misfit:
    """A target that an initial state misses: the value that it has instead (SI), and the difference relative to what
    counts as 1: rad, the size of the scene, or the largest velocity in it."""

    target: Target
    value: float
    relative: float


@dataclass(frozen=True)
class Correction:
    """A given value that is corrected, as it contradicts others by rounding: key, unit, and both values (SI)."""

    name: str
    unit: str
    given: float
    value: float

    def __str__(self) -> str:
        return f"{self.name}: {self.given:.12g} {self.unit} -> {self.value:.12g} {self.unit}"


def correction(misfit: Misfit) -> Correction:
    """The correction that a misfit means."""
    return Correction(misfit.target.name, misfit.target.unit, misfit.target.value, misfit.value)


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
                f"{misfit.target.unit} contradicts {conflict}; the nearest {what} have {misfit.value:.6g} "
                f"{misfit.target.unit}. Correct or leave out one of them, or mark it as a first guess by guess = true",
            )
            for misfit in involved
        )
    )
