"""The output of `bench/second_order.py`: a table, docs/second_order.md, and its picture."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from derive.percentages import percent
from derive.spec.model.body import DisplacementOrder
from derive.study.timing import machine_description
from derive.study.variants import OperationCounts
from derive.visual import chart_style as style

if TYPE_CHECKING:
    from second_order import Elimination, Row

ROOT = Path(__file__).parents[1]
PAGE, PICTURE = ROOT / "docs" / "second_order.md", ROOT / "docs" / "second_order.svg"
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
Which floating frame is best for a beam of second order? This page compares four frames: which needs fewer non-zeros and
less time, and which mass matrix stays positive definite?

**In short.** At second order the mean frame has the fewest non-zeros and the fastest equations. With truncated terms
its mass matrix stays definite up to the largest deflections. The tangent frame is the worst choice here. Second order
reduces the error from 12 % to less than 0.1 % in the other three frames.

The test case is the rod of the crank-slider of `scenes/crank_slider_3.toml` as one beam with three shapes, the
polynomials up to the fourth degree. `python bench/second_order.py --write` writes this page.

## Accuracy and validity

* **error**: of the deflection of the middle of the rod in two and a half revolutions; root mean square, relative to the
  peak. The error of the reference itself is 0.03 %.
* **definite to**: the deflection |v|/l, in half a sine wave, at which the mass matrix of the free beam becomes
  indefinite. "Always" means at no deflection."""
COST_TEXT = """\
## Cost

* **nnz**: structural non-zeros of **M** and of the KKT matrix, both triangles
* **LDLᵀ**: operations of the factorisation, if no entry is known before run time
* **accel**: operations of the generated function `accel`
* **ns**: nanoseconds of an evaluation of `accel`, CPU time, median of interleaved runs

"Safe" and "best" are the elimination orders that are explained below."""
ORDERS = """\
## The elimination orders

The **safe** order eliminates each multiplier after all of its coordinates. No pivot vanishes in any state in which
**M** is positive definite and the constraints are independent; it is the order of generated code. The **best** order
eliminates each multiplier after one of its coordinates, with the least work that was found. Where this is not the
safe order, it is **not safe in every state**: a pivot vanishes with the entry of the constraint Jacobian that pairs the
two. The pivots are checked at run time. The last column states how many pivots vanish, or change their sign, within a
revolution."""


def accuracy_table(rows: Sequence[Row]) -> str:
    """The errors, and the deflections up to which M is definite, as a table of Markdown."""
    lines = ["| frame | displacement | error, rms | definite to |", "| --- | --- | ---: | ---: |"]
    lines += [f"| {row.frame} | {NAMES[row.order]} | {percent(row.error)} | {limit(row)} |" for row in rows]
    return "\n".join(lines)


def cost_table(rows: Sequence[Row]) -> str:
    """The non-zeros, operations and times as a table of Markdown."""
    head = ("frame", "displacement", "nnz(M)", "nnz(KKT)", "LDLᵀ, safe", "LDLᵀ, best", "accel, safe", "accel, best")
    head += ("ns, safe", "ns, best", "best order")
    lines = [f"| {' | '.join(head)} |", f"| --- | --- |{' ---: |' * 8} --- |"]
    for row in rows:
        a, b = row.safe, row.best
        times = f"{1e9 * a.seconds:.0f} | {1e9 * b.seconds:.0f}"
        lines.append(f"{counts_text(row.frame, row.order, a.counts, b.counts)} {times} | {safety(b)} |")
    return "\n".join(lines)


def counts_text(frame: str, order: DisplacementOrder, safe: OperationCounts, best: OperationCounts) -> str:
    """The beginning of a row of this table, up to the times."""
    counts = (safe.mass, safe.kkt, safe.flops, best.flops, safe.accel, best.accel)
    return f"| {' | '.join(map(str, (frame, NAMES[order], *counts)))} |"


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


def page(rows: Sequence[Row]) -> str:
    """The text of docs/second_order.md."""
    machine = "; ".join(machine_description().values())
    parts = (TITLE, TEXT, accuracy_table(rows), f"![Error and time]({PICTURE.name})", COST_TEXT, cost_table(rows))
    return "\n\n".join([*parts, f"({machine})", f"{ORDERS}\n"])


def write(rows: Sequence[Row]) -> None:
    """Write the page and the picture."""
    for path, text in {PAGE: page(rows), PICTURE: picture(rows)}.items():
        path.write_text(text)
        print(f"wrote {path.relative_to(ROOT)}")
