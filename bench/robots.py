"""Forward dynamics, inverse dynamics and mass matrices of robots and chains, beside Pinocchio, MuJoCo and C by hand.

python bench/robots.py [--only NAME ...] [--yardsticks FOLDER] [--coordinates NAME] [--kept FOLDER] [--json]

Robots are those of the package example-robot-data, in one URDF that all read; chains have 3 to 1000 revolute bodies
with numbers of their own. Makers run alternately in one process, one call after the other for random states, with the
same flags; each time is the least of many slices, and values are compared first: accelerations, forces and mass
matrices agree to 1e-12 of the largest number in the coordinates of Pinocchio.

Pinocchio is compiled from the headers of its package with Eigen from `cmeel-eigen`, and takes its faster convention in
each row (kept: a folder for its object, whose compilation takes minutes). Without these headers it is timed from Python
in a process of its own, less the time of a call; the head of the table says which. MuJoCo is its C library, of whose
steps those alone are called that a result needs, without contacts, limits and passive forces. FOLDER has aba1.c, C by
hand for chains, with `eval(n, class, tables, q, v, vdot, work)`.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path

import pinocchio_peer
from long_chains import LongChain
from machine import OWN_OPTION, described
from robot_comparison import BATCH, Comparison, Figures
from robot_files import ROBOTS, has_robots
from rows import Row, row

FLAGS = "-O3 -march=x86-64-v3"
STATES = 64
"""The random states, a multiple of those of a batch: so many that no predictor of branches learns them by heart."""
REPEATS = 41
COUNTS = (3, 10, 30, 100, 1000)
LABELS = {"accel": "forward dynamics", "inverse_dynamics": "inverse dynamics", "mass": "mass matrix"}
GOALS = {"accel": 0.3, "inverse_dynamics": 0.3, "mass": None}
HAND_GOAL, BATCH_GOAL = 1.2, 0.5
CASES = (*ROBOTS, *(f"chain_{n}" for n in COUNTS))
LONG = "chain_1000"
"""The case that is measured only if it is named, beside C by hand alone: see `long_chains.py`."""


@dataclass(frozen=True)
class Options:
    """How a run measures: flags and repeats, folders, and the coordinates of our scenes."""

    flags: str = FLAGS
    repeats: int = REPEATS
    states: int = STATES
    coordinates: str = "relative"
    yardsticks: Path | None = None
    kept: Path | None = None
    compiled_peers: bool = True


def figures(case: str, options: Options) -> list[Figures]:
    """The figures of a case. Raises ArithmeticError if values differ."""
    with tempfile.TemporaryDirectory(prefix="tisserand-bench-") as name:
        folder = Path(name)
        if case == LONG:
            if not options.yardsticks:
                raise FileNotFoundError(f"{case} is compared with C by hand alone: name its folder by --yardsticks")
            chain = LongChain(case, folder, options.flags, options.coordinates, options.states)
            chain.add_ours()
            chain.add_hand(options.yardsticks)
            return [*chain.times(options.repeats)]
        comparison = Comparison(case, folder, options.flags, options.coordinates, options.states)
        comparison.add_ours()
        peer = pinocchio_peer.compiled(folder, options.flags, options.kept) if options.compiled_peers else None
        if peer:
            comparison.add_pinocchio(peer)
        if options.compiled_peers:
            comparison.add_mujoco()
        if case.startswith("chain_") and options.yardsticks:
            comparison.add_hand(options.yardsticks)
        result = list(comparison.times(options.repeats))
        if not peer:
            python = pinocchio_peer.python_times(comparison.pin, comparison.robot, comparison.states, options.repeats)
            result = [replace(f, ns={**f.ns, "Pinocchio from Python": python[f.function]}) for f in result]
        return result


def rows_of(found: Figures) -> list[Row]:
    """The rows of a function of a case, see `rows.py`: beside Pinocchio, MuJoCo and code by hand; of a batch."""
    peers = {name: t for name, t in found.ns.items() if name not in ("ours", "batch", "hand")}
    ours, hand = found.ns["ours"], found.ns.get("hand")
    note = (
        f"{found.operations} operations, {found.text / 1000:.1f} kB of text, derived in {found.derive_seconds:.1f} s, "
        f"compiled in {found.compile_seconds:.1f} s"
    )
    name = f"{LABELS[found.function]}, {found.case}, {found.joints} velocities"
    goal = HAND_GOAL if hand else GOALS[found.function]
    more = {"all_ns": found.ns, "operations": found.operations, "text": found.text}
    more |= {"derive_s": found.derive_seconds, "compile_s": found.compile_seconds, "notes": found.notes}
    result = [{**row(name, ours, peers=peers, hand=hand, goal=goal, note=note), **more}]
    if batch := found.ns.get("batch"):
        result.append(row(f"{name}, batch of {BATCH}, per state", batch, peers={"single calls": ours}, goal=BATCH_GOAL))
    return result


def rows(options: Options, cases: Sequence[str]) -> list[Row]:
    """The rows of cases."""
    return [row for case in cases for found in figures(case, options) for row in rows_of(found)]


def _head(options: Options) -> list[str]:
    """The machine, the flags, and how the peers are measured."""
    compiled = options.compiled_peers and pinocchio_peer.include_folders()
    way = (
        "C++ from its headers, in the same process"
        if compiled
        else "from Python, less the time of a call (its C++ needs tisserand[bench] and g++)"
    )
    try:
        mujoco = f"{version('mujoco')}, its C library, in the same process"
    except PackageNotFoundError:
        mujoco = "none: pip install tisserand[bench]"
    return [
        *described("pin", "numpy"),
        f"flags     {options.flags}; ours with {OWN_OPTION}",
        f"peers     Pinocchio {version('pin')}: {way}; MuJoCo {mujoco}",
        f"figures   ns of an evaluation, CPU time, least of {options.repeats}; {options.coordinates} coordinates",
        *([] if has_robots() else ["robots    none: example-robot-data is missing: pip install tisserand[hosts]"]),
    ]


def main(argv: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="+", choices=CASES, metavar="NAME", help=", ".join(CASES))
    parser.add_argument("--yardsticks", type=Path, help="the folder of C by hand")
    parser.add_argument("--kept", type=Path, help="a folder for the compiled Pinocchio, so that it is compiled once")
    parser.add_argument("--coordinates", choices=("relative", "absolute"), default="relative")
    parser.add_argument("--flags", default=FLAGS)
    parser.add_argument("--repeats", type=int, default=REPEATS)
    parser.add_argument("--python", action="store_true", help="Pinocchio from Python, and no MuJoCo")
    parser.add_argument("--json", action="store_true", help="print all figures as JSON")
    given = parser.parse_args(argv)
    options = Options(
        given.flags, given.repeats, STATES, given.coordinates, given.yardsticks, given.kept, not given.python
    )
    if not find_spec("pinocchio"):
        parser.error("Pinocchio is missing: pip install tisserand[hosts]")
    cases = given.only or [case for case in CASES if case != LONG and (case not in ROBOTS or has_robots())]
    head = _head(options)
    if given.json:
        print(json.dumps({"head": head, "rows": rows(options, cases)}, indent=2))
        return 0
    print("\n".join([*head, "", TABLE_HEAD]))
    notes: dict[str, None] = {}
    for case in cases:
        for found in figures(case, options):
            print(table_row(found), flush=True)
            notes |= dict.fromkeys(f"{case}: {note}" for note in found.notes)
    print("\n".join(["", *notes]))
    return 0


TABLE_HEAD = (
    "| | operations | kB | derive, s | gcc, s | ours | batch | Pinocchio | MuJoCo | by hand "
    "| ours / Pinocchio | ours / by hand | batch / ours |\n"
    "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"
)


def table_row(found: Figures) -> str:
    """A line of the table."""
    pinocchio = min((t for name, t in found.ns.items() if name.startswith("Pinocchio")), default=None)
    ours, batch, hand = (found.ns.get(name) for name in ("ours", "batch", "hand"))
    assert ours
    cells = [
        str(found.operations),
        f"{found.text / 1000:.1f}",
        f"{found.derive_seconds:.1f}",
        f"{found.compile_seconds:.1f}",
    ]
    cells += [f"{t:.4g}" if t else "" for t in (ours, batch, pinocchio, found.ns.get("MuJoCo"), hand)]
    pairs = ((ours, pinocchio), (ours, hand), (batch, ours))
    cells += [f"{a / b:.2f}" if a and b else "" for a, b in pairs]
    return f"| {LABELS[found.function]}, {found.case} ({found.joints}) | {' | '.join(cells)} |"


if __name__ == "__main__":
    sys.exit(main())
