"""Makes bracket.inp, the input of CalculiX for an L-shaped bracket of steel, of quadratic bricks.

    python scenes/make_bracket.py bracket.inp

The legs of the bracket lie along x and z. Its node sets `right` and `left` are the end faces of these legs, to which
joints are attached. The first step computes natural frequencies and modes of the free bracket, and the second one
writes its stiffness and its mass to bracket.sti, bracket.mas and bracket.dof. Units are m, kg and s.
"""

from __future__ import annotations

import sys
from itertools import product
from pathlib import Path

LEG, WIDTH, THICKNESS = 0.2, 0.04, 0.02  # m
YOUNG, POISSON, DENSITY = 210e9, 0.3, 7850.0  # Pa, 1, kg/m^3
MODES = 20

Key = tuple[int, int, int]

CORNERS = ((0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2))
EDGES = ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))
"""The nodes of a brick in the order of CalculiX are its corners, and then the middles of these edges."""


def nodes_of(cell: Key) -> list[Key]:
    """The 20 nodes of a cell, counted in half cells along each axis."""
    corners = [(2 * cell[0] + a, 2 * cell[1] + b, 2 * cell[2] + c) for a, b, c in CORNERS]
    pairs = ((corners[i], corners[j]) for i, j in EDGES)
    return corners + [((p[0] + q[0]) // 2, (p[1] + q[1]) // 2, (p[2] + q[2]) // 2) for p, q in pairs]


def along_a_leg(half_cells: int, along: int, through: int) -> float:
    """A coordinate x or z (m): the first cells are in the corner of both legs, and the others in the rest of one."""
    beyond = half_cells / 2 - through
    return THICKNESS * (1 + beyond / through) if beyond < 0 else THICKNESS + (LEG - THICKNESS) * beyond / along


def numbers(values: list[int]) -> list[str]:
    """Lines of at most ten numbers; a line that goes on ends with a comma."""
    rows = [", ".join(map(str, values[i : i + 10])) for i in range(0, len(values), 10)]
    return [*(f"{row}," for row in rows[:-1]), rows[-1]]


def bracket(along: int = 8, across: int = 2, through: int = 1) -> str:
    """The input with so many bricks along each leg beyond the corner, across its width, and through its thickness."""
    foot = product(range(through + along), range(across), range(through))
    back = product(range(through), range(across), range(through, through + along))
    cells = [*foot, *back]
    keys = sorted({key for cell in cells for key in nodes_of(cell)})
    number = {key: i for i, key in enumerate(keys, 1)}
    text = ["*HEADING", "L-shaped bracket of steel; m, kg, s", "*NODE, NSET=all"]
    for (a, b, c), i in number.items():
        x, z = along_a_leg(a, along, through), along_a_leg(c, along, through)
        text.append(f"{i}, {x:.9g}, {WIDTH * b / across / 2:.9g}, {z:.9g}")
    text.append("*ELEMENT, TYPE=C3D20, ELSET=bracket")
    for i, cell in enumerate(cells, 1):
        text += numbers([i, *(number[key] for key in nodes_of(cell))])
    for name, axis in (("right", 0), ("left", 2)):
        end = 2 * (through + along)
        text += [f"*NSET, NSET={name}", *numbers([i for key, i in number.items() if key[axis] == end])]
    text += ["*MATERIAL, NAME=steel", "*ELASTIC", f"{YOUNG:g}, {POISSON:g}", "*DENSITY", f"{DENSITY:g}"]
    text += ["*SOLID SECTION, ELSET=bracket, MATERIAL=steel"]
    text += ["*STEP", "*FREQUENCY", f"{MODES}", "*NODE FILE", "U", "*END STEP"]
    text += ["*STEP", "*FREQUENCY, SOLVER=MATRIXSTORAGE", "*END STEP", ""]
    return "\n".join(text)


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(bracket(*map(int, sys.argv[2:])), encoding="utf-8")
