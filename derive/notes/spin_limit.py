"""The spin at which a free beam of first order loses its stiffness, which can fall with the number of its shapes.

About the straight beam that spins steadily with its centre of mass at rest, the equations of the amplitudes in the
rotating frame are

    (c8 - c2 c2^T/m - c6 c6^T/C3) alpha'' + (K - spin^2 (c8 - c2 c2^T/m)) alpha = 0,

since its origin moves by -c2 alpha/m, and its frame turns by -c6 alpha/C3. Stiffness is lost where the second matrix
becomes singular. In the mean frame c2 = c6 = 0, and the limit is the first natural frequency, which more shapes make
more accurate. In another frame it lies lower, because modes that rotate the beam relative to its frame soften too much
(c6 is missing in the second matrix), and every further shape lowers it, or leaves it, as Rayleigh's quotient shows.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from derive.mechanics.bodies.beam import beam_body
from derive.mechanics.body import Body
from derive.mechanics.symbols import Family
from derive.notes.conditioning import beams
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.specification import Specification

NOTICEABLE = 0.99
"""A limit below this part of the first natural frequency is that of the frame, and not of the beam."""
FEW = 2
"""The number of shapes of the paper, with which a limit is compared."""

Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class SpinLimits:
    """The limits of a free beam, in sqrt(EI/(m l^3)).

    spins: those at which stiffness is lost with the first 1, 2, ... of the shapes. natural_frequency: the first of the
    free beam, computed with all of them.
    """

    spins: tuple[float, ...]
    natural_frequency: float


def spin_limits(beam: PlanarBeam) -> SpinLimits:
    """The limits of a free beam of first order, whatever its order, from its shape integrals.

    The limits are those of its bending, without attached masses.
    """
    body = _straight_beam(beam)
    K, c8, c2, c6 = (_values(body, family) for family in (Family.STIFFNESS, Family.C8, Family.C2, Family.C6))
    rotary = _values(body, Family.C3).item()
    softened = c8 - np.outer(c2, c2)
    moved = softened - np.outer(c6, c6) / rotary
    spins = tuple(_lowest(K[:n, :n], softened[:n, :n]) for n in range(1, body.modes + 1))
    return SpinLimits(spins, _lowest(K, moved))


def _straight_beam(beam: PlanarBeam) -> Body:
    """The bending of a beam of unit mass, length and bending stiffness, of first order."""
    one = Fraction(1)
    unit = replace(beam, mass=one, length=one, bending_stiffness=one, order=DisplacementOrder.FIRST_ORDER)
    return beam_body(replace(unit, markers=(), gravity=None, damping=None, masses=(), axial=None))


def spin_notes(spec: Specification) -> tuple[str, ...]:
    """A line on each beam of first order whose frame and whose number of shapes lower the spin that it bears."""
    return tuple(note for beam, pieces in beams(spec) if (note := _note(beam, pieces)))


def _note(beam: PlanarBeam, pieces: int) -> str:
    if beam.order is not DisplacementOrder.FIRST_ORDER or (count := _straight_beam(beam).modes) <= FEW:
        return ""
    limits = spin_limits(beam)
    least = limits.spins[-1]
    if least > NOTICEABLE * limits.natural_frequency:
        return ""
    each = f"each of the {pieces} beams of {beam.name}" if pieces > 1 else beam.name
    return (
        f"{each}: to first order in its {beam.frame.kind} frame, a free beam with these {count} shapes loses its "
        f"stiffness at a spin of {least:.4g} sqrt(EI/(m l^3)), with the first {FEW} at {limits.spins[FEW - 1]:.4g}; in "
        f"the mean frame at its first natural frequency, {limits.natural_frequency:.4g}; with order = 2 it stiffens"
    )


def _values(body: Body, family: Family) -> Matrix:
    """The entries of a shape integral of a planar body: (N, N) of two shapes, (N,) of one, (1,) of none; e2 of c2."""
    constants = [c for c in body.constants if c.symbol.identity.family is family]
    order = max(len(c.symbol.identity.shapes) for c in constants)
    result = np.zeros((body.modes,) * order)
    for constant in constants:
        known = constant.symbol.identity
        if known.components in ((), (2,)):
            at = tuple(shape - 1 for shape in known.shapes)
            result[at] = result[at[::-1]] = float(constant.value)
    return result


def _lowest(stiffness: Matrix, mass: Matrix) -> float:
    """The square root of the lowest eigenvalue of a stiffness and a mass matrix."""
    from scipy.linalg import eigh  # beams of few shapes do not need it, whose import takes a tenth of a second

    return float(1 / np.sqrt(eigh(mass, stiffness, eigvals_only=True)[-1]))
