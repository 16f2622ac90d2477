"""Accelerations of the free planar beam with its constant rows eliminated beforehand, and with all of M factorised.

`python bench/constant_elimination.py` prints operations and the least times of runs that take turns in one process.
The second variant is our own code without `derive/lowering/flat/constant_elimination.py`.
"""

from __future__ import annotations

import shlex
import subprocess
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from unittest.mock import patch

import numpy as np
from interleaved import TimedCall, interleaved
from machine import OWN_OPTION, described
from problem import Problem, beam, problem
from rows import Row, row

from derive.lowering.flat import accelerations
from derive.runtime.compiler import FLAGS as LOADED
from derive.runtime.compiler import compiler

FRAMES, SIZES = ("point", "mean"), (1, 2, 3, 5, 8)
FLAGS = ("-O3", "-march=x86-64-v3")
REPEATS = 61
GOAL = 0.95
TOLERANCE = 1e-9


@dataclass(frozen=True)
class Comparison:
    """Operations and times (ns) of the accelerations: with elimination beforehand, and with all of M factorised."""

    operations: tuple[int, int]
    ns: tuple[float, float]


def rows(quick: bool = False) -> list[Row]:
    """The rows of `rows.py` for both sets of flags."""
    sizes, repeats = (SIZES[:1], 1) if quick else (SIZES, REPEATS)
    result = []
    for flags in (FLAGS, LOADED):
        used = "derive.load" if flags == LOADED else " ".join(flags)
        for frame in FRAMES:
            for n in sizes:
                name = f"elimination beforehand, {frame} frame, N = {n}, {used}"
                ours, factorised = compared(frame, n, flags, repeats).ns
                result.append(row(name, ours, peers={"all of M factorised": factorised}, goal=GOAL))
    return result


def compared(frame: str, n: int, flags: Sequence[str], repeats: int = REPEATS) -> Comparison:
    """Both variants of a beam with n shapes. Raises ArithmeticError if their values differ."""
    made = problem(beam(frame, n))
    with patch.object(accelerations, "reduced_system", lambda _: None):
        other = problem(replace(made.spec, name=f"{made.model.name}_factorised"))
    both, nv, states = (made, other), made.inputs.nv, made.inputs.states
    with tempfile.TemporaryDirectory(prefix="tisserand-bench-") as directory:
        folder = Path(directory)
        names = [variant.model.name for variant in both]
        ns, values = interleaved(
            [TimedCall(name, f"{name}_accel(0.0, qs + s * {nv}, vs + s * {nv}, k_{name}, out);", nv) for name in names],
            declare="\n".join(f'#include "{folder}/{name}.h"' for name in names),
            once=" ".join(f"if ({name}_setup(p, k_{name})) return 5;" for name in names),
            arrays={"p": np.array(made.inputs.p), "qs": states[:, :nv], "vs": states[:, nv:]},
            scratch={f"k_{variant.model.name}": len(variant.model.constants) for variant in both},
            objects=[_compiled(variant, flags, folder) for variant in both],
            folder=folder,
            states=len(states),
            repeats=repeats,
            statistic=np.min,
        )
    error = np.max(np.abs(values[0] - values[1])) / np.max(np.abs(values[0]))
    if not error < TOLERANCE:
        raise ArithmeticError(f"{frame} frame, N = {n}: accelerations are off by {error:.1e}")
    own, factorised = (variant.model.kernel("accel").operations for variant in both)
    return Comparison((own, factorised), (ns[0], ns[1]))


def _compiled(variant: Problem, flags: Sequence[str], folder: Path) -> Path:
    """The object file of a variant."""
    for file in variant.files:
        if file.path.endswith((".c", ".h")):
            (folder / file.path.rsplit("/", 1)[1]).write_text(file.text)
    source = folder / f"{variant.model.name}.c"
    out = source.with_suffix(".o")
    subprocess.run([*compiler(), *flags, OWN_OPTION, "-w", "-c", source, "-o", out], check=True)
    return out


def main() -> None:
    print("\n".join(described("casadi")))
    for flags in (FLAGS, LOADED):
        print(f"\nflags     {shlex.join(flags)}; operations and nanoseconds of an evaluation")
        print(f"{'frame, shapes':16}{'eliminated':>20}{'factorised':>20}{'ratio':>8}")
        for frame in FRAMES:
            for n in SIZES:
                c = compared(frame, n, flags)
                cells = "".join(f"{count:12}{t:8.2f}" for count, t in zip(c.operations, c.ns, strict=True))
                print(f"{f'{frame}, {n}':16}{cells}{c.ns[0] / c.ns[1]:8.2f}", flush=True)


if __name__ == "__main__":
    main()
