"""Machine instructions and time of an evaluation of M and h of the planar beam, for all variants.

python bench/instructions.py [--shapes 2 4 8] [--phi 0.5] [--flags "-O2 -std=c99 -ffp-contract=off"] [--json]
"""

from __future__ import annotations

import argparse
import json
import shlex
import tempfile
from dataclasses import asdict
from pathlib import Path

import numpy as np
from harness import Measured, measure
from machine import NO_AVX512, described, first_line, native_flags
from problem import beam, problem
from variants import EMPTY, all_variants

from derive import load

FRAMES = ("point", "mean")


def measured(frame: str, shapes: int, phi: float | None, flags: tuple[str, ...], folder: Path) -> list[Measured]:
    """The results of all variants of a beam; the reference is the generated code as derive.load compiles it."""
    given = problem(beam(frame, shapes), phi)
    native = load(given.files)
    nv = given.inputs.nv
    k = native.setup(given.inputs.p)
    reference = [[*M, *h] for M, h in (native.mass_force(0.0, s[:nv], s[nv:], k) for s in given.inputs.states)]
    empty = measure(EMPTY, given.inputs, flags, folder / f"{frame}{shapes}", None)
    return [empty] + [
        measure(variant, given.inputs, flags, folder / f"{frame}{shapes}_{i}", np.array(reference))
        for i, variant in enumerate(all_variants(given))
    ]


def table(frame: str, shapes: int, rows: list[Measured]) -> str:
    """The results of a beam as a table of text."""
    head = f"{frame} frame, {shapes} shapes"
    lines = [f"{head:42}{'total':>9}{'own':>9}{'libm':>9}{'ns':>9}"]
    for row in rows:
        n = row.instructions
        lines.append(f"  {row.name:40}{n.total:9.1f}{n.own:9.1f}{n.library:9.1f}{row.nanoseconds:9.1f}")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--shapes", type=int, nargs="+", default=[2, 4, 8])
    parser.add_argument("--phi", type=float, help="the rotation (rad) of all states; by default evenly distributed")
    parser.add_argument("--flags", help="instead of -O3 -march=native")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    flags = tuple(shlex.split(options.flags)) if options.flags else native_flags()
    rotation = "phi evenly over a revolution" if options.phi is None else f"phi = {options.phi}"
    head = [
        *described("casadi", "sympy"),
        f"flags     {shlex.join(flags)}",
        f"counted   {first_line('valgrind', '--version')} callgrind, mean over 64 states, {rotation}",
    ]
    if NO_AVX512 in flags:
        head.append("          AVX-512 is not used, because valgrind does not support it")
    results = {}
    if not options.json:
        print("\n".join(head))
    with tempfile.TemporaryDirectory(prefix="tisserand-bench-") as folder:
        for shapes in options.shapes:
            for frame in FRAMES:
                rows = measured(frame, shapes, options.phi, flags, Path(folder))
                results[f"{frame} {shapes}"] = [asdict(row) for row in rows]
                if not options.json:
                    print(f"\n{table(frame, shapes, rows)}", flush=True)
    if options.json:
        print(json.dumps({"setting": head, "tables": results}, indent=2))


if __name__ == "__main__":
    main()
