"""Seconds from a specification to its generated files, by stage, and seconds of the imports.

python bench/tool_speed.py [--shapes 2 3 4 5 6 7 8 9 10] [--runs 5]

Every run is a separate process, so that caches of SymPy have no effect; the time does not include its imports, which
are measured separately. Then the CPU time of `tisserand simulate` of a scene, all of it: the first time, with an empty
cache, and as the median of later times.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from machine import described
from rows import Row, row

HERE = Path(__file__).parent
SCENE = HERE.parent / "scenes" / "crank_slider_3.toml"
STAGES = ("read", "derive", "lower", "emit")
FRAMES = ("mean", "point")
RUN = """
import json, sys
from pathlib import Path
import derive.spec.checks.validation, derive.spec.tables.specification
from derive.pipeline import build
print(json.dumps([*build(Path(sys.argv[1])).seconds.values()]))
"""
SPARSE = """
import sys, time
from bodies import beam
import derive, derive.derivation, derive.model_lowering, sympy.assumptions.refine, sympy.tensor.array
body, start = beam(int(sys.argv[1])), time.process_time()
derive.lower(derive.derive_modal(body, lowering="flat"))
print(time.process_time() - start)
"""
"""Derivation and lowering of a spatial beam, most of whose integrals vanish, to straight-line code: the CPU time, which
other load changes less."""
BUILD = """
import sys, time
from pathlib import Path
import derive.derivation, derive.model_lowering, derive.spec.checks.validation, derive.spec.tables.specification
from derive.pipeline import build
start = time.process_time()
build(Path(sys.argv[1]))
print(time.process_time() - start)
"""
"""All stages of a file, likewise."""
IMPORTS = (
    "pass", "import derive", "import sympy", "import casadi", "from derive import read", "import derive.pipeline",
    "import derive.runtime.loading",
)  # fmt: skip


def specification(frame: str, shapes: int) -> str:
    """The TOML of a beam with three markers."""
    ansatz = ", ".join(f'"xi^{n}"' for n in range(1, shapes + 2))
    markers = "[beam.markers]\nleft = -1\nmiddle = 0\nright = 1\n"
    return f'name = "beam"\n[beam]\nframe = "{frame}"\nansatz = ["1", {ansatz}]\n{markers}'


def stage_seconds(path: Path, runs: int) -> list[float]:
    """The time (s) of each stage, as the median over the runs."""
    command = [sys.executable, "-c", RUN, str(path)]
    times = [json.loads(subprocess.run(command, capture_output=True, check=True).stdout) for _ in range(runs)]
    return [statistics.median(column) for column in zip(*times, strict=True)]


def least_seconds(script: str, argument: str, runs: int) -> float:
    """The least time (s) that a script prints in some processes of its own."""
    command = [sys.executable, "-c", script, argument]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(HERE), *sys.path])}
    times = (subprocess.run(command, capture_output=True, check=True, env=environment).stdout for _ in range(runs))
    return min(map(float, times))


def rows(quick: bool = False) -> list[Row]:
    """Seconds of derivations, and the exponent with which they grow with the number of modes, see `rows.py`."""
    runs, modes, shapes = (1, 8, 2) if quick else (3, 100, 18)
    half, whole = (least_seconds(SPARSE, str(n), runs=runs) for n in (modes // 2, modes))
    exponent = math.log2(whole / half)
    with tempfile.TemporaryDirectory(prefix="tisserand-bench-") as folder:
        path = Path(folder) / "beam.toml"
        path.write_text(specification("point", shapes))
        built = least_seconds(BUILD, str(path), runs=runs)
    return [
        row(f"derive a sparse beam of {modes} modes", whole, goal=3, unit="s"),
        row(f"the same: exponent from {modes // 2} to {modes} modes", exponent, goal=1.3, unit="1"),
        row(f"build a beam of {shapes} shapes, point frame", built, goal=3, unit="s"),
    ]


def import_seconds(statement: str, runs: int) -> float:
    """The time (s) of a process that runs a statement, as the median over the runs."""

    def once() -> float:
        start = time.perf_counter()
        subprocess.run([sys.executable, "-c", statement], check=True)
        return time.perf_counter() - start

    return statistics.median(once() for _ in range(runs))


def simulation_seconds(folder: Path, runs: int) -> list[float]:
    """The CPU time (s) of `tisserand simulate`, compilers included, of the first run with a cache and of later ones."""
    environment = {**os.environ, "XDG_CACHE_HOME": str(folder / "cache")}
    command = [sys.executable, "-m", "derive", "simulate", str(SCENE), "--out", str(folder / "out")]
    result = []
    for _ in range(runs + 1):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(command, check=True, env=environment, stdout=subprocess.DEVNULL)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        result.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return result


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--shapes", type=int, nargs="+", default=list(range(2, 11)))
    parser.add_argument("--runs", type=int, default=5)
    options = parser.parse_args()
    print("\n".join(described("casadi", "sympy", "pydantic", "jinja2")))
    print(f"figures   seconds, median of {options.runs} processes\n")
    print("frame  shapes" + "".join(stage.rjust(9) for stage in STAGES) + "    total")
    with tempfile.TemporaryDirectory(prefix="tisserand-bench-") as folder:
        path = Path(folder) / "beam.toml"
        for frame in FRAMES:
            for shapes in options.shapes:
                path.write_text(specification(frame, shapes))
                seconds = stage_seconds(path, options.runs)
                cells = "".join(f"{s:9.3f}" for s in (*seconds, sum(seconds)))
                print(f"{frame:5}{shapes:8}{cells}", flush=True)
    print("\na process that runs          seconds")
    for statement in IMPORTS:
        print(f"{statement:28}{import_seconds(statement, options.runs):8.3f}", flush=True)
    with tempfile.TemporaryDirectory(prefix="tisserand-bench-") as folder:
        first, *later = simulation_seconds(Path(folder), options.runs)
    print(f"\ntisserand simulate {SCENE.name}: {first:.2f} s of CPU time, then {statistics.median(later):.2f} s")


if __name__ == "__main__":
    main()
