"""Tables of values in C: the knots and coefficients of their splines as constant data, and a binary search."""

from __future__ import annotations

from derive.backends.wrapping import prefixed
from derive.ir.model import Model
from derive.rendering import render
from derive.spec.model.time_function import Spline


def spline_lines(model: Model) -> list[str]:
    """The function that evaluates splines, and one for each table, which kernels call; nothing if there is none."""
    if not model.splines:
        return []
    lines = render("c/spline.c.jinja", {"name": f"{model.name}_spline"}).rstrip().split("\n")
    return [*lines, *(line for spline in model.splines for line in _function(f"{model.name}_spline", spline))]


def _function(helper: str, spline: Spline) -> list[str]:
    n = len(spline.knots)
    rows = [", ".join(map(repr, row)) for row in spline.coefficients]
    return [
        "",
        f"static double {spline.name}(double x, int order)",
        "{",
        f"    static const double knots[{n}] = {{",
        *prefixed([", ".join(map(repr, spline.knots))], "        "),
        "    };",
        f"    static const double coefficients[{(spline.degree + 1) * (n - 1)}] = {{",
        *(
            line
            for k, row in enumerate(rows, 1)
            for line in prefixed([f"{row}{',' if k < len(rows) else ''}"], "        ")
        ),
        "    };",
        f"    return {helper}({n}, {spline.degree}, knots, coefficients, x, order);",
        "}",
    ]
