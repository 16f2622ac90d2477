"""The options of studies and their defaults, for functions and commands. Only light modules are imported here.

The command line reads them before anything else is loaded.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import inf, isfinite
from numbers import Integral, Real
from typing import Any

from derive.registry import UnknownNameError

ORDERS = ("first", "truncated", "full")
"""The orders of the displacements of beams."""
FRAMES = ("mean", "chord", "point", "tangent")
"""The frames of polynomials in a ladder."""
MODES = ("free-free", "clamped-free")
"""The natural modes beside the half sine waves."""
COMPONENT_MODES = ("free", "craig_bampton", "attachment")
"""The computed modes of finite-element bodies in a ladder."""
MAX_SHAPES, MAX_PIECES, MAX_MODES, MAX_VALUES = 12, 64, 200, 10_000
"""The largest numbers of shape functions in a ladder, of beams in a rod, of modes, and of values of a parameter."""

ERROR = 0.01
"""The largest error (rms) that is allowed, relative to the peak of a curve."""
TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6, 1e-8)
"""The tolerances of the adaptive integrator."""
FIXED_STEPS = ("rk4", "generalised-alpha")
"""The integrators with fixed steps of a study of accuracy."""
RUNS = 5
"""The interleaved measurements of each run."""

METHODS = ("rk4", "adaptive", "rk45", "generalised-alpha", "trapezoidal")
"""The integrators of a study of methods."""
STUDIED_METHODS = tuple(name for name in METHODS if name != "rk45")
"""The integrators that are studied by default: rk45 is not, which calls Python at each step."""
STEPS, STATES = 100_000, 61
"""The steps of runs that show drift, and the states along the motion."""

NEVER = "none"
"""The text in place of a value if the reference never loses its stability."""


@dataclass(frozen=True)
class LadderRange:
    """The range of models of a ladder: the numbers of shapes of one beam, and of beams with two shapes each.

    modes: the natural modes beside the half sine waves, in the same numbers. torsion: the numbers of shapes of torsion
    of beams in space; none leaves those of the scene. component_modes, component_counts: the kinds and the numbers of
    modes of finite-element bodies. Raises UnknownNameError, ValueError.
    """

    orders: Sequence[str] = ("first", "truncated")
    frames: Sequence[str] = ("mean",)
    shapes: Sequence[int] = (2, 3, 4, 6)
    pieces: Sequence[int] = (2, 3)
    sines: Sequence[int] = (1, 2)
    modes: Sequence[str] = ()
    torsion: Sequence[int] = ()
    component_modes: Sequence[str] = ("free", "craig_bampton")
    component_counts: Sequence[int] = (2, 4, 8, 12)

    def __post_init__(self) -> None:
        checked = {
            "orders": among("order of displacements", self.orders, ORDERS),
            "frames": among("frame of a ladder", self.frames, FRAMES),
            "shapes": numbers("shapes", self.shapes, MAX_SHAPES),
            "pieces": numbers("pieces", self.pieces, MAX_PIECES),
            "sines": numbers("sines", self.sines, MAX_SHAPES),
            "modes": among("kind of natural modes", self.modes, MODES),
            "torsion": numbers("torsion", self.torsion, MAX_SHAPES, least=0),
            "component_modes": among("kind of component modes", self.component_modes, COMPONENT_MODES),
            "component_counts": numbers("component_counts", self.component_counts, MAX_MODES),
        }
        for name, value in checked.items():
            object.__setattr__(self, name, value)


def among(kind: str, names: Sequence[str], known: Sequence[str]) -> tuple[str, ...]:
    """Names, each once, of which a study knows all. Raises TypeError for a name alone, UnknownNameError."""
    every = tuple(dict.fromkeys(several(kind, names)))
    for name in every:
        if name not in known:
            raise UnknownNameError(kind, name, known)
    return every


def numbers(name: str, values: Sequence[int], most: int, least: int = 1) -> tuple[int, ...]:
    """Whole numbers from the least to the largest one, each once. Raises TypeError for others, ValueError."""
    return tuple(dict.fromkeys(whole(name, value, most, least) for value in several(name, values)))


def several(name: str, values: Any) -> tuple[Any, ...]:
    """Several values. Raises TypeError for one alone."""
    if isinstance(values, str) or not isinstance(values, Iterable):
        raise TypeError(f"{name}: several values are needed, such as [{values!r}], not {values!r}")
    return tuple(values)


def whole(name: str, value: Any, most: float = inf, least: int = 1) -> int:
    """A whole number in a range. Raises ValueError."""
    if isinstance(value, bool) or not isinstance(value, Integral) or not least <= int(value) <= most:
        text = f"from {least} to {most}" if isfinite(most) else f"from {least} on"
        raise ValueError(f"{name}: a whole number {text} is needed, not {value!r}")
    return int(value)


def fraction(name: str, value: Any) -> float:
    """An error relative to a peak, or a tolerance. Raises ValueError."""
    if isinstance(value, bool) or not isinstance(value, Real) or not 0 < float(value) < 1:
        raise ValueError(f"{name}: a number between 0 and 1 is needed, such as 0.01, not {value!r}")
    return float(value)


ACCURACY, STABILITY = LadderRange(), LadderRange(shapes=(2, 4), sines=(1,))
"""The ladders of the studies of accuracy and of stability."""
