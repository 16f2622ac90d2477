"""The mass matrix: its pattern as a picture, its entries, and its structural zeros grouped by reason."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from html import escape
from itertools import groupby
from operator import itemgetter

from derive.artifacts import MARK
from derive.ir.model import Model
from derive.mechanics.equations import Equations
from derive.mechanics.expansion import TRANSLATIONS
from derive.mechanics.indexed_equations import IndexedEquations
from derive.mechanics.symbols import Family, Identity, amplitude
from derive.mechanics.terms import Reason
from derive.report.document.formula import Equation, Formula, Matrix, Name, Part
from derive.report.document.page import (
    Block,
    Content,
    Details,
    EquationBlock,
    Heading,
    Paragraph,
    Picture,
    TableBlock,
    folded,
    table,
)
from derive.report.notation.expressions import Notation
from derive.report.notation.integral_formulas import reason
from derive.report.notation.labels import SHAPE, label, row_identities

CELL, EDGE, SMALL, WIDTH = 28, 6, 24, 560
"""Side of a cell, margin, the most rows with names, and the width of larger pictures."""

WRITTEN, FEW = 6, 8
"""The most rows of a matrix whose entries are shown as formulas, and the most entries that a table lists."""

SHORT = 3
"""Letters of a name that fits above a column."""

STYLE = """\
  <style>
    text { font: 13px system-ui, 'DejaVu Sans', sans-serif; fill: #1c2733; }
    .ground { fill: #ffffff; } .value, .own { fill: #1f6f8b; } .zero, .dot { fill: #8795a1; }
    .frame { fill: none; stroke: #b8c2cc; }
    .none { fill: #ffffff; fill-opacity: 0; }
    @media (prefers-color-scheme: dark) {
      text { fill: #e6edf3; } .ground { fill: #13171b; }
      .value, .own { fill: #5fb6d4; } .zero, .dot { fill: #75818c; } .frame { stroke: #55606b; }
    }
  </style>"""

SHOWN = 3
"""Reasons that are listed without being folded."""

FOOT, LEGEND = 26, 200
"""Height and width of the legend, in pixels."""

HINT = "The pointer shows the reason of a zero."

Reasons = dict[tuple[int, int], Reason]


@dataclass(frozen=True)
class MassPattern:
    """A symmetric pattern: labels of the rows, the entries of both triangles, the reason of each zero."""

    labels: tuple[str, ...]
    entries: frozenset[tuple[int, int]]
    reasons: Reasons

    @property
    def size(self) -> int:
        """The number of rows."""
        return len(self.labels)

    @property
    def count(self) -> str:
        """The number of entries and that of all elements of the matrix, as text."""
        return f"{len(self.entries)} of {self.size**2}"


def mass_matrix(model: Model, equations: Equations) -> MassPattern:
    """The pattern of the mass matrix of a model."""
    lower = model.pattern("mass", "M").entries
    entries = frozenset(lower) | {(j, i) for i, j in lower}
    rows = [known for name, known in row_identities(equations).items() if name != SHAPE]
    if isinstance(equations, IndexedEquations):
        rows += [amplitude(i).identity for i in range(1, equations.modes + 1)]
        given = dict(_of_blocks(equations, rows, entries))
    else:
        given = {(i, j): reason for i, j, reason in equations.mass_zeros}
    return MassPattern(tuple(map(label, rows)), entries, given | {(j, i): reason for (i, j), reason in given.items()})


BLOCKS = {
    (Family.VIRTUAL_ROTATION, Family.TRANSLATION): (Family.C1, Family.C2),
    (Family.AMPLITUDE, Family.TRANSLATION): (Family.C2,),
    (Family.AMPLITUDE, Family.VIRTUAL_ROTATION): (Family.C6, Family.C7),
}
"""The integrals that the blocks of a mass matrix are made of, by the families of its rows and columns."""


def _of_blocks(
    equations: IndexedEquations, rows: Sequence[Identity], entries: frozenset[tuple[int, int]]
) -> Iterator[tuple[tuple[int, int], Reason]]:
    """Zeros of the lower triangle with the reasons of their blocks."""
    reasons = {block: equations.reason(*families) for block, families in BLOCKS.items()}
    reasons[Family.TRANSLATION, Family.TRANSLATION] = Reason(identity=TRANSLATIONS)
    reasons[Family.AMPLITUDE, Family.AMPLITUDE] = Reason(identity=equations.table(Family.C8).zero)
    for i, row in enumerate(rows):
        for j, column in enumerate(rows[: i + 1]):
            if (i, j) not in entries:
                yield (i, j), reasons[row.family, column.family]


def picture(matrix: MassPattern, reasons: bool = True) -> str:
    """The picture as SVG, with the reasons of its zeros or without."""
    n = matrix.size
    named = n <= SMALL
    cell = CELL if named else max(2, WIDTH // n)
    longest = max(map(len, matrix.labels))
    left = EDGE + (longest * 9 + 10 if named else 0)
    top = EDGE + ((20 if longest <= SHORT else longest * 9) if named else 0)
    width, height = max(left + n * cell + EDGE, LEGEND), top + n * cell + EDGE + FOOT
    lines = [f'  <rect class="ground" width="{width}" height="{height}"/>', *_legend(height - FOOT, named)]
    lines += _labels(matrix, left, top) if named else []
    lines.append(f'  <rect class="frame" x="{left}" y="{top}" width="{n * cell}" height="{n * cell}" rx="3"/>')
    lines += _values(matrix, left, top, cell)
    lines += _dots(matrix, left, top) if named else []
    lines += _reasons(matrix, left, top, cell) if reasons else []
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" role="img">'
    title = f"  <title>Mass matrix: {matrix.count} entries</title>"
    return "\n".join([head, f"  <!-- {MARK} -->", title, STYLE, *lines, "</svg>\n"])


def _legend(top: int, dots: bool) -> list[str]:
    """The legend of the picture: squares and, with `dots`, dots."""
    result = [
        f'  <rect class="own" x="{EDGE}" y="{top + 6}" width="12" height="12" rx="2"/>',
        f'  <text x="{EDGE + 18}" y="{top + 16}">non-zero</text>',
    ]
    mark = f'  <circle class="dot" cx="{EDGE + 92}" cy="{top + 12}" r="2"/>' if dots else ""
    text = f'  <text x="{EDGE + 100}" y="{top + 16}">always zero</text>' if dots else ""
    return [*result, *filter(None, (mark, text))]


def _labels(matrix: MassPattern, left: int, top: int) -> list[str]:
    lines = []
    for k, name in enumerate(matrix.labels):
        middle = k * CELL + CELL // 2
        words = escape(name)
        lines.append(f'  <text x="{left - 8}" y="{top + middle + 4}" text-anchor="end">{words}</text>')
        x, y = left + middle, top - 8
        if any(len(other) > SHORT for other in matrix.labels):  # they would run into each other
            turn = f'text-anchor="start" transform="rotate(-90 {x + 4} {y})"'
            lines.append(f'  <text x="{x + 4}" y="{y}" {turn}>{words}</text>')
        else:
            lines.append(f'  <text x="{x}" y="{y}" text-anchor="middle">{words}</text>')
    return lines


def _values(matrix: MassPattern, left: int, top: int, cell: int) -> list[str]:
    """A square for each entry, of large matrices a bar for each run of entries."""
    gap = 4 if cell == CELL else 0 if cell < 8 else 1
    corner = ' rx="2"' if gap else ""
    lines = []
    for i in range(matrix.size):
        present = [j for j in range(matrix.size) if (i, j) in matrix.entries]
        for first, count in _runs(present) if cell < CELL else [(j, 1) for j in present]:
            x, y, side = left + first * cell + gap, top + i * cell + gap, cell - 2 * gap
            long = count * cell - 2 * gap
            lines.append(f'  <rect class="value" x="{x}" y="{y}" width="{long}" height="{side}"{corner}/>')
    return lines


def _dots(matrix: MassPattern, left: int, top: int) -> list[str]:
    """A dot for each zero."""
    middle = CELL // 2
    places = ((i, j) for i in range(matrix.size) for j in range(matrix.size) if (i, j) not in matrix.entries)
    return [
        f'  <circle class="zero" cx="{left + j * CELL + middle}" cy="{top + i * CELL + middle}" r="2"/>'
        for i, j in places
    ]


def _reasons(matrix: MassPattern, left: int, top: int, cell: int) -> list[str]:
    """A region with a tooltip over each run of zeros that have the same reason."""
    lines = []
    for i, name in enumerate(matrix.labels):
        absent = [j for j in range(matrix.size) if (i, j) not in matrix.entries]
        why = {j: matrix.reasons[i, j] for j in absent}
        for _, group in groupby(absent, key=why.__getitem__):
            for first, count in _runs(list(group)):
                words = escape(f"{_place(matrix, name, first, count)}: {why[first]}", quote=False)
                box = f'x="{left + first * cell}" y="{top + i * cell}" width="{count * cell}" height="{cell}"'
                lines.append(f'  <rect class="none" {box}><title>{words}</title></rect>')
    return lines


def _place(matrix: MassPattern, row: str, first: int, count: int) -> str:
    last = f" to {matrix.labels[first + count - 1]}" if count > 1 else ""
    return f"M[{row}, {matrix.labels[first]}{last}] = 0"


def _runs(numbers: Sequence[int]) -> list[tuple[int, int]]:
    """Runs of consecutive numbers: the first and how many."""
    result: list[tuple[int, int]] = []
    for number in numbers:
        if result and number == result[-1][0] + result[-1][1]:
            result[-1] = (result[-1][0], result[-1][1] + 1)
        else:
            result.append((number, 1))
    return result


def mass_blocks(equations: Equations, matrix: MassPattern, notation: Notation) -> tuple[Block, ...]:
    """The pattern as a picture, the matrix itself where it is small, and its zeros by reason."""
    full = len(matrix.entries) == matrix.size**2
    zeros = "" if full else "The other entries are zero in every state, for the reasons in the table below. "
    words = (
        f"{matrix.count} entries are structural non-zeros. {zeros}The matrix is symmetric, and the code stores "
        "its lower triangle."
    )
    shown = Picture(picture(matrix), f"Pattern of the mass matrix: {matrix.count} entries", "", HINT)
    expanded = not isinstance(equations, IndexedEquations)
    written = _written(equations.mass, notation) if expanded and matrix.size <= WRITTEN else ()
    return (Heading("Mass matrix", "mass"), Paragraph((words,)), shown, *written, *_zeros_of(matrix, notation))


def _written(mass: Iterable[object], notation: Notation) -> tuple[Block, ...]:
    entries = list(mass)
    size = round(len(entries) ** 0.5)
    cells: list[Formula | None] = [notation.formula(entry) if entry != 0 else None for entry in entries]
    rows = tuple(tuple(cells[i * size : (i + 1) * size]) for i in range(size))
    return (EquationBlock((Equation(Name("M", style="tensor"), (Part("+", Matrix(rows)),), number="15"),)),)


def _zeros_of(matrix: MassPattern, notation: Notation) -> tuple[Block, ...]:
    """The zeros of the lower triangle by reason."""
    gathered: dict[Reason, list[tuple[int, int]]] = {}
    for (i, j), why in sorted(matrix.reasons.items(), key=itemgetter(0)):
        if i >= j:
            gathered.setdefault(why, []).append((i, j))
    if not gathered:
        return ()
    rows: list[list[Content]] = [
        [reason(why, notation), sum(1 + (i != j) for i, j in pairs), _pairs(matrix, pairs)]
        for why, pairs in gathered.items()
    ]
    whole = table("Zeros of the mass matrix", ("reason", "zeros", "entries in the lower triangle"), rows, "lrl")
    block = folded(whole, "Zeros of the mass matrix")
    summary = f"{len(matrix.reasons)} zeros of the mass matrix, by {len(gathered)} reasons"
    return (Details(summary, (whole,)) if len(gathered) > SHOWN and isinstance(block, TableBlock) else block,)


def _pairs(matrix: MassPattern, pairs: Sequence[tuple[int, int]]) -> str:
    words = [f"{matrix.labels[i]}, {matrix.labels[j]}" for i, j in pairs]
    shown = words if len(words) <= FEW else [*words[: FEW - 2], "…", words[-1]]
    return "; ".join(shown)
