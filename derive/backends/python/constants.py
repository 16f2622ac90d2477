"""The constants of a generated Python module: names, units, defaults, arrays, classes of markers and splines."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from derive.backends.wrapping import WIDTH, prefixed
from derive.ir.kernel import ConstantArray
from derive.ir.model import MarkerClass, Model, Variable
from derive.ir.series import variable_series
from derive.rendering import render


@dataclass(frozen=True)
class TupleConstant:
    """A tuple of the generated module."""

    name: str
    items: str


def constant_array(array: ConstantArray) -> tuple[str, str]:
    """The name of a constant array, and its values as a tuple."""
    return array.name, _lines([repr(int(x) if array.integers else float(x)) for x in array.values])


def tables(model: Model) -> list[TupleConstant]:
    """Names, units and defaults, as tuples of literals."""

    def table(name: str, items: Iterable[object]) -> TupleConstant:
        literals = [f'"{item}"' if isinstance(item, str) else repr(item) for item in items]
        return TupleConstant(name, _lines(literals))

    def names(name: str, variables: tuple[Variable, ...]) -> TupleConstant:
        if model.lowering == "instances":
            return TupleConstant(name, _composed(variables))
        return table(name, (column for v in variables for column in v.columns))

    bodies = tuple(Variable(name, "", "", shown=name) for name in model.bodies)
    return [
        names("COORDINATES", model.coordinates),
        names("VELOCITIES", model.velocities),
        table("PARAMETERS", (v.name for v in model.parameters)),
        table("SIZES", (v.size for v in model.parameters)),
        table("UNITS", (v.unit for v in model.parameters)),
        table("CONSTANTS", (v.name for v in model.constants)),
        table("MARKERS", (v.title for v in model.markers)),
        *((names("MULTIPLIERS", model.multipliers), names("BODIES", bodies)) if model.is_scene else ()),
    ]


def _composed(variables: tuple[Variable, ...]) -> str:
    """The call that composes the names of variables."""
    parts = []
    for series in variable_series(variables):
        labels = _lines([f'"{label.name}"' for label in series.labels])
        parts.append(f'("{series.table}", {series.first}, {series.count}, {labels})')
    return "\n".join(["_names(", *(f"    {part}," for part in parts), ")"])


def marker_class(of: MarkerClass) -> str:
    """A class of markers, with what its functions need."""
    columns = "\n".join(f"    {line}" for line in _lines([str(k) for k in of.columns]).splitlines()).strip()
    names = "\n".join(f"    {line}" for line in _composed(of.markers).splitlines()).strip()
    parts = [f'"{of.name}"', names, columns, f"MARKER_{of.name.upper()}"]
    return "\n".join([f"{of.name.upper()}_MARKERS = MarkerClass(", *(f"    {part}," for part in parts), ")"])


def defaults(model: Model) -> str:
    """The defaults of p: all of them, or, where most are zero, a dict of those that are not."""
    values = model.defaults
    kept = [(k, x) for k, x in enumerate(values) if x]
    if 2 * len(kept) > len(values) or len(kept) < 9:
        return f"DEFAULTS = {_lines([repr(x) for x in values])}"
    entries = "\n".join(prefixed([", ".join(f"{k}: {x!r}" for k, x in kept)], "    "))
    return f"_VALUES = {{\n{entries},\n}}\nDEFAULTS = tuple(_VALUES.get(k, 0.0) for k in range({len(values)}))"


def _lines(literals: list[str]) -> str:
    """A tuple, on several lines if it is long; literals are not broken."""
    if len(tuple_text(literals)) < WIDTH - 20:
        return tuple_text(literals)
    lines = [""]
    for literal in literals:
        if len(lines[-1]) + len(literal) > WIDTH - 8:
            lines.append("")
        lines[-1] += f" {literal},"
    return "\n".join(["(", *(f"   {line}" for line in lines), ")"])


def tuple_text(items: list[str]) -> str:
    """A tuple in one line."""
    return f"({items[0]},)" if len(items) == 1 else f"({', '.join(items)})"


def splines(model: Model) -> str:
    """The function that evaluates splines, and those of their tables; nothing if there is none."""
    return (
        f"\n{render('python/spline.py.jinja', {'numbers': True}).rstrip()}\n\n{spline_functions(model)}"
        if model.splines
        else ""
    )


def spline_functions(model: Model) -> str:
    """The tables of splines, and a function for each, which kernels call; it calls `_spline`."""
    blocks = []
    for spline in model.splines:
        knots = _lines([repr(x) for x in spline.knots])
        rows = _lines([tuple_text([repr(c) for c in row]) for row in spline.coefficients])
        blocks.append(f"{spline.name.upper()}_KNOTS = {knots}\n{spline.name.upper()}_COEFFICIENTS = {rows}")
        names = f"{spline.name.upper()}_KNOTS, {spline.name.upper()}_COEFFICIENTS"
        blocks.append(f"\ndef {spline.name}(xp, x, order):\n    return _spline(xp, {names}, x, order)")
    return "\n\n".join(blocks)
