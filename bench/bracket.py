"""An L-shaped bracket on a table that is spun up: modes against a nonlinear finite-element run of the same mesh.

python bench/bracket.py [--speed RAD_PER_S] [--steps N ...] [--models KIND:ORDER:N ...] [--kept FOLDER] [--json]
                        [--write]

CalculiX (`ccx`) integrates the bracket of scenes/make_bracket.py with large displacements (`*DYNAMIC, NLGEOM`), in the
numbers of equal steps that `--steps` lists; the last run is the reference, and the difference of the last two is its
error. Tisserand imports the matrices of the same mesh and integrates it with modes of several kinds, numbers and
orders. The error is the largest difference of the displacement of the free end in the frame of the table, relative to
its largest displacement. CPU seconds are those of the integration; before it come the reduction, the derivation and the
compilation.
"""

from __future__ import annotations

import argparse
import json
import resource
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from bracket_page import table, write
from bracket_run import END, Row, Run, bracket_run, result
from machine import described

import derive

ROOT = Path(__file__).parents[1]
SPEED = 300.0  # rad/s, reached in END seconds
STEPS = (250, 500, 1000)
MODELS = (
    *("rigid:1:0", "free:1:6", "free:1:12", "free:1:20"),
    *("craig_bampton:1:6", "craig_bampton:1:8", "craig_bampton:1:12", "craig_bampton:1:16"),
    *("craig_bampton:2:6", "craig_bampton:2:8", "craig_bampton:2:12", "craig_bampton:2:16"),
)
OUTPUT = 2e-4  # s
START = [0.0573684211, 0.02, 0.0573684211]  # the centre of mass
SEAT, TIP = (0.01, 0.02, 0.2), (0.2, 0.02, 0.01)


def specification(kind: str, order: int, modes: int, speed: float) -> dict[str, Any]:
    """The tables of the scene: a table that a motor turns, and the bracket that is fixed to it at its end face."""
    return {
        "ground": {"axis": [0, 0, 0]},
        "bodies": {
            "table": {"markers": {"centre": [0, 0, 0], "seat": SEAT}},
            "bracket": {
                "nodes": "bracket.npz",
                "units": "SI",
                "modes": modes,
                "order": order,
                "start": {"guess": True, "position": START},
                "markers": {"left": {"set": "left", "motion": "rigid"}, "right": {"set": "right"}},
            }
            | ({"component_modes": kind} if modes else {})
            | ({"interface": ["left", "right"]} if kind == "craig_bampton" else {}),
        },
        "joints": {
            "shaft": {"kind": "revolute", "between": ["ground.axis", "table.centre"]},
            "seat": {"kind": "fixed", "between": ["table.seat", "bracket.left"]},
        },
        "drives": {"motor": {"joint": "shaft", "motion": motion(speed)}},
        "outputs": {"tip": {"kind": "position", "marker": "bracket.right", "frame": "table.centre"}},
    }


def motion(speed: float) -> str:
    """The angle of the table: its speed grows from 0 to `speed` with a smooth acceleration."""
    return f"{speed:g}*(t^2/{2 * END:g} + {END:g}/(4*pi^2)*(cos(2*pi*t/{END:g}) - 1))"


def cpu() -> float:
    """The CPU seconds of this process and of those that it waited for."""
    usages = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


def own_run(model: str, speed: float, folder: Path) -> tuple[Run, Row]:
    """The motion of the free end by a model, and its costs."""
    kind, order, modes = model.split(":")
    tables = specification("free" if kind == "rigid" else kind, int(order), int(modes), speed)
    bracket = tables["bodies"]["bracket"]
    bracket["nodes"] = str(folder / "bracket.npz")
    tip = np.load(folder / "bracket.npz")["set_right"].tolist()
    bracket["markers"]["right"] = {"nodes": tip, "weights": [1] * len(tip)}  # as `bracket_run` takes the mean
    start = cpu()
    trajectory = derive.simulate(derive.spatial_scene("bracket", **tables), duration=END, output=OUTPUT, tolerance=1e-8)
    before = cpu() - start - trajectory.solution.cost.seconds
    place = np.stack([trajectory[f"tip_{axis}"] for axis in (1, 2, 3)], axis=1)
    size = 0 if kind == "rigid" else int(modes)
    return Run(trajectory.t, place - TIP), Row(model, 6 + size, 0.0, trajectory.solution.cost.seconds, before)


def error(run: Run, reference: Run) -> float:
    """The largest difference of displacements, relative to the largest displacement."""
    t = run.t[1:]
    own, other = (np.stack([np.interp(t, r.t, r.displacement[:, k]) for k in range(3)]) for r in (run, reference))
    return float(np.abs(own - other).max() / np.linalg.norm(other, axis=0).max())


def rows(models: Sequence[str], steps: Sequence[int], speed: float, folder: Path) -> tuple[Row, ...]:
    """The rows of all models and runs; the last run of CalculiX is the reference, whose error is that of one before."""
    shutil.copy(ROOT / "scenes" / "make_bracket.py", folder)
    call = partial(subprocess.run, cwd=folder, check=True, capture_output=True)
    call([sys.executable, "make_bracket.py", "bracket.inp"])
    call(["ccx", "bracket"])
    call([sys.executable, "-m", "derive", "import", "bracket.inp", "--interface", "left,right"])
    text = (folder / "bracket.inp").read_text(encoding="utf-8")
    mesh = text[: text.index("*STEP")]
    full = 3 * len(np.load(folder / "bracket.npz")["positions"])
    spent = []
    for n in steps:
        start = cpu()
        bracket_run(mesh, n, speed, folder / f"steps_{n}")
        spent.append(cpu() - start)
    runs = [result(mesh, speed, folder / f"steps_{n}") for n in steps]
    reference = runs[-1]
    errors = [*(error(run, reference) for run in runs[:-1]), error(runs[-2], reference)]
    listed = zip(steps, errors, spent, strict=True)
    found = [Row(f"CalculiX, {n} steps", full, e, s, 0.0) for n, e, s in listed]
    for model in models:
        run, row = own_run(model, speed, folder)
        found.append(replace(row, error=error(run, reference)))
        print(table(found[-1:], head=False), file=sys.stderr, flush=True)
    return tuple(found)


def main() -> None:
    """Run the comparison and print its table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--speed", type=float, default=SPEED)
    parser.add_argument("--steps", type=int, nargs="+", default=STEPS)
    parser.add_argument("--models", nargs="+", default=MODELS)
    parser.add_argument("--kept", type=Path, help="an empty folder for the files of both programs")
    parser.add_argument("--json", action="store_true", help="print the rows as JSON")
    parser.add_argument("--write", action="store_true", help="write docs/bracket.svg and the table in bench/README.md")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="tisserand-bench-") as directory:
        folder = options.kept or Path(directory)
        folder.mkdir(exist_ok=True)
        found = rows(options.models, options.steps, options.speed, folder.resolve())
    machine = "\n".join(described("numpy", "scipy"))
    print(json.dumps([asdict(row) for row in found]) if options.json else f"{machine}\n\n{table(found)}")
    if options.write:
        write(found, f"One run of {machine.splitlines()[0].split(None, 1)[1]}.")


if __name__ == "__main__":
    main()
