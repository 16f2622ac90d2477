"""The HTML of motions: a trajectory with its charts and its player; initial states and equilibria."""

from __future__ import annotations

from collections.abc import Iterator

from derive.notebook.parts import Writers, folded, head, joined, lines, number, paragraph, picture, player, table
from derive.simulation.equilibrium import Equilibrium
from derive.simulation.initial.initial_state import InitialState
from derive.simulation.observables.csv_writer import Column
from derive.simulation.observables.plots import plot_curves, plot_text
from derive.simulation.trajectory import Trajectory
from derive.spec.model.plots import Deflection, Plot
from derive.visual.line_chart import Chart, Curve, Panel, svg
from derive.visual.motion_page import motion_page
from derive.visual.plot_chart import plot_chart

MOST_PANELS, MOST_CURVES = 3, 4
"""The most panels, one for each unit, and the most curves of a panel, of the chart of a motion without plots."""


def trajectory_html(motion: Trajectory) -> str:
    """A motion: its charts, its player, and the range of each column.

    The charts are the plots of the specification, or else outputs and coordinates over time.
    """
    rows = len(motion.t)
    span = f"{rows} rows from {motion.t[0]:g} to {motion.t[-1]:g} s, {len(motion.columns)} columns"
    columns = [
        (column.name, column.unit, number(column.values.min() + 0.0), number(column.values.max() + 0.0))
        for column in motion.table
    ]
    charts = list(_charts(motion))
    return joined(
        head(motion.name, span),
        lines(f"warning: {text}" for text in motion.warnings),
        lines(motion.notes),
        "".join(charts),
        _player(motion) if rows > 1 else "",
        folded("Columns", table(("column", "unit", "least", "largest"), columns, left=2, most=len(columns))),
    )


def _player(motion: Trajectory) -> str:
    """The player of a motion, with a note if it shows some instants alone."""
    curves, rows = list(_curves(motion)), len(motion.t)
    page = motion_page(motion, curves, ())
    note = f"The player shows {page.instants} of the {rows} instants; the columns have all of them."
    shown = player(page.text, f"The motion of {motion.name}", len(curves))
    return shown + (paragraph(note) if page.instants < rows else "")


def _curves(motion: Trajectory) -> Iterator[Column]:
    """The curves of the plots of the specification, which the player draws over time."""
    for plot in motion.scene.plots:
        text = plot_text(plot, motion.scene, motion.units)
        for curve in plot_curves(plot, motion, ""):
            yield Column(curve.label or text.doc, curve.unit, curve.y)


def _charts(motion: Trajectory) -> Iterator[str]:
    """The plots of the specification, or a chart of outputs and coordinates."""
    if len(motion.t) < 2:
        return
    for plot in motion.scene.plots:
        text = plot_text(plot, motion.scene, motion.units)
        chart = plot_chart(motion.name, plot, text, plot_curves(plot, motion, _label(plot)))
        yield picture(svg(chart), chart.title)
    if not motion.scene.plots and (own := _chart(motion)):
        yield picture(svg(own), own.title)


def _label(plot: Plot) -> str:
    """The label of the curves of a plot: the marker of a deflection; those of columns have their names."""
    return str(plot.quantity.marker) if isinstance(plot.quantity, Deflection) else ""


def _chart(motion: Trajectory) -> Chart | None:
    """The outputs over time, or the coordinates of a scene without outputs: a panel for each unit."""
    outputs = {name for output in motion.model.outputs for name in output.columns}
    coordinates = {name for variable in motion.model.coordinates for name in variable.columns}
    shown = [column for column in motion.table if column.name in (outputs or coordinates)]
    units = list(dict.fromkeys(column.unit for column in shown))[:MOST_PANELS]
    panels = []
    for unit in units:
        some = [column for column in shown if column.unit == unit][:MOST_CURVES]
        curves = tuple(Curve(column.name, motion.t, column.values) for column in some)
        panels.append(Panel(", ".join(column.name for column in some), unit, curves))
    what = "outputs" if outputs else "coordinates"
    return Chart(f"{motion.name}: {what}", "time", "s", tuple(panels)) if panels else None


def initial_state_html(state: InitialState) -> str:
    """An initial state: how well it meets its constraints, its given values, and its notes."""
    kind = "static equilibrium" if state.equilibrium else "steady motion" if state.steady else "consistent state"
    errors = f"|g| is at most {state.position_error:.1e}, |gdot| at most {state.velocity_error:.1e}"
    values = [(v.name, v.unit, number(v.specified), number(v.value)) for v in state.values]
    return joined(
        head(f"Initial state at t = {state.t:g} s", f"{kind}; {errors}"),
        table(("given value", "unit", "given", "in the state"), values, left=2),
        lines(state.notes),
        folded("Vectors", table(("element", "q", "v"), _vectors(state))),
    )


def _vectors(state: InitialState) -> list[tuple[str, str, str]]:
    size = max(len(state.q), len(state.v))
    q, v = ([number(x) for x in of] + [""] * (size - len(of)) for of in (state.q, state.v))
    return [(str(i), a, b) for i, (a, b) in enumerate(zip(q, v, strict=True))]


def equilibrium_html(balance: Equilibrium) -> str:
    """An equilibrium: its residual, its stability, and its coordinates and multipliers."""
    q = [(f"q[{i}]", number(value)) for i, value in enumerate(balance.q)]
    multipliers = [(f"lambda[{i}]", number(value)) for i, value in enumerate(balance.lam)]
    return joined(
        head(f"Equilibrium at t = {balance.t:g} s", str(balance)),
        table(("element", "value"), [*q, *multipliers]),
    )


WRITERS: Writers = {
    Trajectory: trajectory_html,
    InitialState: initial_state_html,
    Equilibrium: equilibrium_html,
}
