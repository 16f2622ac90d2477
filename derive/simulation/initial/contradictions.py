"""Given initial values that an initial state cannot have: corrections where they differ by rounding, else an error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from derive.enumerations import enumeration
from derive.errors import Problem, SpecError
from derive.simulation.initial.targets import Target

ROUNDING = 1e-12
"""Values below this part of what they differ from are rounding errors of zero."""
SHARE = 0.01
"""Demands that are missed by less than this part of the largest miss have no part in a contradiction."""
MOST_NAMED = 4
"""The largest number of joints, of drives, and of other given values that a message names."""


@dataclass(frozen=True, eq=False)
class Misfit:
    """A target that an initial state misses: the value that it has instead (SI), and the difference relative to its
    scale: 1 rad, the size of the scene, or the largest velocity in it."""

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


@dataclass(frozen=True, eq=False)
class Conflict:
    """Demands that cannot be met together. parts: for each joint and drive its noun, its name, and by how much it is
    missed if all others are met. targets: the given values."""

    parts: tuple[tuple[str, str, str], ...] = ()
    targets: tuple[Target, ...] = ()

    @property
    def text(self) -> str:
        """The joints and the drives as text; empty if there are none."""
        groups = []
        for noun in dict.fromkeys(noun for noun, _, _ in self.parts):
            named = [f"{name} (off by {missed})" for of, name, missed in self.parts if of == noun]
            groups.append(f"the {noun}{'s' if len(named) > 1 else ''} {enumeration(named, MOST_NAMED)}")
        return " and ".join(groups)


def contradiction(misfits: Sequence[Misfit], what: str, conflict: Conflict) -> SpecError:
    """The error of given positions or velocities (`what`) that cannot be kept together; those in conflict are named.

    A value that the nearest state keeps may be part of the conflict.
    """
    largest = max(abs(misfit.relative) for misfit in misfits)
    parts = {id(target) for target in conflict.targets}
    involved = [misfit for misfit in misfits if abs(misfit.relative) > SHARE * largest or id(misfit.target) in parts]
    paths = dict.fromkeys(misfit.target.path for misfit in involved)
    problems = []
    for misfit in involved:
        target, value = misfit.target, without_rounding(misfit.value, misfit.target.value)
        others = [path for path in paths if path != target.path]
        constraints = conflict.text or ("" if others and conflict.targets else "the joints and drives")
        against = ", and ".join(filter(None, (constraints, enumeration(others, MOST_NAMED))))
        kept = abs(misfit.relative) <= SHARE * largest
        nearest = "" if kept else f"; the nearest {what} have {value:.6g} {target.unit}"
        problems.append(
            Problem(
                target.path,
                f"{target.label + ': ' if target.label else ''}{target.value:g} {target.unit} contradicts {against}"
                f"{nearest}. Correct or leave out one of them, or write guess = true in [{target.table}] to make it a "
                "first guess",
            )
        )
    return SpecError(tuple(problems))
