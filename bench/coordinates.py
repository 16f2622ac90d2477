"""Relative and absolute coordinates of the same scenes: numbers of equations, non-zeros, operations and times.

python bench/coordinates.py [--only NAME ...] [--flags FLAGS] [--repeats N] [--json]

The accelerations of robots, chains and linkages of rigid bodies in straight-line code: rows and multipliers, non-zeros
of the lower triangle of M and of G, operations, and ns per evaluation for random states (the least counts); both
forms run alternately in one process. That they have the same values is tested in tests/space/test_trees.py.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
from interleaved import TimedCall, interleaved
from lowerings import STATES, compiled_accelerations, random_states
from machine import described
from robot_files import has_robots, scene_of

import derive
from derive.ir.analysis import operations
from derive.ir.model import Model
from derive.lowering.flat.lower import lower
from derive.spec.model.spatial_scene import SpatialScene

ROOT = Path(__file__).parents[1]
FLAGS = "-O3 -march=x86-64-v3"
FORMS = ("relative", "absolute")
LINKAGE = "spatial_crank_slider_rigid"
CASES = (LINKAGE, "chain_3", "chain_10", "ur5", "solo12", "simple_humanoid")
WITHOUT_ROBOTS = CASES[:3]
REPEATS = 31


@dataclass(frozen=True)
class Figures:
    """The figures of a scene in some coordinates."""

    scene: str
    coordinates: str
    velocities: int
    multipliers: int
    nonzeros: int
    operations: int
    ns: float


def figures(case: str, flags: str, repeats: int) -> list[Figures]:
    """The figures of a case in both forms."""
    with tempfile.TemporaryDirectory(prefix="tisserand-bench-") as directory:
        folder = Path(directory)
        return figures_of(case, {form: _model(case, form, folder) for form in FORMS}, flags, repeats, folder)


def figures_of(case: str, models: dict[str, Model], flags: str, repeats: int, folder: Path) -> list[Figures]:
    """The figures of a case by its models in several forms."""
    return [
        Figures(
            case,
            form,
            sum(v.size for v in model.velocities),
            sum(m.size for m in model.multipliers),
            len(model.pattern("mass", "M").entries) + len(model.pattern("constraint_jacobian", "G").entries),
            sum(operations(node) for section in model.kernel("accel").sections for node in section.body),
            round(ns, 1),
        )
        for (form, model), ns in zip(models.items(), _times(models, flags, repeats, folder), strict=True)
    ]


def _model(case: str, form: str, folder: Path) -> Model:
    if case == LINKAGE:
        scene = derive.read(ROOT / "examples" / f"{LINKAGE}.toml")
        assert isinstance(scene, SpatialScene)
        scene = replace(scene, coordinates=form, outputs=())
    else:
        _, scene = scene_of(case, folder, form)
    return lower(derive.derive(replace(scene, lowering="flat")).expanded(), explicit=True)


def _times(models: dict[str, Model], flags: str, repeats: int, folder: Path) -> list[float]:
    """The least times (ns) of an evaluation of the accelerations."""
    calls, declared, once = [], [], []
    arrays, scratch = {}, {}
    for number, model in enumerate(models.values()):
        form = f"form{number}"
        name = f"{model.name}_{form}"
        used = [argument.name for argument in model.kernel("accel").arguments]
        q, v = random_states(model)
        own = {"q": q, "v": v, "p": np.array([*model.defaults, 0.0]), "u": np.zeros(len(model.inputs) + 1)}
        arrays |= {f"{key}_{form}": value for key, value in own.items()}
        scratch[f"k_{form}"] = 1 + sum(c.size for c in model.constants)
        given = {
            "t": "0.01",
            "q": f"q_{form} + s * {q.shape[1]}",
            "v": f"v_{form} + s * {v.shape[1]}",
            "u": f"u_{form}",
            "k": f"k_{form}",
        }
        types = ", ".join("double" if argument == "t" else "const double *" for argument in used)
        arguments = ", ".join(given[argument] for argument in used)
        calls.append(TimedCall(form, f"if ({name}_accel({arguments}, out)) exit(7);", v.shape[1]))
        declared.append(f"int {name}_setup(const double *, double *); int {name}_accel({types}, double *);")
        once.append(f"if ({name}_setup(p_{form}, k_{form})) return 5;")
    times, _ = interleaved(
        calls,
        declare="\n".join(declared),
        once=" ".join(once),
        arrays=arrays,
        scratch=scratch,
        objects=[
            compiled_accelerations(model, f"form{number}", flags, folder)
            for number, model in enumerate(models.values())
        ],
        folder=folder,
        states=STATES,
        repeats=repeats,
        statistic=np.min,
    )
    return [float(ns) for ns in times]


def table(found: Sequence[Figures]) -> str:
    """The figures as a table of Markdown."""
    lines = ["| scene | coordinates | velocities | multipliers | non-zeros of M and G | operations | ns |"]
    lines.append("|---|---|---:|---:|---:|---:|---:|")
    for f in found:
        cells = (f.scene, f.coordinates, f.velocities, f.multipliers, f.nonzeros, f.operations, f"{f.ns:.0f}")
        lines.append(f"| {' | '.join(map(str, cells))} |")
    return "\n".join(lines)


def main(argv: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="+", choices=CASES, metavar="NAME", help=", ".join(CASES))
    parser.add_argument("--flags", default=FLAGS)
    parser.add_argument("--repeats", type=int, default=REPEATS)
    parser.add_argument("--json", action="store_true", help="print all figures as JSON")
    options = parser.parse_args(argv)
    cases = options.only or (CASES if has_robots() else WITHOUT_ROBOTS)
    found = [f for case in cases for f in figures(case, options.flags, options.repeats)]
    if options.json:
        print(json.dumps([asdict(f) for f in found], indent=1))
        return
    print("\n".join([*described(), "", table(found)]))


if __name__ == "__main__":
    main()
