"""The parameters and tables to which functions of time may refer, read before the functions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from pathlib import Path

from derive.errors import quoted
from derive.spec.checks.scene_data import SceneData
from derive.spec.checks.scene_parameters import scene_constants
from derive.spec.files.reference_curves import curve
from derive.spec.files.splines import cubic_spline
from derive.spec.model.quantity import Parameter
from derive.spec.model.scene_functions import function_parameters, input_functions, time_functions
from derive.spec.model.specification import AnyScene
from derive.spec.model.time_function import Spline, TimeFunction, parts
from derive.spec.parsing import values
from derive.spec.parsing.faults import Fault, Faults, readable
from derive.spec.parsing.names import name_problem
from derive.spec.parsing.time_expression import FUNCTIONS, TIME, Known
from derive.spec.parsing.values import WrongValueError

MAX_ROWS = 2000
"""The largest number of rows of a table, each of which becomes four numbers of the generated code."""


def known_functions(data: Mapping[str, object], folder: Path) -> tuple[Known, Faults]:
    """The names to which functions may refer, with files relative to `folder`, and the faults of files and names."""
    faults = Faults()
    parameters, tables = (_tables(data.get(key)) for key in ("parameters", "tables"))
    names: dict[str, TimeFunction] = {}
    for constant in scene_constants(SceneData(data)):
        if isinstance(constant.value, Mapping) and isinstance(symbol := constant.value.get("symbol"), str):
            parameter = _parameter(symbol, constant.value, constant.unit or "")
            names.setdefault(symbol, TimeFunction("parameter", parameter=parameter))
    splines: dict[str, Spline] = {}
    for kind, of in (("parameters", parameters), ("tables", tables)):
        for name, table in of.items():
            with faults.at(kind, name):
                _check_name(name, {"t", "pi", *FUNCTIONS}, parameters if kind == "tables" else {})
            if kind == "tables":
                # Functions may call a table that cannot be read, whose own fault is reported.
                splines[name] = _spline(name, table, folder, faults) or Spline(
                    name, (0.0, 1.0), ((0.0, 0.0, 0.0, 0.0),)
                )
    return Known(names, splines), faults


def function_faults(scene: AnyScene, data: Mapping[str, object]) -> Iterator[Fault]:
    """Faults of parameters and tables that no function uses, and of tables that end before the simulation does."""
    functions = [*time_functions(scene), *input_functions(scene)]
    used = {p.symbol for _, function in functions for p in function_parameters(function)}
    used |= {part.spline.name for _, function in functions for part in parts(function) if part.spline}
    for kind in ("parameters", "tables"):
        for name in _tables(data.get(kind)):
            if name not in used:
                yield Fault((kind, name), "no function of time uses it; leave it out")
    end = scene.simulation.duration if scene.simulation else 0.0
    for path, function in functions:
        for part in parts(function):
            if part.spline is None or part.args[0] != TIME:
                continue
            first, last = part.spline.knots[0], part.spline.knots[-1]
            if not first <= 0.0 <= end <= last:
                text = f"the table {part.spline.name} goes from t = {first:g} to {last:g}"
                yield Fault(path, f"{text}, and the simulation from 0 to {end:g}; add rows, or simulate a shorter time")


def _tables(value: object) -> dict[str, Mapping[str, object]]:
    """The elements of a section by their names, without those that are not tables."""
    if not isinstance(value, Mapping):
        return {}
    return {name: table for name, table in value.items() if isinstance(name, str) and isinstance(table, Mapping)}


def _parameter(symbol: str, table: Mapping[str, object], unit: str) -> Parameter:
    default = readable(values.any_float, table.get("default", 1))
    return Parameter(symbol, readable(values.unit, table.get("unit")) or unit, 1.0 if default is None else default)


def _check_name(name: str, reserved: set[str], parameters: Mapping[str, object]) -> None:
    if name_problem(name):
        return  # which the check of the keys reports
    if name in reserved:
        raise WrongValueError(f"{quoted(name)} is taken: functions of time know it already; choose another name")
    if name in parameters:
        raise WrongValueError(f"{quoted(name)} is taken: it is a parameter; choose another name")


def _spline(name: str, table: Mapping[str, object], folder: Path, faults: Faults) -> Spline | None:
    file = table.get("file")
    rows = curve(table, folder, ("tables", name), faults)
    if rows is None:
        return None
    with faults.at("tables", name, "file"):
        if len(rows) > MAX_ROWS:
            raise WrongValueError(f"the file {quoted(str(file))} has {len(rows)} rows; at most {MAX_ROWS} are read")
        for (before, _), (after, _) in pairwise(rows):
            if after <= before:
                raise WrongValueError(
                    f"the arguments of the table increase from row to row, and {after:g} comes after {before:g}"
                )
        try:
            return cubic_spline(name, [x for x, _ in rows], [y for _, y in rows])
        except ArithmeticError:
            least = min(pairwise(rows), key=lambda pair: pair[1][0] - pair[0][0])
            raise WrongValueError(
                f"the cubic spline through the rows has coefficients that are no doubles; its closest arguments are "
                f"{least[0][0]:g} and {least[1][0]:g}: take rows that are further apart, or smaller values"
            ) from None
    return None
