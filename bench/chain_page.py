"""The output of `bench/chains.py`: tables, docs/chains.svg, and a section of bench/README.md."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from chain_run import ANY_GRAPH, BOTH_ENDS, CASADI, FLAT, INSTANCES, LANES, Figures, Run, read_run, write_run

from derive.study.methods.methods_chart import BLUE, BROWN, GREEN, ORANGE, PURPLE, MethodPanel, logarithmic, panels_svg

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ROOT = Path(__file__).parents[1]
README, FIGURES, PICTURE = ROOT / "bench" / "README.md", ROOT / "bench" / "chains.json", ROOT / "docs" / "chains.svg"
BEGIN, END = "<!-- written by bench/chains.py -->", "<!-- end -->"
"""The marks around the tables in bench/README.md."""

NAMES = {FLAT: "straight line", INSTANCES: "instances", CASADI: "CasADi"}
COLOURS = {FLAT: ORANGE, INSTANCES: BLUE, CASADI: PURPLE, BOTH_ENDS: GREEN, LANES: GREEN, ANY_GRAPH: BROWN}
MARKERS = {FLAT: "s", INSTANCES: "o", CASADI: "^"}

COSTS = "| beams | form | generation, s | gcc, s | MB | kB of C | without tables | kB of header |"
TIMES = (
    "| beams | straight line | instances | CasADi | both ends | lanes | any graph | ratio "
    "| batch: straight line | instances | by hand | ratio |"
)


def tables(figures: Sequence[Figures]) -> str:
    """The costs of all forms, and the times of all forms and of C by hand, as tables of Markdown."""
    return f"{_costs(figures)}\n\n{_times(figures)}"


def _costs(figures: Sequence[Figures]) -> str:
    lines = [COSTS, "| ---: | --- |" + " ---: |" * 6]
    for f in figures:
        if f.form not in NAMES or not f.size:
            continue
        sizes = (f.size, f.size - f.tables, f.header)
        kilobytes = (f"{size / 1000:.3g}" if size < 1e6 else f"{size / 1000:,.0f}".replace(",", " ") for size in sizes)
        cells = (str(f.count), NAMES[f.form], f"{f.generation:.2f}", _digits(f.compiler), _digits(f.megabytes))
        lines.append(f"| {' | '.join((*cells, *kilobytes))} |")
    return "\n".join(lines)


def _times(figures: Sequence[Figures]) -> str:
    ns = {(f.count, f.form): f.ns for f in figures if f.ns}
    batch = {(f.count, f.form): f.batch_ns for f in figures if f.batch_ns}
    lines = [TIMES, "|" + " ---: |" * 12]
    for count in dict.fromkeys(f.count for f in figures):
        best, best_batch = (
            min((t for (n, form), t in of.items() if n == count and form not in NAMES), default=None)
            for of in (ns, batch)
        )
        cells = (
            *(_digits(ns.get((count, form))) for form in (FLAT, INSTANCES, CASADI, BOTH_ENDS, LANES, ANY_GRAPH)),
            _ratio(ns.get((count, INSTANCES)), best),
            *(_digits(batch.get((count, form))) for form in (FLAT, INSTANCES)),
            _digits(best_batch),
            _ratio(batch.get((count, INSTANCES)), best_batch),
        )
        lines.append(f"| {count} | {' | '.join(cells)} |")
    return "\n".join(lines)


def _digits(value: float | None) -> str:
    """A number of three digits; empty if there is none."""
    if value is None:
        return ""
    return f"{value:.0f}" if value >= 100 else f"{value:.1f}" if value >= 10 else f"{value:.2f}"


def _ratio(ours: float | None, other: float | None) -> str:
    return "" if ours is None or other is None else f"{ours / other:.2f}"


def picture(figures: Sequence[Figures]) -> str:
    """The text of the picture. The same numbers give the same bytes."""
    panels = (
        MethodPanel("Generation", "CPU seconds from the specification to C", lambda a: _generation(a, figures)),
        MethodPanel("Compilation", "CPU seconds of gcc; CasADi: one function", lambda a: _compilation(a, figures)),
        MethodPanel("Text", "kB of C; dashed: without tables; CasADi: one function", lambda a: _text(a, figures)),
        MethodPanel("Accelerations", "ns per body; dashed: in a batch of 8 states", lambda a: _speed(a, figures)),
    )
    return panels_svg("Chains of flexible beams: straight line and loops over instances", panels)


def _generation(axes: Axes, figures: Sequence[Figures]) -> None:
    for form in NAMES:
        _curve(axes, figures, form, lambda f: f.generation)
    _finished(axes)


def _compilation(axes: Axes, figures: Sequence[Figures]) -> None:
    for form in NAMES:
        _curve(axes, figures, form, lambda f: f.compiler)
    _finished(axes)


def _text(axes: Axes, figures: Sequence[Figures]) -> None:
    for form in NAMES:
        _curve(axes, figures, form, lambda f: f.size / 1000)
    for form in (FLAT, INSTANCES):
        _curve(axes, figures, form, lambda f: (f.size - f.tables) / 1000, dashed=True)
    _finished(axes)


def _speed(axes: Axes, figures: Sequence[Figures]) -> None:
    for form in NAMES:
        _curve(axes, figures, form, lambda f: f.ns)
    by_hand = {"C by hand, chain": (BOTH_ENDS, LANES), "C by hand, any graph": (ANY_GRAPH,)}
    for name, forms in by_hand.items():
        _least(axes, figures, forms, lambda f: f.ns, name, COLOURS[forms[0]])
    for form in (FLAT, INSTANCES):
        _curve(axes, figures, form, lambda f: f.batch_ns, dashed=True)
    others = tuple({f.form for f in figures} - set(NAMES))
    _least(axes, figures, others, lambda f: f.batch_ns, "", COLOURS[BOTH_ENDS], dashed=True)
    _finished(axes)


def _curve(
    axes: Axes, figures: Sequence[Figures], form: str, of: Callable[[Figures], float | None], dashed: bool = False
) -> None:
    """The line of a form, with a label unless it is dashed."""
    _least(axes, figures, (form,), of, "" if dashed else NAMES[form], COLOURS[form], dashed, MARKERS[form])


def _least(
    axes: Axes,
    figures: Sequence[Figures],
    forms: Sequence[str],
    of: Callable[[Figures], float | None],
    name: str,
    colour: str,
    dashed: bool = False,
    marker: str = "D",
) -> None:
    """The line of the least value of some forms at each number of beams."""
    values: dict[int, float] = {}
    for f in figures:
        value = of(f) if f.form in forms else None
        if value:
            values[f.count] = min(value, values.get(f.count, value))
    style = "--" if dashed else "-"
    label = name if values and name else None
    axes.plot(
        list(values),
        list(values.values()),
        style,
        color=colour,
        marker=marker,
        markersize=3.5,
        linewidth=1.4,
        label=label,
    )


def _finished(axes: Axes) -> None:
    """Both axes logarithmic, and the curves named above them."""
    from matplotlib.ticker import LogLocator

    axes.set_xscale("log")
    logarithmic(axes)
    axes.xaxis.set_major_formatter("{x:g}")
    low, high = axes.get_ylim()
    if high < 200 * low:
        axes.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axes.yaxis.set_major_formatter("{x:g}")
    axes.set_ylim(low, high * (high / low) ** 0.42)
    axes.legend(loc="upper left", fontsize=7.5, labelspacing=0.15, borderaxespad=0.1)
    axes.set_xlabel("beams")


def with_tables(text: str, run: Run) -> str:
    """A page whose text between the marks is replaced."""
    head, rest = text.split(BEGIN, 1)
    machine = "\n".join(f"    {line}" for line in run.machine)
    return f"{head}{BEGIN}\n\n{machine}\n\n{tables(run.figures)}\n\n{END}{rest.split(END, 1)[1]}"


def write(run: Run) -> None:
    """Write the figures, the picture and the tables."""
    write_run(run, FIGURES)
    run = read_run(FIGURES)  # rounded, so that the tables follow from the file
    PICTURE.write_text(picture(run.figures))
    README.write_text(with_tables(README.read_text(), run))
    for path in (FIGURES, PICTURE, README):
        print(f"wrote {path.relative_to(ROOT)}")
