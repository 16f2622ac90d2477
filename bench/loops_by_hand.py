"""Generated functions of a body in space compared with C written by hand, and with the C that CasADi generates.

python bench/loops_by_hand.py [--sizes 2 8 32 100] [--sparse 8 32] [--accelerations 8 32 100]

All implementations of a function run alternately in one process, with one compiler and the same flags; each time is
the least of many slices. Their values are compared first. Of our own lowerings the cost model selects one.
"""

from __future__ import annotations

import argparse
import shlex
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from bodies import BODIES, states
from interleaved import TimedCall, interleaved
from limited import limited
from machine import described
from scale import STATES, TOLERANCE, CSource, by_position, check_agreement, compiled, ours, peers, timed_call

import derive
from derive.backends.c.source import CBackend
from derive.lowering.cost_model import estimate_costs
from derive.mechanics.bodies.spatial_body import modal_body
from derive.runtime.compiler import compiler

HERE = Path(__file__).parent
FLAGS = "-O3 -march=x86-64-v3"
LABELS = {"mass": "M", "force": "h", "jacobian": "Jacobian"}
GOALS = {"mass": 1.1, "force": 1.1, "jacobian": 1.2}
"""The largest ratio of our time to the time by hand; for sparse tables to that of CasADi, see SPARSE_GOAL."""
ACCEL_GOAL = 1.1
SPARSE_GOAL = 1.0
MAX_PEER_MODES = {"mass": 8, "force": 32, "jacobian": 8}
"""The largest number of modes of a dense body for which CasADi is measured: beyond, gcc takes minutes."""
DECLARATIONS = """\
void hand_setup(const double *); void hand_mass(const double *, double *);
void hand_force(const double *, const double *, double *);
void hand_jacobian(const double *, const double *, double, double *);
void hand_accel(const double *, const double *, double *);
"""

Row = dict[str, str | float | None]


def by_hand(size: int, flags: str, folder: Path, *defines: str) -> Path:
    """The object file of handwritten_body.c for so many modes."""
    target = folder / "by_hand.o"
    command = [*compiler(), *shlex.split(flags), "-w", f"-DN={size}", *defines, "-c", HERE / "handwritten_body.c"]
    limited([*map(str, command), "-o", str(target)])
    return target


def hand_call(item: str, size: int, count: int) -> TimedCall:
    """The call of a function by hand; the rows of q, v, y, ydot are states."""
    q, v, y = f"q + s * {7 + size}", f"v + s * {6 + size}", 13 + 2 * size
    arguments = {"mass": q, "force": f"{q}, {v}", "jacobian": f"y + s * {y}, ydot + s * {y}, cj"}
    return TimedCall("hand", f"hand_{item}({arguments[item]}, out);", count)


def measured(data: str, size: int, flags: str, repeats: int, limit: float, folder: Path) -> list[Row]:
    """The rows of M, h and the iteration matrix of a body: dense, or with the sparse tables of a beam."""
    own, sizes = ours(data, size, limit, folder, ("flat", "table") if size <= MAX_PEER_MODES["force"] else ("table",))
    hand = by_hand(size, flags, folder) if data == "dense" else None
    selected = estimate_costs(modal_body(BODIES[data](size), None)).lowering
    rows = []
    for item, label in LABELS.items():
        few = data == "beam" or size <= MAX_PEER_MODES[item]
        sources = [s for (i, _), s in own.items() if i == item and (s.maker == "table" or few)]
        sources += peers(data, size, limit, folder, (item,)).values() if few else ()
        sources = [s for s in sources if compiled(s.path, flags, limit).seconds is not None]
        times = nanoseconds(data, size, item, sources, sizes, repeats, folder, hand)
        name = f"{label}, {data}, N = {size}"
        goal = GOALS[item] if hand else SPARSE_GOAL
        rows.append(row(name, times[selected], times.get("casadi"), times.get("hand"), goal))
        print(" ".join([f"{name:28}", *(f"{k} {t:.1f}" for k, t in times.items())]), flush=True)
    return rows


def row(name: str, own: float, peer: float | None, hand: float | None, goal: float) -> Row:
    """A row of the table; the ratio is to the time by hand, where there is none to that of the peer."""
    base = hand or peer
    ratio = own / base if base else None
    peer_name = "CasADi" if peer else None
    return {
        "name": name,
        "ours_ns": own,
        "peer_ns": peer,
        "peer_name": peer_name,
        "hand_ns": hand,
        "ratio": ratio,
        "goal": goal,
    }


def nanoseconds(
    data: str,
    size: int,
    item: str,
    sources: list[CSource],
    sizes: dict[str, int],
    repeats: int,
    folder: Path,
    hand: Path | None,
) -> dict[str, float]:
    """The times (ns) of an evaluation by maker. Raises ArithmeticError if the values differ."""
    pairs = [timed_call(item, s.maker, size, s.size) for s in sources]
    calls = [call for _, call in pairs]
    arrays = states(size, STATES)
    once, declare, objects = [], [d for d, _ in pairs], [s.path.with_suffix(".o") for s in sources]
    scratch = {"work": 1 << 22}
    for lowering in {s.maker for s in sources} - {"casadi"}:
        setup = folder / f"own_{lowering}_setup.c"
        compiled(setup, "-O1")
        objects.append(setup.with_suffix(".o"))
        arrays[f"p_{lowering}"] = np.append(np.fromfile(folder / f"own_{lowering}_p.bin"), 0.0)
        scratch[f"k_{lowering}"] = sizes[lowering] + 1
        declare.append(f"int own_{lowering}_setup(const double *, double *);")
        once.append(f"if (own_{lowering}_setup(p_{lowering}, k_{lowering})) return 5;")
    if any(s.maker == "casadi" for s in sources):
        arrays["parameters"] = np.append(np.fromfile(folder / "parameters.bin"), 0.0)
    declare.append("static const double cj = 10.0;")
    if hand:
        declare.append(DECLARATIONS)
        once.append("hand_setup(p_table);")
        objects.append(hand)
        calls.append(hand_call(item, size, next(s.size for s in sources if s.maker == "table")))
    times, values = interleaved(
        calls,
        declare="\n".join(declare),
        once=" ".join(once),
        arrays=arrays,
        scratch=scratch,
        objects=objects,
        folder=folder,
        states=STATES,
        repeats=repeats,
        statistic=np.min,
    )
    check_agreement([by_position(s, item, v, folder) for s, v in zip(sources, values, strict=False)], sources)
    if hand:
        table = next(k for k, s in enumerate(sources) if s.maker == "table")
        error = np.max(np.abs(values[-1] - values[table])) / np.max(np.abs(values[table]))
        if not error < TOLERANCE:
            raise ArithmeticError(f"{item} by hand is off by {error:.1e}")
    return {call.name: t for call, t in zip(calls, times, strict=True)}


def accelerations(size: int, flags: str, repeats: int, folder: Path) -> Row:
    """The row of the accelerations in the mean frame, where c8 is the unit matrix."""
    spec = derive.symbolic_body("body", size, frame="mean", lowering="table")
    model = derive.lower(derive.derive(spec))
    derive.write(CBackend().files(model, "a benchmark"), folder)
    source = folder / "body" / "body.c"
    target = source.with_suffix(".o")
    limited([*compiler(), *shlex.split(flags), "-w", "-c", str(source), "-o", str(target)])
    n, nq = 6 + size, 7 + size
    rng = np.random.default_rng(size)
    state = f"q + s * {nq}, v + s * {n}"
    calls = [
        TimedCall("ours", f"body_accel(0.0, {state}, k, out);", n),
        TimedCall("hand", f"hand_accel({state}, out);", n),
    ]
    (own, hand), (values, others) = interleaved(
        calls,
        declare=f'#include "{source.with_suffix(".h").resolve()}"\n{DECLARATIONS}',
        once="if (body_setup(p, k)) return 5; hand_setup(p);",
        arrays={
            "p": np.array(model.defaults) + rng.uniform(0, 0.01, len(model.defaults)),
            **{name: a for name, a in states(size, STATES).items() if name in ("q", "v")},
        },
        scratch={"k": sum(v.size for v in model.constants)},
        objects=[target, by_hand(size, flags, folder, "-DMEAN")],
        folder=folder,
        states=STATES,
        repeats=repeats,
        statistic=np.min,
    )
    error = np.max(np.abs(values - others)) / np.max(np.abs(values))
    if not error < TOLERANCE:
        raise ArithmeticError(f"accelerations by hand are off by {error:.1e}")
    name = f"accelerations, c8 = I, N = {size}"
    print(f"{name:28} table {own:.1f} hand {hand:.1f}", flush=True)
    return row(name, own, None, hand, ACCEL_GOAL)


def rows(
    sizes: Sequence[int] = (2, 8, 32, 100),
    sparse: Sequence[int] = (8, 32),
    accels: Sequence[int] = (8, 32, 100),
    flags: str = FLAGS,
    repeats: int = 41,
    limit: float = 600.0,
) -> list[Row]:
    """The rows of the table: name, times (ns) of an evaluation, and the ratio with its goal."""
    result: list[Row] = []
    with tempfile.TemporaryDirectory(prefix="tisserand-bench-") as folder:
        for data, counts in (("dense", sizes), ("beam", sparse)):
            for size in counts:
                result += measured(data, size, flags, repeats, limit, Path(folder))
        result += [accelerations(size, flags, repeats, Path(folder)) for size in accels]
    return result


def main(argv: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sizes", type=int, nargs="*", default=[2, 8, 32, 100])
    parser.add_argument("--sparse", type=int, nargs="*", default=[8, 32], metavar="SIZE")
    parser.add_argument("--accelerations", type=int, nargs="*", default=[8, 32, 100], metavar="SIZE")
    parser.add_argument("--flags", default=FLAGS)
    parser.add_argument("--repeats", type=int, default=41)
    options = parser.parse_args(argv)
    print("\n".join(described("casadi", "sympy", "scipy")))
    print(f"flags     {options.flags}; ns of an evaluation\n")
    table = rows(options.sizes, options.sparse, options.accelerations, options.flags, options.repeats)
    print("\n| | ours | CasADi | by hand | ratio | goal |\n| --- | ---: | ---: | ---: | ---: | ---: |")
    for r in table:
        cells = [f"{r[k]:.1f}" if r[k] else "" for k in ("ours_ns", "peer_ns", "hand_ns")]
        print(f"| {r['name']} | {' | '.join(cells)} | {r['ratio']:.2f} | {r['goal']} |")


if __name__ == "__main__":
    main()
