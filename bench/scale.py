"""Spatial bodies with 2 to 300 modes: both lowerings, compared with the C that CasADi generates for (15).

python bench/scale.py [--sizes 2 8 32 100 300] [--data dense beam] [--limit 600] [--flags="-O3 -march=native"]

For M, h and the iteration matrix: seconds to derive and to write C, operations, size of the C, seconds and memory of
the compiler, nanoseconds of an evaluation. All are timed in one process, interleaved. Each step is limited to `--limit`
seconds and 8 GB; above 100 modes only loops are measured. In addition: accelerations compared with LAPACK, and the
constants of derive/lowering/cost_model.py.
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
from interleaved import TimedCall, interleaved
from limited import CommandResult, limited
from machine import described

from derive.runtime.compiler import compiler

HERE = Path(__file__).parent
ITEMS = ("mass", "force", "jacobian")
FLAGS = ("-O3 -march=native", "-O2")
MAX_FLAT_MODES = 100
"""The largest number of modes for which straight-line code is measured."""
STATES = 8
TOLERANCE = 1e-12
FULL_TABLES = 10
"""The number of full tables of the dense body: six of C5, three of c7, and K."""


@dataclass(frozen=True)
class CSource:
    """A generated C file.

    maker: "flat", "loops" or "casadi". seconds: the time of generation. operations: those of an evaluation. size: the
    number of output values. written: the bytes of the function.
    """

    maker: str
    path: Path
    seconds: float
    operations: int
    size: int
    written: int


@dataclass(frozen=True)
class Compiled:
    """The time (s) and memory (MB) of a compiler, and the time (ns) of an evaluation; None beyond the limits."""

    seconds: float | None
    megabytes: float
    nanoseconds: float | None = None


Measured = dict[tuple[str, str, int, str, str], tuple[CSource, Compiled]]
"""Results by body, item, number of modes, maker and flags."""


def derived(script: str, data: str, size: int, what: str, folder: Path, limit: float) -> CommandResult | None:
    """The result of a script that generates C; None, and a message, if it fails or exceeds the limit."""
    try:
        result = limited([sys.executable, HERE / script, data, str(size), what, folder], limit)
        reason = "not within the limit"
    except RuntimeError as error:
        result, reason = None, str(error).splitlines()[-1]
    if result is None:
        print(f"{data:6}{size:4} {what:9} {script.removesuffix('.py'):7} derivation: {reason}", flush=True)
    return result


def ours(
    data: str, size: int, limit: float, folder: Path, lowerings: Sequence[str] = ("flat", "loops")
) -> tuple[dict[tuple[str, str], CSource], dict[str, int]]:
    """The generated C by item and lowering, with the seconds of all functions together, and the sizes of k."""
    sources, sizes = {}, {}
    for lowering in lowerings:
        if lowering == "flat" and size > MAX_FLAT_MODES:
            continue
        result = derived("own.py", data, size, lowering, folder, limit)
        if result is None:
            continue
        figures = json.loads(result.text)
        sizes[lowering] = figures["nk"]
        for item in ITEMS:
            f, path = figures[item], folder / f"own_{lowering}_{item}.c"
            seconds = figures["seconds"]
            sources[item, lowering] = CSource(lowering, path, seconds, f["operations"], f["size"][0], f["bytes"])
    return sources, sizes


def peers(
    data: str, size: int, limit: float, folder: Path, items: Sequence[str] = ITEMS
) -> dict[tuple[str, str], CSource]:
    """The C of CasADi by item and maker."""
    sources = {}
    for item in items if size <= MAX_FLAT_MODES else ():
        result = derived("matrix_form.py", data, size, item, folder, limit)
        if result is None:
            continue
        f, path = json.loads(result.text), folder / f"casadi_{item}.c"
        sources[item, "casadi"] = CSource("casadi", path, f["seconds"], f["operations"], f["size"], f["bytes"])
    return sources


def compiled(source: Path, flags: str, limit: float | None = None) -> Compiled:
    """Compile a C file to an object file beside it."""
    command = [*compiler(), *shlex.split(flags), "-w", "-c", source, "-o", source.with_suffix(".o")]
    try:
        result = limited(command, limit)
    except RuntimeError as error:
        print(f"{source.name}, {flags}: {str(error).splitlines()[-1]}", flush=True)
        result = None
    return Compiled(None, 0.0) if result is None else Compiled(result.seconds, result.megabytes)


def timed_call(item: str, maker: str, size: int, count: int) -> tuple[str, TimedCall]:
    """The declaration and the call of a function; the rows of q, v, y, ydot are states."""
    q, v, y = 7 + size, 6 + size, 13 + 2 * size
    if maker == "casadi":
        name = f"casadi_{item}"
        inputs = [f"q + s * {q}", f"v + s * {v}", f"ydot + s * {y}, &cj"][: ITEMS.index(item) + 1]
        call = f"const double *arg[] = {{{', '.join(inputs)}, parameters}}; double *res[] = {{out}}; "
        call += f"{name}(arg, res, 0, work, 0);"
        return f"int {name}(const double **, double **, long long *, double *, int);", TimedCall(maker, call, count)
    name, k = f"own_{maker}_{item}", f"k_{maker}"
    calls = {
        "mass": f"{name}(q + s * {q}, {k}, out);",
        "force": f"{name}(0.0, q + s * {q}, v + s * {v}, {k}, out);",
        "jacobian": f"{name}(0.0, y + s * {y}, ydot + s * {y}, cj, {k}, out);",
    }
    return f"int {name}();", TimedCall(maker, calls[item], count)


def nanoseconds(
    data: str, size: int, item: str, sources: list[CSource], sizes: dict[str, int], repeats: int, folder: Path
) -> dict[str, float]:
    """The times (ns) of an evaluation by maker. Raises ArithmeticError if the values differ."""
    pairs = [timed_call(item, s.maker, size, s.size) for s in sources]
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
        [call for _, call in pairs],
        declare="\n".join(declare),
        once=" ".join(once),
        arrays=arrays,
        scratch=scratch,
        objects=objects,
        folder=folder,
        states=STATES,
        repeats=repeats,
    )
    check_agreement([by_position(s, item, v, folder) for s, v in zip(sources, values, strict=True)], sources)
    return {s.maker: t for s, t in zip(sources, times, strict=True)}


def by_position(source: CSource, item: str, values: np.ndarray, folder: Path) -> dict[tuple[int, int], np.ndarray]:
    """The stored values (states,) by row and column; all others are zero."""
    if item == "force":
        return {(i, 0): values[:, i] for i in range(values.shape[1])}
    prefix = "casadi" if source.maker == "casadi" else f"own_{source.maker}"
    shape = np.load(folder / f"{prefix}_{item}.npz")
    return {(int(i), int(j)): values[:, n] for n, (i, j) in enumerate(zip(shape["row"], shape["col"], strict=True))}


def check_agreement(results: list[dict[tuple[int, int], np.ndarray]], sources: list[CSource]) -> None:
    """Raise ArithmeticError if the values of two sources differ, relative to the largest value of a state."""
    first, zeros = results[0], np.zeros(STATES)
    scale = np.max(np.abs(list(first.values())), axis=0)
    for other, source in zip(results[1:], sources[1:], strict=True):
        for entry in first.keys() | other.keys():
            error = np.abs(first.get(entry, zeros) - other.get(entry, zeros)) / scale
            if not np.all(error < TOLERANCE):
                raise ArithmeticError(f"{source.path.name}: {entry} is off by {error.max():.1e}")


def measure(data: str, size: int, options: argparse.Namespace, folder: Path, measured: Measured) -> None:
    """Measure all items of a body, and print each result."""
    own, sizes = ours(data, size, options.limit, folder)
    every = {**peers(data, size, options.limit, folder), **own}
    for item in ITEMS:
        sources = [s for (i, _), s in every.items() if i == item]
        rows: dict[str, list[str]] = {
            s.maker: [f"{s.seconds:8.2f}{s.operations:10}{s.written / 1024:9.1f}"] for s in sources
        }
        for flags in options.flags:
            costs = {s.maker: compiled(s.path, flags, options.limit) for s in sources}
            successful = [s for s in sources if costs[s.maker].seconds is not None]
            times = nanoseconds(data, size, item, successful, sizes, options.repeats, folder) if successful else {}
            for s in sources:
                cost = costs[s.maker]
                figures = Compiled(cost.seconds, cost.megabytes, times.get(s.maker))
                measured[data, item, size, s.maker, flags] = s, figures
                rows[s.maker].append(cell(figures))
        for maker, cells in rows.items():
            print(f"{data:6}{size:4} {item:9} {maker:7}" + "".join(cells), flush=True)


def cell(cost: Compiled) -> str:
    """The cell of a table with these figures."""
    if cost.seconds is None or cost.nanoseconds is None:
        return "  not within the limits "
    return f"{cost.seconds:8.2f}{cost.megabytes:6.0f}{cost.nanoseconds:10.1f}"


def constants(measured: Measured, flags: str) -> list[str]:
    """The constants of derive/lowering/cost_model.py for the time of h (ns), fitted to the measurements."""
    lines = []
    results = [
        (key, s, c) for key, (s, c) in measured.items() if key[1] == "force" and key[4] == flags and c.nanoseconds
    ]
    for (data, _, size, maker, _), source, cost in results:
        if maker == "flat":
            lines.append(f"straight line, {data} {size}: {cost.nanoseconds / source.operations:.3f} ns per operation")
    loops = [
        (size, c.nanoseconds) for (data, _, size, maker, _), _, c in results if (data, maker) == ("dense", "loops")
    ]
    fitted = [pair for pair in loops if pair[0] <= MAX_FLAT_MODES]  # larger tables are in slower memory
    if len(fitted) > 2:
        n, t = np.array(fitted).T
        terms = np.stack([np.ones_like(n), n, 2 * FULL_TABLES * n**2], axis=1)
        fixed, shape, operation = np.linalg.lstsq(terms / t[:, None], np.ones_like(t), rcond=None)[0]
        lines.append(f"loops: {fixed:.0f} ns, {shape:.2f} ns per mode, {operation:.4f} ns per operation")
        lines += [
            f"  {int(a)} modes: {b:.0f} ns, predicted {c:.0f}"
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
    print(
        "columns   seconds to derive and write (flat, loops: all functions together), operations, kB of C; for each of"
    )
    print(f"          {', '.join(options.flags)}: seconds and MB of the compiler, ns per evaluation\n")
    measured: Measured = {}
    with tempfile.TemporaryDirectory(prefix="tisserand-bench-") as folder:
        for data in options.data:
            for size in options.sizes:
                measure(data, size, options, Path(folder), measured)
        for flags in options.flags:
            if lines := constants(measured, flags):
                print(f"\nconstants of h, {flags}\n" + "\n".join(lines))
        for flags in options.flags if options.accelerations else ():
            print(f"\naccelerations in the mean frame, c8 = I, {flags}: ns")
            for size in options.accelerations:
                for name, ns in accelerations(size, flags, options.repeats, Path(folder)).items():
                    print(f"{size:4} {name:44}{ns:10.0f}", flush=True)


if __name__ == "__main__":
    main()
