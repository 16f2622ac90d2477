"""Generated functions of a body in space compared with C written by hand, and with the C that CasADi generates.

python bench/loops_by_hand.py [--sizes 2 8 32 100] [--sparse 8 32] [--accelerations 8 32 100] [--peer-modes 8]

All implementations of a function run alternately in one process, with one compiler and the same flags; each time is
the least of many slices. Their values are compared first. Of our own lowerings the cost model selects one, whose time
the rows have. `handwritten_body.c` computes the same outputs.
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
from machine import OWN_OPTION, described
from rows import Row, row
from scale import STATES, TOLERANCE, CSource, by_position, check_agreement, compiled, ours, peers, timed_call

import derive
from derive.backends.c.source import CBackend
from derive.lowering.cost_model import estimate_costs
from derive.mechanics.bodies.spatial_body import modal_body
from derive.runtime.compiler import compiler

HERE = Path(__file__).parent
FLAGS = "-O3 -march=x86-64-v3"
LABELS = {"mass": "M", "force": "h", "jacobian": "Jacobian"}
GOALS = {"mass": 1.1, "force": 1.1, "jacobian": 1.2, "accel": 1.1}
"""The largest ratio of our time to the time by hand."""
SPARSE_GOAL = 1.0
"""The largest ratio of our time to that of CasADi, for the sparse tables of a beam."""
MAX_PEER_MODES = {"mass": 8, "force": 32, "jacobian": 8}
"""The largest number of modes of a dense body for which CasADi is measured: beyond, gcc takes many minutes."""
FEW_MODES = 8
"""The largest number of modes of a dense body for which CasADi is measured in `all.py`: h with 32 takes gcc minutes."""
LIMIT = 600.0
"""Seconds of a derivation or a compilation."""
DECLARATIONS = """\
void hand_setup(const double *); void hand_mass(const double *, double *);
void hand_force(const double *, const double *, double *);
void hand_jacobian(const double *, const double *, double, double *);
void hand_accel(const double *, const double *, double *);
"""


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


def functions(data: str, size: int, flags: str, repeats: int, peer_modes: int, folder: Path) -> list[Row]:
    """The rows of M, h and the iteration matrix of a body: dense, or with the sparse tables of a beam.

    Straight-line code of ours and of CasADi is measured for bodies with at most `peer_modes` modes, if they are dense.
    """
    with_peers = peer_modes > 0
    few = data == "beam" or size <= min(peer_modes, max(MAX_PEER_MODES.values()))
    lowerings = ("flat", "loops") if few and with_peers else ("loops",)
    own, sizes = ours(data, size, LIMIT, folder, lowerings)
    hand = by_hand(size, flags, folder) if data == "dense" else None
    selected = estimate_costs(modal_body(BODIES[data](size), None)).lowering
    result = []
    for item, label in LABELS.items():
        few = data == "beam" or size <= min(peer_modes, MAX_PEER_MODES[item])
        sources = [s for (i, _), s in own.items() if i == item and (s.maker == selected or few)]
        sources += peers(data, size, LIMIT, folder, (item,)).values() if few and with_peers else ()
        options = {s: flags if s.maker == "casadi" else f"{flags} {OWN_OPTION}" for s in sources}
        sources = [s for s in sources if compiled(s.path, options[s], LIMIT).seconds is not None]
        times = nanoseconds(data, size, item, sources, sizes, repeats, folder, hand)
        name, goal = f"{label}, {data} body, {size} modes", GOALS[item] if hand else SPARSE_GOAL
        form = {"flat": "unrolled", "loops": "looped"}
        note = ", ".join([f"{form[selected]} as selected", *(f"{form[k]} {times[k]:.0f}" for k in form if k in times)])
        others = {"CasADi": times["casadi"]} if "casadi" in times else {}
        result.append(row(name, times[selected], peers=others, hand=times.get("hand"), goal=goal, note=note))
    return result


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
    for lowering in sorted({s.maker for s in sources} - {"casadi"}):
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
    loops = next((k for k, s in enumerate(sources) if s.maker == "loops"), None)
    if hand and loops is not None:
        declare.append(DECLARATIONS)
        once.append("hand_setup(p_loops);")
        objects.append(hand)
        calls.append(hand_call(item, size, sources[loops].size))
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
    if hand and loops is not None:
        check(f"{item} by hand", values[-1], values[loops])
    return {call.name: t for call, t in zip(calls, times, strict=True)}


def check(name: str, values: np.ndarray, others: np.ndarray) -> None:
    """Raise ArithmeticError if values differ from others, relative to the largest."""
    error = np.max(np.abs(values - others)) / np.max(np.abs(others))
    if not error < TOLERANCE:
        raise ArithmeticError(f"{name} is off by {error:.1e}")


def accelerations(size: int, flags: str, repeats: int, folder: Path) -> Row:
    """The row of the accelerations in the mean frame, where c8 is the unit matrix."""
    model = derive.lower(derive.derive(derive.symbolic_body("body", size, frame="mean", lowering="loops")))
    derive.write(CBackend().files(model, "a benchmark"), folder)
    source = folder / "body" / "body.c"
    target = source.with_suffix(".o")
    limited([*compiler(), *shlex.split(flags), OWN_OPTION, "-w", "-c", str(source), "-o", str(target)])
    state = f"q + s * {7 + size}, v + s * {6 + size}"
    texts = {"ours": f"body_accel(0.0, {state}, k, out);", "hand": f"hand_accel({state}, out);"}
    rng = np.random.default_rng(size)
    (own, hand), (values, others) = interleaved(
        [TimedCall(maker, call, 6 + size) for maker, call in texts.items()],
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
    check("accelerations by hand", others, values)
    return row(f"accelerations, c8 = I, {size} modes", own, hand=hand, goal=GOALS["accel"], note="looped")


def rows(
    sizes: Sequence[int] = (2, 8, 32, 100),
    sparse: Sequence[int] = (8, 32),
    accels: Sequence[int] = (8, 32, 100),
    flags: str = FLAGS,
    repeats: int = 41,
    peer_modes: int = FEW_MODES,
    quick: bool = False,
) -> list[Row]:
    """The rows of bodies in space, see `rows.py`. quick: a small body, without CasADi, once."""
    if quick:
        sizes, sparse, accels, flags, repeats, peer_modes = (5,), (), (5,), "-O1", 1, 0
    result: list[Row] = []
    with tempfile.TemporaryDirectory(prefix="tisserand-bench-") as folder:
        for data, counts in (("dense", sizes), ("beam", sparse)):
            for size in counts:
                result += functions(data, size, flags, repeats, peer_modes, Path(folder))
        result += [accelerations(size, flags, repeats, Path(folder)) for size in accels]
    return result


def main(argv: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sizes", type=int, nargs="*", default=[2, 8, 32, 100])
    parser.add_argument("--sparse", type=int, nargs="*", default=[8, 32], metavar="SIZE")
    parser.add_argument("--accelerations", type=int, nargs="*", default=[8, 32, 100], metavar="SIZE")
    parser.add_argument("--flags", default=FLAGS)
    parser.add_argument("--repeats", type=int, default=41)
    most = max(MAX_PEER_MODES.values())
    parser.add_argument("--peer-modes", type=int, default=FEW_MODES, help=f"of dense bodies by CasADi, at most {most}")
    options = parser.parse_args(argv)
    print("\n".join(described("casadi", "sympy", "scipy")))
    print(f"flags     {options.flags}; ns of an evaluation\n")
    print("| | ours | CasADi | by hand | ratio | goal |\n| --- | ---: | ---: | ---: | ---: | ---: |")
    sizes = (options.sizes, options.sparse, options.accelerations)
    for r in rows(*sizes, options.flags, options.repeats, options.peer_modes):
        cells = [f"{r[k]:.4g}" if r[k] else "" for k in ("ours_ns", "peer_ns", "hand_ns")]
        ratio = f"{r['ratio']:.2f}" if r["ratio"] else ""
        print(f"| {r['name']} ({r['note']}) | {' | '.join(cells)} | {ratio} | {r['goal']} |", flush=True)


if __name__ == "__main__":
    main()
