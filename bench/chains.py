"""Chains of 1 to 1000 welded beams: straight-line code, loops over instances, CasADi's C, and C by hand.

python bench/chains.py [--counts 1 2 3 10 30 100 1000] [--straight-line 10] [--casadi 100] [--yardsticks FOLDER]

For each chain: CPU seconds of generation and of the compiler, the least of some, bytes of C, and nanoseconds per body
of the accelerations, alone and in a batch of eight states. All run alternately in one process, and their values agree
to 1e-12 of the largest acceleration before they are timed. FOLDER has C by hand: a3.c, b.c, tb.c and batch.c with
their headers, of which chain.h declares `par` and `par_set(par *, m, l, EI, gx, gy)`. With --write the figures go to
bench/chains.json, the picture to docs/chains.svg and the tables to bench/README.md; `--figures FILE` takes the figures
of an earlier run.
"""

from __future__ import annotations

import argparse
import json
import re
import shlex
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from chain_page import tables, write
from chain_run import ANY_GRAPH, BOTH_ENDS, CASADI, FLAT, INSTANCES, LANES, Figures, Run, read_run, write_run
from interleaved import TimedCall, interleaved
from limited import CommandResult, limited
from machine import described
from numpy.typing import NDArray

from derive.runtime.compiler import compiler

Array = NDArray[np.float64]

MODEL = Path(__file__).with_name("chain_model.py")
COUNTS = (1, 2, 3, 10, 30, 100, 1000)
FLAGS = "-O3 -march=x86-64-v3"
COMPILATIONS, SHORT = 5, 5.0
"""The compilations of a file of which the least time counts, if the first one takes fewer seconds."""
TOLERANCE = 1e-12
"""The largest difference between values, relative to the largest acceleration of a state."""
BODIES = 80
"""The number of bodies in the states of single calls, so that these stay in the first-level cache."""
BATCH = 8
"""The number of states of a batch."""
COORDINATES = 5
"""The coordinates of a beam: c1, c2, phi and those of two shapes."""
BEAM = "0.05, 0.1, 0.2, 0.0, -9.81"
"""Mass, length and bending stiffness of a beam of the example, and the components of gravity."""
HAND = {
    BOTH_ENDS: ("a3.c", "", "accel_a3"),
    LANES: ("b.c", "-DW=4 -DTWO -DNAME=hand_b", "hand_b"),
    ANY_GRAPH: ("tb.c", "-DORDER=0 -DNAME=hand_tb", "hand_tb"),
}
"""The files, options and functions of C by hand."""
HAND_BATCHES = {"hand_4": 4, "hand_8": 8}
"""The functions of batches by hand, with the number of states of a call."""
DEFINITION = re.compile(r"^static const [^;(){}]* = \{\n.*?^\};\n", re.MULTILINE | re.DOTALL)
"""The definition of a constant table in generated C: numbers, patterns, and names with their units."""


Call = tuple[TimedCall, int]
"""A call, and the number of states in a block of its values."""


@dataclass
class Program:
    """The parts of the timed program of a chain, besides its states."""

    declare: list[str] = field(default_factory=list)
    once: list[str] = field(default_factory=list)
    scratch: dict[str, int] = field(default_factory=dict)
    objects: list[Path] = field(default_factory=list)

    def times(self, calls: Sequence[Call], arrays: Mapping[str, Array], folder: Path, repeats: int) -> dict[str, float]:
        """The least CPU times (ns) per body. Raises ArithmeticError if values differ from those of the first call."""
        number, nv = arrays["q"].shape
        timed = [call for call, _ in calls]
        common: dict[str, Any] = {
            "declare": "\n".join(self.declare),
            "once": " ".join(self.once),
            "arrays": {**arrays, "p": np.zeros(1)},
            "scratch": self.scratch,
            "objects": self.objects,
            "folder": folder,
            "states": number,
            "statistic": np.min,
        }
        _, values = interleaved(timed, repeats=1, minimum=1, **common)
        first = values[0]
        for (call, width), other in zip(calls, values, strict=True):
            by_state = other.reshape(-1, nv, width).transpose(0, 2, 1).reshape(-1, nv)
            error = np.max(np.abs(by_state - first), axis=1) / np.abs(first).max(axis=1)
            if not np.all(error < TOLERANCE):
                raise ArithmeticError(f"{call.name} of {nv // COORDINATES} beams is off by {error.max():.1e}")
        times, _ = interleaved(timed, repeats=repeats, **common)
        return {call.name: t / (nv // COORDINATES) for call, t in zip(timed, times, strict=True)}


def states(count: int, number: int) -> tuple[Array, Array]:
    """Random q and v (number, nv): angles up to a radian, deflections up to a tenth of the length."""
    rng = np.random.default_rng(1)
    q = rng.uniform(-1, 1, (number, count, COORDINATES))
    q[:, :, 3:] *= 0.01
    return q.reshape(number, -1), rng.uniform(-0.1, 0.1, (number, count * COORDINATES))


def in_blocks(values: Array, width: int) -> Array:
    """The layout of batches: of each block of `width` states the elements, and of each element the states."""
    return values.reshape(-1, width, values.shape[1]).transpose(0, 2, 1)


def generated(count: int, form: str, options: argparse.Namespace, folder: Path, program: Program) -> Figures:
    """The figures of generation and compilation of a form, whose object is added to the program."""
    print(f"{count:5} {form}", flush=True, file=sys.stderr)
    made = limited([sys.executable, MODEL, str(count), form, folder], options.limit)
    if made is None:
        return Figures(count, form)
    known = json.loads(made.text)
    name, source = known["name"], folder / f"{known['name']}.c"
    text = source.read_text()
    tables = 0 if form == CASADI else sum(len(table.encode()) for table in DEFINITION.findall(text))
    figures = Figures(count, form, known["seconds"], len(text.encode()), tables, known["header"])
    done = compiled(source, options.flags, options.limit)
    if done is None:
        return figures
    again = range(COMPILATIONS - 1 if done.seconds < SHORT else 0)
    others = [compiled(source, options.flags) for _ in again]
    seconds = min(result.seconds for result in (done, *others) if result)
    program.objects.append(source.with_suffix(".o"))
    if form == CASADI:
        program.declare.append(f"int {name}(const double **, double **, long long *, double *, int);")
    else:
        state = "double, const double *, const double *, const double *, double *"
        program.declare.append(f"int {name}_setup(const double *, double *); int {name}_accel({state});")
        program.declare.append(f"int {name}_accel_batch(int, {state});")
        program.scratch[f"k_{form}"] = known["constants"] + 1
        program.once.append(f"if ({name}_setup(p, k_{form})) return 5;")
    return replace(figures, compiler=seconds, megabytes=done.megabytes)


def compiled(source: Path, flags: str, limit: float | None = None, target: Path | None = None) -> CommandResult | None:
    """The result of the compiler; None beyond the limits of time or memory."""
    command = [*compiler(), *shlex.split(flags), "-w", "-c", source, "-o", target or source.with_suffix(".o")]
    try:
        return limited(command, limit)
    except RuntimeError as error:
        print(f"{source.name}: {str(error).splitlines()[-1]}", file=sys.stderr)
        return None


def add_hand(count: int, options: argparse.Namespace, folder: Path, program: Program) -> None:
    """Add the C by hand to a program."""
    given: Path = options.yardsticks.resolve()
    parameters = folder / "parameters.c"
    set_parameters = f"void *hand_par(void) {{ par_set(&p, {BEAM}); return &p; }}"
    parameters.write_text(f'#include "chain.h"\nstatic par p;\n{set_parameters}\n')
    functions = {function: (file, more) for file, more, function in HAND.values()}
    functions |= {name: ("batch.c", f"-DW={width} -DNAME={name}") for name, width in HAND_BATCHES.items()}
    sources = [(parameters, ""), *((given / file, more) for file, more in functions.values())]
    for number, (source, more) in enumerate(sources):
        out = folder / f"hand_{number}.o"
        if compiled(source, f"{options.flags} {more} -I{shlex.quote(str(given))}", target=out) is None:
            raise RuntimeError(f"{source} does not compile")
        program.objects.append(out)
    program.declare.append("void *hand_par(void);")
    program.once.append("par = hand_par();")
    for name in functions:
        arguments = "int, const double *, const double *, void *, double *, void *"
        program.declare.append(f"int {name}({arguments}); void {name}_setup(int, void *);")
        program.once.append(f"{name}_setup({count}, par);")
    program.scratch |= {"work": 1024 * count + 16384, "par": 1}


def single_calls(count: int, forms: Sequence[str], yardsticks: bool) -> list[Call]:
    """The calls for one state, of which the first is that of the first form."""
    nv = COORDINATES * count
    state = f"q + s * {nv}, v + s * {nv}"
    texts = {form: f"chain_{form}_accel(0.0, {state}, k_{form}, out);" for form in forms}
    if CASADI in texts:
        given = f"const double *given[] = {{{state}}}; double *result[] = {{out}};"
        texts[CASADI] = f"{given} chain_{CASADI}(given, result, 0, 0, 0);"
    if yardsticks:
        texts |= {name: f"{function}({count}, {state}, par, out, work);" for name, (_, _, function) in HAND.items()}
    return [(TimedCall(name, text, nv), 1) for name, text in texts.items()]


def batch_calls(count: int, forms: Sequence[str], yardsticks: bool) -> list[Call]:
    """A call for each state, with which values are compared, and calls for all of them together."""
    nv = COORDINATES * count
    calls = single_calls(count, forms[:1], False)
    for form in forms:
        text = f"chain_{form}_accel_batch({BATCH}, 0.0, q{BATCH}, v{BATCH}, k_{form}, out);"
        calls.append((TimedCall(f"{form} batch", text, nv * BATCH, BATCH), BATCH))
    for name, width in HAND_BATCHES.items() if yardsticks else ():
        at = [str(i * width * nv) for i in range(BATCH // width)]
        text = "".join(f"{name}({count}, q{width} + {i}, v{width} + {i}, par, out + {i}, work);" for i in at)
        calls.append((TimedCall(f"{name} batch", text, nv * BATCH, BATCH), width))
    return calls


def measured(count: int, options: argparse.Namespace) -> list[Figures]:
    """The figures of all forms of a chain, and of C by hand."""
    limits = {INSTANCES: count, FLAT: options.straight_line, CASADI: options.casadi}
    program, hand = Program(), options.yardsticks is not None
    with tempfile.TemporaryDirectory(prefix="tisserand-bench-") as directory:
        folder = Path(directory)
        every = [generated(count, form, options, folder, program) for form, most in limits.items() if count <= most]
        if hand:
            add_hand(count, options, folder, program)
        forms = [figures.form for figures in every if figures.compiler is not None]
        q, v = states(count, max(1, BODIES // count))
        single = program.times(single_calls(count, forms, hand), {"q": q, "v": v}, folder, options.repeats)
        q, v = states(count, BATCH)
        arrays = {"q": q, "v": v}
        for width in {BATCH, *HAND_BATCHES.values()}:
            arrays |= {f"q{width}": in_blocks(q, width), f"v{width}": in_blocks(v, width)}
        own = [form for form in forms if form != CASADI]
        batch = program.times(batch_calls(count, own, hand), arrays, folder, options.repeats)
    every += [Figures(count, name) for name in ((*HAND, *HAND_BATCHES) if hand else ())]
    return [replace(f, ns=single.get(f.form), batch_ns=batch.get(f"{f.form} batch")) for f in every]


def main(argv: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--counts", type=int, nargs="+", default=COUNTS)
    parser.add_argument("--straight-line", type=int, default=10, help="the largest number of beams in straight line")
    parser.add_argument("--casadi", type=int, default=100, help="the largest number of beams of CasADi")
    parser.add_argument("--yardsticks", type=Path, help="the folder of C by hand")
    parser.add_argument("--flags", default=FLAGS)
    parser.add_argument("--repeats", type=int, default=81)
    parser.add_argument("--limit", type=float, default=1200.0, help="seconds of a generation or a compilation")
    parser.add_argument("--figures", type=Path, help="the figures of an earlier run, instead of a new one")
    parser.add_argument("--json", type=Path, help="write the figures to this file")
    parser.add_argument("--write", action="store_true", help="write bench/chains.json, docs/chains.svg and the tables")
    options = parser.parse_args(argv)
    if options.figures:
        run = read_run(options.figures)
    else:
        every = tuple(figures for count in options.counts for figures in measured(count, options))
        run = Run((*described("casadi", "sympy"), f"flags     {options.flags}"), every)
    print("\n".join([*run.machine, "", tables(run.figures)]))
    if options.json:
        write_run(run, options.json)
    if options.write:
        write(run)


if __name__ == "__main__":
    main()
