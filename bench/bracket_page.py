"""The picture docs/bracket.svg and the table in bench/README.md of `bench/bracket.py`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from bracket_run import Row

from derive.study.methods.methods_chart import BLUE, BROWN, GREEN, ORANGE, MethodPanel, logarithmic, panels_svg

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ROOT = Path(__file__).parents[1]
README, PICTURE = ROOT / "bench" / "README.md", ROOT / "docs" / "bracket.svg"
BEGIN, END = "<!-- written by bench/bracket.py -->", "<!-- end of the bracket -->"
"""The marks around the table in bench/README.md."""

KINDS = {
    "CalculiX": ("CalculiX, fewer steps", BROWN, "D"),
    "rigid:1": ("rigid", GREEN, "v"),
    "free:1": ("free modes", ORANGE, "s"),
    "craig_bampton:1": ("Craig-Bampton, first order", BLUE, "o"),
    "craig_bampton:2": ("Craig-Bampton, second order", "#8661c1", "^"),
}
"""The label, the colour and the marker of the rows whose names begin so."""


def table(found: Sequence[Row], head: bool = True) -> str:
    """The rows as a table of Markdown."""
    lines = ["| model | coordinates | error | CPU s | before, CPU s |", "| --- | ---: | ---: | ---: | ---: |"] * head
    for row in found:
        lines.append(f"| {row.name} | {row.coordinates} | {row.error:.1e} | {row.seconds:.2g} | {row.before:.2g} |")
    return "\n".join(lines)


def write(found: Sequence[Row], machine: str) -> None:
    """Write the picture, and the table into bench/README.md."""
    PICTURE.write_text(picture(found), encoding="utf-8")
    page = README.read_text(encoding="utf-8")
    before, rest = page.split(f"{BEGIN}\n")
    _, after = rest.split(END)
    README.write_text(f"{before}{BEGIN}\n\n{table(found)}\n\n{machine}\n\n{END}{after}", encoding="utf-8")


def picture(found: Sequence[Row]) -> str:
    """Errors over the number of coordinates and over CPU seconds of integration."""
    reference = next(row.error for row in reversed(found) if row.name.startswith("CalculiX"))
    floor = f"below {reference:.0e} the reference decides"
    modes = MethodPanel("Modes", floor, lambda axes: _errors(axes, found, lambda row: row.coordinates, "coordinates"))
    cost = MethodPanel(
        "Cost", "of the integration alone", lambda axes: _errors(axes, found, lambda row: row.seconds, "CPU s")
    )
    return panels_svg("A bracket that is spun up: error of its free end", (modes, cost))


def _errors(axes: Axes, found: Sequence[Row], of: Callable[[Row], float], label: str) -> None:
    *_, last = (row for row in found if row.name.startswith("CalculiX"))
    axes.axhline(last.error, color="#8a949e", linewidth=1, linestyle=":")
    for beginning, (name, colour, marker) in KINDS.items():
        rows = [row for row in found if row.name.startswith(beginning) and row is not last]
        if rows:
            x, y = [of(row) for row in rows], [row.error for row in rows]
            axes.plot(x, y, "-", color=colour, marker=marker, markersize=4, linewidth=1.2, label=name)
    axes.set_xscale("log")
    logarithmic(axes)
    axes.xaxis.set_major_formatter("{x:g}")
    low, high = axes.get_ylim()
    axes.set_ylim(low, high * (high / low) ** 0.6)
    axes.legend(loc="upper right", fontsize=7.5, labelspacing=0.15, borderaxespad=0.1)
    axes.set_xlabel(label)
    axes.set_ylabel("largest error")
