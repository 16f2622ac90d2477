"""How far a body is from the mean frame: numbers without units, 0 in the mean frame and at most about 1."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from derive.reduction.arithmetic import Array
from derive.reduction.integrals import Integrals, integrals
from derive.spec.model.body import NodalBody


@dataclass(frozen=True)
class Departure:
    """Distances from the conditions: of O from the centre of mass, and of the modes from (17) and (19).

    `centre` is relative to the root mean square distance of the mass from O. `displacement` and `rotation` are the
    largest parts, over the modes, of the size of a mode (root of its c8) that are a mean displacement and a mean
    rotation.
    """

    centre: float
    displacement: float
    rotation: float

    @property
    def largest(self) -> float:
        """The worst of the three."""
        return max(self.centre, self.displacement, self.rotation)


@dataclass(frozen=True)
class Residuals:
    """The modes as given or as they came out of the eigenvalue problem, and as they are used, before any rounding."""

    before: Departure
    after: Departure


def residuals(body: NodalBody) -> Residuals:
    """The residuals of the centre, (17) and (19), before and after modes are brought to their frame."""
    from derive.reduction.body import prepare

    prepared = prepare(body)
    first, last = prepared.raw, prepared.shapes
    return Residuals(departure(prepared.mass, first.x, first.phi), departure(prepared.mass, last.x, last.phi))


def departure(mass: csr_array, x: Array, phi: Array) -> Departure:
    """The residuals of positions and modes, which are sums over the nodes."""
    return _relative(integrals(mass, x, phi))


def _relative(known: Integrals) -> Departure:
    """|c1|, |c2_i| and |c6_i| over what they would be at most."""
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
