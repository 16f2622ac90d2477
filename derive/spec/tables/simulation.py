"""The tables of the settings of a simulation and of its plots."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from derive.spec.model.documentation import purpose
from derive.spec.model.keys import declared_keys
from derive.spec.model.plots import ColumnCurves, Deflection, Plot, ReferenceCurve
from derive.spec.model.simulation import Simulation
from derive.spec.parsing.values import WrongValueError
from derive.spec.tables.declared_tables import DeclaredTable, declare
from derive.spec.tables.shared import TomlTable, one_of

MAX_STEPS = 10**7


def _check_simulation(simulation: Simulation) -> None:
    """Refuse an unreasonable number of output rows."""
    if simulation.duration < simulation.output:
        raise WrongValueError("`output`, the time between rows, is longer than `duration`; make it shorter")
    if simulation.duration > MAX_STEPS * simulation.output:
        raise WrongValueError(
            f"the output would have more than {MAX_STEPS} rows; make `duration` shorter or `output` longer"
        )


def _check_plot(plot: Plot) -> None:
    """Require `cut` and `pieces` together, and refuse a reference for several curves."""
    if (plot.cut is None) != (not plot.pieces):
        raise WrongValueError('`cut` and `pieces` go together: write cut = "rod" and pieces = [1, 2, 3]')
    if plot.reference is not None and isinstance(plot.quantity, ColumnCurves) and len(plot.quantity.y) > 1:
        raise WrongValueError("a reference is compared with one column, and `y` has several; leave one")


SIMULATION = declare(Simulation, "SimulationTable", check=_check_simulation)
declare(ReferenceCurve, "ReferenceTable")


def _plot_table(title: str, quantity: type, shared: tuple[str, ...], further: tuple[str, ...] = ()) -> DeclaredTable:
    """The table of a plot of some quantity, whose keys are between those that plots share and further ones."""
    keys = {key.name: key for key in declared_keys(Plot)}
    of_quantity = declared_keys(quantity)

    def made(name: str, **given: Any) -> Plot:
        shown = quantity(**{key.field: given.pop(key.field) for key in of_quantity if key.field in given})
        return Plot(name, shown, **given)

    every = (*(keys[name] for name in shared), *of_quantity, *(keys[name] for name in further))
    return declare(Plot, title, keys=every, make=made, check=_check_plot, doc=purpose(quantity))


SHARED = ("cut", "pieces", "reference")
OF_DEFLECTIONS = {key.name for key in declared_keys(Deflection)} | {"over"}
"""The keys that plots of columns do not have."""
MARKER_PLOT = _plot_table("PlotTable", Deflection, SHARED, ("over",))
COLUMN_PLOT = _plot_table("ColumnPlotTable", ColumnCurves, SHARED)


def kind_of_plot(value: Any) -> str:
    """The kind of plot that a table describes: a discriminator. One with no key of either kind is of columns."""
    of_columns = not isinstance(value, Mapping) or "y" in value or "x" in value
    return "columns" if of_columns or OF_DEFLECTIONS.isdisjoint(value) else "deflection"


PLOT = DeclaredTable(TomlTable, one_of(kind_of_plot, deflection=MARKER_PLOT.value, columns=COLUMN_PLOT.value))
