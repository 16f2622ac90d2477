"""The output of `bench/second_order.py`: a table, docs/second_order.md, its picture, and a section of README.md."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from derive.percentages import percent
from derive.spec.model.body import DisplacementOrder
from derive.study.timing import machine_description
from derive.visual import chart_style as style

if TYPE_CHECKING:
    from second_order import Elimination, Row

ROOT = Path(__file__).parents[1]
PAGE, PICTURE = ROOT / "docs" / "second_order.md", ROOT / "docs" / "second_order.svg"
BEGIN, END, BEFORE = "<!-- written by bench/second_order.py -->", "<!-- end -->", "## Further reading"
"""The marks around the section of README.md, and the heading before which it is inserted."""

NAMES = {
    DisplacementOrder.FIRST_ORDER: "first order",
    DisplacementOrder.TRUNCATED: "second, truncated",
    DisplacementOrder.FULL: "second, full",
}
COLOURS = dict(zip(NAMES, ("#8a949e", "#1f8fbf", "#d0702a"), strict=True))
MARKERS = {"mean": "o", "chord": "s", "point": "^", "tangent": "D"}
WIDTH, HEIGHT = 8.3, 4.9  # inches

TITLE = "# Frames at second order"
TEXT = """\
This page is written by `python bench/second_order.py --write`. It answers the question of the paper with beams of
second order: which frame needs fewer terms, fewer non-zeros and less time, and which mass matrix stays definite? The
rod of the crank-slider of `scenes/crank_slider_3.toml` is one beam with three shapes, the polynomials up to the
fourth degree.

* error: of the deflection of the middle of the rod over two and a half revolutions, root mean square over the peak of
  the reference, which is itself good to 0.03 %
* nnz: structural non-zeros of **M** and of the KKT matrix, both triangles
* LDLᵀ, accel: operations of the factorisation, if no entry is known before run time, and of the generated `accel`
* ns: an evaluation of `accel`, CPU time, median of interleaved runs
* definite to: the |v|/l of a half-sine bend at which the mass matrix of the free beam becomes indefinite

Of each pair the first figure is that of the safe elimination order, the second that of the best order found."""
ORDERS = """\
## The elimination orders

The **safe** order eliminates each multiplier after all of its coordinates. No pivot vanishes in any state in which
**M** is positive definite and the constraints are independent; it is the order of generated code. The **best** order
eliminates each multiplier after one of its coordinates, with the least work that was found. Where this is not the
safe order, it is **not safe in every state**, since a pivot vanishes where the entry of the constraint Jacobian that
pairs the two does; the pivots are checked at run time. The last column counts the pivots that vanish, or change their
sign, within a revolution."""


def table(rows: Sequence[Row]) -> str:
    """The figures as a table of Markdown."""
    lines = [
        "| frame | displacement | error, rms | nnz(M) | nnz(KKT) | LDLᵀ | accel | ns | definite to | best order |",
        "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | --- |",
    ]
    for row in rows:
        a, b = row.safe, row.best
        cells = (
            *(row.frame, NAMES[row.order], percent(row.error), a.counts.mass, a.counts.kkt),
            *(f"{a.counts.flops} / {b.counts.flops}", f"{a.counts.accel} / {b.counts.accel}"),
            *(f"{1e9 * a.seconds:.0f} / {1e9 * b.seconds:.0f}", limit(row), safety(b)),
        )
        lines.append(f"| {' | '.join(map(str, cells))} |")
    return "\n".join(lines)


def limit(row: Row) -> str:
    """The |v|/l at which M becomes indefinite."""
    return "always" if np.isinf(row.definite) else f"{row.definite:.3f}"


def safety(found: Elimination) -> str:
    """Whether an order is safe in every state, and how many of its pivots vanish in those of a revolution."""
    assert not (found.safe and found.vanishing), "no pivot vanishes in the safe order"
    return "safe" if found.safe else f"not safe; {found.vanishing or 'none'} vanish here"


def picture(rows: Sequence[Row]) -> str:
    """The text of the picture: error over the time of an evaluation in the best order, joined to that in the safe."""
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(style.SETTINGS)
        figure = Figure(figsize=(WIDTH, HEIGHT))
        left, head, foot = 0.82, 1.12, 0.55
        axes = figure.add_axes((left / WIDTH, foot / HEIGHT, 1 - (left + 0.2) / WIDTH, 1 - (head + foot) / HEIGHT))
        for row in rows:
            best, safe = 1e9 * row.best.seconds, 1e9 * row.safe.seconds
            marks: Any = {"color": COLOURS[row.order], "marker": MARKERS[row.frame], "markersize": 8}
            axes.plot([best, safe], [100 * row.error] * 2, color=COLOURS[row.order], linewidth=1.2)
            axes.plot([best], [100 * row.error], alpha=0.8, linestyle="none", **marks)
            axes.plot([safe], [100 * row.error], linestyle="none", fillstyle="none", **marks)
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.xaxis.set_major_formatter("{x:g}")
        axes.xaxis.set_minor_formatter("{x:g}")
        axes.yaxis.set_major_formatter("{x:g}")
        axes.axhline(0.03, color=style.REFERENCE, linewidth=2, alpha=0.55)
        axes.text(1, 0.031, "error of the reference", ha="right", va="bottom", transform=axes.get_yaxis_transform())
        axes.set_xlabel(
            "time of an evaluation of the accelerations, ns; filled: best elimination order, hollow: safe order"
        )
        axes.set_ylabel("error of the deflection, rms, %")
        axes.tick_params(length=3)
        title = "One beam as the rod of the crank-slider: error and time by frame and order"
        figure.text(left / WIDTH, 1 - 0.1 / HEIGHT, title, va="top", fontweight="bold", fontsize=11)
        _legend(figure, left / WIDTH)
        return style.figure_svg(
            figure, "; ".join([title, *(f"{r.frame}, {NAMES[r.order]}: {percent(r.error)}" for r in rows)])
        )


def _legend(figure: Figure, left: float) -> None:
    """Frames by markers, displacements by colours."""
    from matplotlib.lines import Line2D

    frames = [
        Line2D([], [], color=style.INK, marker=m, linestyle="none", label=f"{f} frame") for f, m in MARKERS.items()
    ]
    orders = [Line2D([], [], color=COLOURS[order], linewidth=5, label=name) for order, name in NAMES.items()]
    for n, handles in enumerate((frames, orders)):
        figure.legend(
            handles=handles,
            loc="upper left",
            bbox_to_anchor=(left, 1 - (0.42 + 0.25 * n) / HEIGHT),
            ncols=4,
            borderaxespad=0,
            borderpad=0,
        )


def section(rows: Sequence[Row]) -> str:
    """The section of README.md: a small table of first / truncated / full, and the picture."""
    text = (
        "One beam as the rod of the crank-slider, with three shapes: first order / truncated / full, each in its best "
        "elimination order. The default order is safe in every state. More in "
        "[docs/second_order.md](docs/second_order.md)."
    )
    lines = [
        f"{BEGIN}\n## Frames at second order\n",
        f"{textwrap.fill(text, 118)}\n",
        "| frame | error, % | nnz(M) | accel, ns | definite to \\|v\\|/l |",
        "|---|---|---|---|---|",
    ]
    for frame, group in groupby(rows, lambda row: row.frame):
        models = list(group)
        cells = (
            "/".join(percent(row.error).removesuffix(" %") for row in models),
            "/".join(str(row.best.counts.mass) for row in models),
            "/".join(f"{1e9 * row.best.seconds:.0f}" for row in models),
            "/".join(map(limit, models)),
        )
        lines.append(f"| {frame} | {' | '.join(cells)} |")
    return "\n".join([*lines, "\n![Error and time of each frame](docs/second_order.svg)", f"{END}\n"])


def page(rows: Sequence[Row]) -> str:
    """The text of docs/second_order.md."""
    machine = "; ".join(machine_description().values())
    return "\n\n".join([TITLE, TEXT, table(rows), f"({machine})", f"![Error and time]({PICTURE.name})", f"{ORDERS}\n"])


def with_section(text: str, new: str) -> str:
    """A page whose section between the marks is replaced, or inserted before the heading BEFORE."""
    if BEGIN in text:
        head, rest = text.split(BEGIN, 1)
        return head + new + rest.split(f"{END}\n", 1)[1]
    head, rest = text.split(BEFORE, 1)
    return f"{head}{new}\n{BEFORE}{rest}"


def write(rows: Sequence[Row]) -> None:
    """Write the page, the picture and the section."""
    readme = ROOT / "README.md"
    texts = {PAGE: page(rows), PICTURE: picture(rows), readme: with_section(readme.read_text(), section(rows))}
    for path, text in texts.items():
        path.write_text(text)
        print(f"wrote {path.relative_to(ROOT)}")
