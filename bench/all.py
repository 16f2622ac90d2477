"""Every row of speed with its ratios, from the benchmarks of this folder, so that a regression can be seen.

python bench/all.py [--json] [--only MODULE ...] [--quick]

A row says how long our code takes, how long the best of the peers, and code written by hand where there is such code,
and whether the goal is reached; `rows.py` says what its figures are. Each ratio is measured in one run, in which the
variants take turns. Without --json a table is printed. --quick measures with few repetitions and small sizes, to see
that all runs; its figures mean nothing. A benchmark that fails is a row with an error, and the exit code is 1.
"""

from __future__ import annotations

import argparse
import json
import sys
import traceback
from collections.abc import Sequence
from contextlib import redirect_stdout
from importlib import import_module
from importlib.util import find_spec
from typing import Any

from machine import described, native_flags
from rows import Row, is_met

from derive.runtime.compiler import FLAGS

MODULES: dict[str, dict[str, Any]] = {
    "batch": {"quick": True},
    "beam_accelerations": {"quick": True},
    "constant_elimination": {"quick": True},
    "loops_by_hand": {"quick": True},
    "python_calls": {"quick": True},
    "space_mechanisms": {"quick": True},
    "tool_speed": {"quick": True},
}
"""The benchmarks that have a function `rows`, in the order of the table; with what arguments it is quick."""
PACKAGES = ("casadi", "sympy", "numpy", "scipy", "numba", "pydantic", "jinja2")


def rows_of(module: str, quick: bool) -> list[Row]:
    """The rows of a benchmark, whose messages go to the standard error. A failure is a row with an error."""
    try:
        with redirect_stdout(sys.stderr):
            result: list[Row] = import_module(module).rows(**(MODULES[module] if quick else {}))
    except Exception as error:  # one that fails must not cost the figures of the others
        traceback.print_exc()
        result = [{"name": module, "error": f"{type(error).__name__}: {error}"}]
    return [{"module": module, "unit": "ns", **row, "met": is_met(row)} for row in result]


def environment() -> dict[str, Any]:
    """The machine, the compiler, the flags and the versions that the figures depend on."""
    installed = [package for package in PACKAGES if find_spec(package)]
    head = dict(line.split(maxsplit=1) for line in described(*installed))
    return {
        **head,
        "flags": {"derive.load": " ".join(FLAGS), "native": " ".join(native_flags())},
        "not_installed": [package for package in PACKAGES if package not in installed],
    }


def table(rows: Sequence[Row]) -> str:
    """The rows as lines of text."""
    lines = [f"{'row':62}{'ours':>10}{'by hand':>10}{'peer':>10}  {'best peer':26}{'ratio':>7}{'goal':>7}  met"]
    module = ""
    for row in rows:
        if row["module"] != module:
            module = row["module"]
            lines.append(module)
        if "error" in row:
            lines.append(f"  {row['name']:60}  {row['error']}")
            continue
        times = "".join(f"{_figure(row.get(key)):>10}" for key in ("ours_ns", "hand_ns", "peer_ns"))
        met = {True: "yes", False: "NO", None: ""}[row["met"]]
        name = row["name"] if row["unit"] == "1" else f"{row['name']}, {row['unit']}"
        ratio, goal = _figure(row.get("ratio")), _figure(row.get("goal"))
        lines.append(f"  {name:60}{times}  {row.get('peer_name') or '':26}{ratio:>7}{goal:>7}  {met}")
        if row.get("note"):
            lines.append(f"      {row['note']}")
    return "\n".join(lines)


def _figure(value: float | None) -> str:
    """A number with three digits."""
    if value is None:
        return ""
    return f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"


def main(argv: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", action="store_true", help="print all figures as JSON")
    names = ", ".join(MODULES)
    parser.add_argument("--only", nargs="+", choices=MODULES, default=list(MODULES), metavar="MODULE", help=names)
    parser.add_argument("--quick", action="store_true", help="few repetitions and small sizes")
    options = parser.parse_args(argv)
    rows = [row for module in options.only for row in rows_of(module, options.quick)]
    known = environment()
    if options.json:
        print(json.dumps({**known, "quick": options.quick, "rows": rows}, indent=2))
    else:
        head = [f"{name:10}{value}" for name, value in known.items() if isinstance(value, str)]
        print("\n".join([*head, *(f"flags     {name}: {value}" for name, value in known["flags"].items()), ""]))
        print(table(rows))
    return 1 if any("error" in row for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
