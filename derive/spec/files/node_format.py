"""The arrays of a body of nodes and the units that they may be in; beyond the files, all is in SI units."""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

FILES = {
    "positions": "Positions of the nodes, (nodes, 3).",
    "mass": "The mass of each node, or the consistent mass matrix.",
    "stiffness": "The stiffness matrix, (3 nodes, 3 nodes), with adjacent displacements of a node.",
    "modes": "The modes as columns, (3 nodes, modes).",
    "modal_stiffness": "The stiffness of the modes, (modes, modes) or its diagonal.",
}
"""The arrays of a body, each a MatrixMarket file where `nodes` is a table."""

LENGTHS = {"m": Fraction(1), "cm": Fraction(1, 100), "mm": Fraction(1, 1000), "in": Fraction("0.0254")}
MASSES = {
    "kg": Fraction(1),
    "g": Fraction(1, 1000),
    "t": Fraction(1000),
    "lbf s^2/in": Fraction("0.45359237") * Fraction("9.80665") / Fraction("0.0254"),
}
TIMES = {"s": Fraction(1), "ms": Fraction(1, 1000)}


class Units(NamedTuple):
    """What one unit of a file is in SI units, exactly."""

    length: Fraction = Fraction(1)
    mass: Fraction = Fraction(1)
    time: Fraction = Fraction(1)

    @property
    def stiffness(self) -> Fraction:
        """Mass per time squared: of millimetres, tonnes and seconds it is N/mm."""
        return self.mass / self.time**2
