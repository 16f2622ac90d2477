"""Notes on numbers that solid bodies do not have, as wrong units give them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from derive.spec.model.node_data import NodeData

SPEEDS = (0.01, 2e4)
"""The range of the first natural frequency times the length of a body, m/s: below the speed of sound in diamond, above
that of a slender strip of rubber."""

DENSITIES = (1.0, 3e4)
"""The densities of solids, kg/m^3: from aerogel to osmium."""

YOUNGS = (1e3, 2e12)
"""Young's moduli of solids, Pa: from gel to diamond."""


def unit_notes(data: NodeData, first: float) -> Iterator[str]:
    """Notes on the numbers of a body in SI units and on its first elastic frequency, Hz."""
    sizes = np.ptp(data.positions, axis=0)
    length = float(sizes.max())
    doubts = []
    speed = first * length
    if not SPEEDS[0] <= speed <= SPEEDS[1]:
        doubts.append(f"a body of {length:.3g} m has its first frequency at {first:.3g} Hz")
    for material in data.mesh.materials.values() if data.mesh else ():
        if material.density is not None and not DENSITIES[0] <= material.density <= DENSITIES[1]:
            doubts.append(f"a density is {material.density:.3g} kg/m^3")
        if material.young is not None and not YOUNGS[0] <= material.young <= YOUNGS[1]:
            doubts.append(f"a Young's modulus is {material.young:.3g} Pa")
    heaviest = float(data.mass.sum()) / float(np.prod(sizes)) if np.prod(sizes) else 0.0
    if heaviest > DENSITIES[1]:
        doubts.append(f"the mass fills its box with {heaviest:.3g} kg/m^3")
    if doubts:
        yield (
            f"warning: {', and '.join(doubts)}, which no solid has; check the units: files in mm and N have "
            "the mass in t, --units mm,t,s"
        )
