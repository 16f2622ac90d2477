"""The cost of second order: operations and time of a free beam of order 2 against order 1, in all frames.

python bench/order_cost.py [--shapes 1 2 3 4 5 6] [--frames mean chord point tangent] [--runs 3] [--json]

Operations are those of the generated functions `mass_force` (M and h) and `accel`, in which a sine counts as one; what
depends on parameters alone is in `setup` and is not counted. nnz: structural non-zeros of M, both triangles. k: numbers
that `setup` computes. ns: an evaluation of `accel`, the median of all repeats of interleaved runs.

All frames have the polynomials up to the same degree. Shapes in the frame `given` cost what the frame costs whose
conditions they fulfil. Amplitudes are so small that no truncated mass matrix is indefinite.
"""

from __future__ import annotations

import argparse
import json
import re
import shlex
import tempfile
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from statistics import median
from typing import Any

from harness import Inputs, Variant, nanoseconds, program
from machine import described, native_flags
from problem import Problem, problem

import derive

FRAMES: dict[str, Any] = {
    "mean": "mean",
    "chord": "chord",
    "point": "point",
    "tangent": {"kind": "tangent", "at": -1},
}
ORDERS: dict[str, dict[str, Any]] = {
    "first": {},
    "truncated": {"order": 2, "terms": "truncated"},
    "full": {"order": 2, "terms": "full"},
}
SMALL = 1e-4
"""The factor of the amplitudes of a problem, which are at most 0.2 of 1 m."""


@dataclass(frozen=True)
class Cost:
    """The cost of one beam; nanoseconds is None before it is measured."""

    frame: str
    shapes: int
    order: str
    nonzeros: int
    constants: int
    mass_force: int
    accel: int
    nanoseconds: float | None = None


def beam(frame: str, shapes: int, order: str) -> derive.PlanarBeam:
    """The free beam in a frame of FRAMES with the displacements of ORDERS."""
    powers = [f"xi^{n}" if n else "1" for n in range(shapes + 2)]
    return derive.planar_beam(f"{frame}{shapes}_{order}", ansatz=powers, frame=FRAMES[frame], **ORDERS[order])


@dataclass(frozen=True)
class Case:
    """The counts of a beam, the C of its `accel`, and states with small amplitudes."""

    cost: Cost
    variant: Variant
    inputs: Inputs


def case(frame: str, shapes: int, order: str) -> Case:
    """A beam through all stages."""
    made = problem(beam(frame, shapes, order))
    states = made.inputs.states.copy()
    states[:, 3 : made.inputs.nv] *= SMALL
    mass_force, accel = (made.model.kernel(name).operations for name in ("mass_force", "accel"))
    nonzeros = made.model.pattern("mass", "M").full_nnz
    constants = sum(constant.size for constant in made.model.constants)
    cost = Cost(frame, shapes, order, nonzeros, constants, mass_force, accel)
    return Case(cost, accelerations(made), replace(made.inputs, states=states))


def accelerations(given: Problem) -> Variant:
    """The generated `accel` with its `setup`, without the other functions; its program fails where it does."""
    name = given.model.name
    header, source = (next(f for f in given.files if f.path.endswith(end)) for end in (".h", ".c"))
    head = source.text[: source.text.index(f"int {name}_setup(")]
    functions = [_function(source.text, f"{name}_{function}") for function in ("setup", "accel")]
    return Variant(
        name=name,
        files={f"{name}.h": header.text, f"{name}.c": head + "\n".join(functions)},
        function=f"{name}_accel",
        declare=f'#include "{name}.h"\nstatic double k[{len(given.model.constants)}];',
        once=f"{name}_setup(p, k);",
        call=f"if ({name}_accel(0.0, q, v, k, h)) return 1",
    )


def _function(source: str, name: str) -> str:
    """The text of a function in the text of a C file."""
    match = re.search(rf"^int {name}\(.*?^}}\n", source, re.MULTILINE | re.DOTALL)
    assert match, name
    return match.group()


def measured(cases: Sequence[Case], runs: int, flags: tuple[str, ...]) -> list[Cost]:
    """The costs with times: all programs run in turn, `runs` times."""
    with tempfile.TemporaryDirectory(prefix="tisserand-bench-") as folder:
        with ThreadPoolExecutor(2) as pool:
            compiled = [pool.submit(program, c.variant, c.inputs, flags, Path(folder) / c.variant.name) for c in cases]
            programs = [job.result() for job in compiled]
        times = [[nanoseconds(p, c.inputs) for p, c in zip(programs, cases, strict=True)] for _ in range(runs)]
    medians = (median(column) for column in zip(*times, strict=True))
    return [replace(c.cost, nanoseconds=round(ns, 2)) for c, ns in zip(cases, medians, strict=True)]


SIZE = {"nonzeros": "nnz(M)", "constants": "k"}
COST = {"mass_force": "M and h", "accel": "accel", "nanoseconds": "ns"}
"""The figures of each table with their headings."""


def table(costs: Sequence[Cost], figures: dict[str, str]) -> str:
    """A table with a row for each frame and number of shapes, and a column for each figure and order."""
    head = ["frame", "shapes", *(f"{title}, {order}" for title in figures.values() for order in ORDERS)]
    lines = [f"| {' | '.join(head)} |", f"| --- |{' ---: |' * (len(head) - 1)}"]
    for frame, shapes in dict.fromkeys((cost.frame, cost.shapes) for cost in costs):
        rows = [cost for cost in costs if (cost.frame, cost.shapes) == (frame, shapes)]
        values = (getattr(cost, name) for name in figures for cost in rows)
        cells = ("-" if x is None else f"{x:.1f}" if isinstance(x, float) else str(x) for x in values)
        lines.append(f"| {frame} | {shapes} | {' | '.join(cells)} |")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--shapes", type=int, nargs="+", default=[1, 2, 3, 4, 5, 6])
    parser.add_argument("--frames", nargs="+", choices=FRAMES, default=list(FRAMES))
    parser.add_argument("--runs", type=int, default=3, help="0 counts operations alone")
    parser.add_argument("--flags", help="instead of -O3 -march=native")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    flags = tuple(shlex.split(options.flags)) if options.flags else native_flags()
    wanted = [(frame, n, order) for frame in options.frames for n in options.shapes for order in ORDERS]
    with ProcessPoolExecutor(2) as pool:  # the longest derivations first
        jobs = {key: pool.submit(case, *key) for key in sorted(wanted, key=lambda key: (key[2] != "full", -key[1]))}
        cases = [jobs[key].result() for key in wanted]
    costs = measured(cases, options.runs, flags) if options.runs else [c.cost for c in cases]
    setting = [*described("casadi", "sympy"), f"flags     {shlex.join(flags)}"]
    if options.json:
        print(json.dumps({"setting": setting, "rows": [asdict(cost) for cost in costs]}, indent=2))
    else:
        print("\n".join([*setting, "", table(costs, SIZE), "", table(costs, COST)]))


if __name__ == "__main__":
    main()
