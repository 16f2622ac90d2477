"""Bodies in space from 2 shapes to 300: our two ways of lowering against CasADi's C for (15).

python bench/scale.py [--sizes 2 8 32 100 300] [--data dense beam] [--limit 600] [--flags="-O3 -march=native"]

For M, h and the iteration matrix: seconds to derive and to write C, operations, size of the C, seconds and memory of
the compiler, nanoseconds of an evaluation. Ours and CasADi's are timed in one process, in turns. Every step may take
`--limit` seconds and 8 GB; above 100 shapes our loops stand alone. Then our accelerations against LAPACK's, and the
constants of derive/kernel/choice.py.
"""

from __future__ import annotations

import argparse
import json
import shlex
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from accelerations import accelerations
from bodies import BODIES, states
from interleaved import Way, interleaved
from limited import Done, limited
from machine import described

from derive.runtime.compiler import compiler

HERE = Path(__file__).parent
ITEMS = ("mass", "force", "jacobian")
FLAGS = ("-O3 -march=native", "-O2")
ALONE = 100
"""Shapes above which no straight line is tried."""
STATES = 8
TOLERANCE = 1e-12
TABLES = 10
"""Full tables of the dense body: six of C5, three of c7, and K."""


@dataclass(frozen=True)
class Source:
    """A C file that was made: what made it, in what time, of how many operations."""

    maker: str
    path: Path
    seconds: float
    operations: int
    size: int
    written: int


@dataclass(frozen=True)
class Compiled:
    """What a compiler took; nothing where it took too much, and then no time of an evaluation either."""

    seconds: float | None
    megabytes: float
    nanoseconds: float | None = None


Measured = dict[tuple[str, str, int, str, str], tuple[Source, Compiled]]
"""By data, item, shapes, maker and flags."""


def derived(script: str, data: str, size: int, what: str, folder: Path, limit: float) -> Done | None:
    """Run a script that writes C; say so if it fails or takes too long."""
    try:
        done = limited([sys.executable, HERE / script, data, str(size), what, folder], limit)
        said = "not within the limit"
    except RuntimeError as error:
        done, said = None, str(error).splitlines()[-1]
    if done is None:
        print(f"{data:6}{size:4} {what:9} {script.removesuffix('.py'):7} derivation: {said}", flush=True)
    return done


def ours(data: str, size: int, limit: float, folder: Path) -> tuple[dict[tuple[str, str], Source], dict[str, int]]:
    """Both lowerings; the seconds are those of all functions together. Also the sizes of k."""
    found, sizes = {}, {}
    for lowering in ("flat", "table"):
        if lowering == "flat" and size > ALONE:
            continue
        done = derived("own.py", data, size, lowering, folder, limit)
        if done is None:
            continue
        told = json.loads(done.text)
        sizes[lowering] = told["nk"]
        for item in ITEMS:
            t, path = told[item], folder / f"own_{lowering}_{item}.c"
            found[item, lowering] = Source(lowering, path, told["seconds"], t["operations"], t["size"][0], t["bytes"])
    return found, sizes


def peers(data: str, size: int, limit: float, folder: Path) -> dict[tuple[str, str], Source]:
    """CasADi, item by item."""
    found = {}
    for item in ITEMS if size <= ALONE else ():
        done = derived("matrix_form.py", data, size, item, folder, limit)
        if done is None:
            continue
        t, path = json.loads(done.text), folder / f"casadi_{item}.c"
        found[item, "casadi"] = Source("casadi", path, t["seconds"], t["operations"], t["size"], t["bytes"])
    return found


def compiled(source: Path, flags: str, limit: float | None = None) -> Compiled:
    """Make an object file beside a C file."""
    command = [*compiler(), *shlex.split(flags), "-w", "-c", source, "-o", source.with_suffix(".o")]
    try:
        done = limited(command, limit)
    except RuntimeError as error:
        print(f"{source.name}, {flags}: {str(error).splitlines()[-1]}", flush=True)
        done = None
    return Compiled(None, 0.0) if done is None else Compiled(done.seconds, done.megabytes)


def way(item: str, maker: str, size: int, count: int) -> tuple[str, Way]:
    """The declaration and the call of a function; q, v, y, ydot hold a state in a row."""
    q, v, y = 7 + size, 6 + size, 13 + 2 * size
    if maker == "casadi":
        name = f"casadi_{item}"
        inputs = [f"q + s * {q}", f"v + s * {v}", f"ydot + s * {y}, &cj"][: ITEMS.index(item) + 1]
        call = f"const double *arg[] = {{{', '.join(inputs)}, parameters}}; double *res[] = {{out}}; "
        call += f"{name}(arg, res, 0, work, 0);"
        return f"int {name}(const double **, double **, long long *, double *, int);", Way(maker, call, count)
    name, k = f"own_{maker}_{item}", f"k_{maker}"
    calls = {
        "mass": f"{name}(q + s * {q}, {k}, out);",
        "force": f"{name}(0.0, q + s * {q}, v + s * {v}, {k}, out);",
        "jacobian": f"{name}(0.0, y + s * {y}, ydot + s * {y}, cj, {k}, out);",
    }
    return f"int {name}();", Way(maker, calls[item], count)


def nanoseconds(
    data: str, size: int, item: str, sources: list[Source], sizes: dict[str, int], repeats: int, folder: Path
) -> dict[str, float]:
    """Time them in turns, when their values agree."""
    pairs = [way(item, s.maker, size, s.size) for s in sources]
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
    times, values = interleaved(
        [w for _, w in pairs],
        declare="\n".join(declare),
        once=" ".join(once),
        arrays=arrays,
        scratch=scratch,
        objects=objects,
        folder=folder,
        states=STATES,
        repeats=repeats,
    )
    agree([placed(s, item, v, folder) for s, v in zip(sources, values, strict=True)], sources)
    return {s.maker: t for s, t in zip(sources, times, strict=True)}


def placed(source: Source, item: str, values: np.ndarray, folder: Path) -> dict[tuple[int, int], np.ndarray]:
    """Values of all states by row and column; what is not stored is zero."""
    if item == "force":
        return {(i, 0): values[:, i] for i in range(values.shape[1])}
    prefix = "casadi" if source.maker == "casadi" else f"own_{source.maker}"
    shape = np.load(folder / f"{prefix}_{item}.npz")
    return {(int(i), int(j)): values[:, n] for n, (i, j) in enumerate(zip(shape["row"], shape["col"], strict=True))}


def agree(found: list[dict[tuple[int, int], np.ndarray]], sources: list[Source]) -> None:
    """All ways give the same, relative to the largest value of a state. Raises ArithmeticError."""
    first, nothing = found[0], np.zeros(STATES)
    scale = np.max(np.abs(list(first.values())), axis=0)
    for other, source in zip(found[1:], sources[1:], strict=True):
        for place in first.keys() | other.keys():
            error = np.abs(first.get(place, nothing) - other.get(place, nothing)) / scale
            if not np.all(error < TOLERANCE):
                raise ArithmeticError(f"{source.path.name}: {place} is off by {error.max():.1e}")


def measure(data: str, size: int, options: argparse.Namespace, folder: Path, measured: Measured) -> None:
    """All items of one body, printed as they come."""
    own, sizes = ours(data, size, options.limit, folder)
    every = {**peers(data, size, options.limit, folder), **own}
    for item in ITEMS:
        sources = [s for (i, _), s in every.items() if i == item]
        rows: dict[str, list[str]] = {
            s.maker: [f"{s.seconds:8.2f}{s.operations:10}{s.written / 1024:9.1f}"] for s in sources
        }
        for flags in options.flags:
            costs = {s.maker: compiled(s.path, flags, options.limit) for s in sources}
            there = [s for s in sources if costs[s.maker].seconds is not None]
            times = nanoseconds(data, size, item, there, sizes, options.repeats, folder) if there else {}
            for s in sources:
                cost = costs[s.maker]
                known = Compiled(cost.seconds, cost.megabytes, times.get(s.maker))
                measured[data, item, size, s.maker, flags] = s, known
                rows[s.maker].append(cell(known))
        for maker, cells in rows.items():
            print(f"{data:6}{size:4} {item:9} {maker:7}" + "".join(cells), flush=True)


def cell(cost: Compiled) -> str:
    if cost.seconds is None or cost.nanoseconds is None:
        return "  not within the limits "
    return f"{cost.seconds:8.2f}{cost.megabytes:6.0f}{cost.nanoseconds:10.1f}"


def constants(measured: Measured, flags: str) -> list[str]:
    """What derive/kernel/choice.py foresees, measured anew: nanoseconds of h."""
    lines = []
    found = [(key, s, c) for key, (s, c) in measured.items() if key[1] == "force" and key[4] == flags and c.nanoseconds]
    for (data, _, size, maker, _), source, cost in found:
        if maker == "flat":
            lines.append(f"straight line, {data} {size}: {cost.nanoseconds / source.operations:.3f} ns an operation")
    loops = [(size, c.nanoseconds) for (data, _, size, maker, _), _, c in found if (data, maker) == ("dense", "table")]
    fitted = [pair for pair in loops if pair[0] <= ALONE]  # tables of more shapes lie in slower memory
    if len(fitted) > 2:
        n, t = np.array(fitted).T
        terms = np.stack([np.ones_like(n), n, 2 * TABLES * n**2], axis=1)
        fixed, shape, operation = np.linalg.lstsq(terms / t[:, None], np.ones_like(t), rcond=None)[0]
        lines.append(f"loops: {fixed:.0f} ns, {shape:.2f} ns a shape, {operation:.4f} ns an operation of a table")
        lines += [
            f"  {int(a)} shapes: {b:.0f} ns, so foreseen {c:.0f}"
            for a, b, c in zip(n, t, terms @ [fixed, shape, operation], strict=True)
        ]
    return lines


def main(argv: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sizes", type=int, nargs="*", default=[2, 8, 32, 100, 300])
    parser.add_argument("--data", nargs="+", choices=list(BODIES), default=list(BODIES))
    parser.add_argument("--limit", type=float, default=600.0, help="seconds of a derivation or a compilation")
    parser.add_argument("--flags", action="append", help=f"may be repeated; instead of {' and '.join(FLAGS)}")
    parser.add_argument("--repeats", type=int, default=21)
    parser.add_argument("--accelerations", type=int, nargs="*", default=[8, 32, 100], metavar="SIZE")
    options = parser.parse_args(argv)
    options.flags = options.flags or list(FLAGS)
    print("\n".join(described("casadi", "sympy", "scipy")))
    print("columns   seconds to derive and write (ours: all functions at once), operations, kB of C; for each of")
    print(f"          {', '.join(options.flags)}: seconds and MB of the compiler, ns an evaluation\n")
    measured: Measured = {}
    with tempfile.TemporaryDirectory(prefix="tisserand-bench-") as folder:
        for data in options.data:
            for size in options.sizes:
                measure(data, size, options, Path(folder), measured)
        for flags in options.flags:
            if found := constants(measured, flags):
                print(f"\nconstants of h, {flags}\n" + "\n".join(found))
        for flags in options.flags if options.accelerations else ():
            print(f"\naccelerations in the mean frame, c8 = I, {flags}: ns")
            for size in options.accelerations:
                for name, ns in accelerations(size, flags, options.repeats, Path(folder)).items():
                    print(f"{size:4} {name:44}{ns:10.0f}", flush=True)


if __name__ == "__main__":
    main()
