"""Departure of a body from the conditions of the mean frame: ratios from 0, in the mean frame, to about 1."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from derive.reduction.arithmetic import Array
from derive.reduction.body import prepare
from derive.reduction.integrals import shape_integrals
from derive.spec.model.body import NodalBody


@dataclass(frozen=True)
class Departure:
    """The departure from the three conditions of the mean frame.

    centre: the distance of O from the centre of mass, divided by the root mean square distance of the mass from O.
    displacement, rotation: the largest mean displacement (17) and mean rotation (19) of a mode, divided by the root of
    its c8.
    """

    centre: float
    displacement: float
    rotation: float

    @property
    def largest(self) -> float:
        """The largest of the three."""
        return max(self.centre, self.displacement, self.rotation)


@dataclass(frozen=True)
class Residuals:
    """The departure of the modes as given or computed, and that of the modes in the body frame."""

    before: Departure
    after: Departure


def residuals(body: NodalBody) -> Residuals:
    """The departure of a body before and after the transformation of its modes to the body frame. Raises SpecError."""
    prepared = prepare(body)
    first, last = prepared.raw, prepared.shapes
    return Residuals(departure(prepared.mass, first.x, first.phi), departure(prepared.mass, last.x, last.phi))


def departure(mass: csr_array, x: Array, phi: Array) -> Departure:
    """The departure of positions x (nodes, 3) and modes phi (N, nodes, 3) from the conditions."""
    known = shape_integrals(mass, x, phi)
    tiny = float(np.finfo(float).tiny)
    polar = max((known.C3[0, 0] + known.C3[1, 1] + known.C3[2, 2]) / 2, tiny)
    sizes = np.sqrt(np.maximum(np.diag(known.c8), tiny))
    displacement = np.sqrt((known.c2**2).sum(axis=1)) / (sizes * math.sqrt(known.mass))
    rotation = np.sqrt((known.c6**2).sum(axis=1)) / (sizes * math.sqrt(polar))
    return Departure(
        centre=float(math.sqrt(float((known.c1**2).sum())) / math.sqrt(known.mass * polar)),
        displacement=float(displacement.max(initial=0.0)),
        rotation=float(rotation.max(initial=0.0)),
    )
