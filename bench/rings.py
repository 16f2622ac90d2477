"""Rings of welded beams: accelerations in loops over instances, compared with C by hand in three elimination orders.

python bench/rings.py [--counts 10 100] [--yardsticks FOLDER] [--repeats 81]

Each ring is a chain of the beams of examples/chain_100.toml without the ground and without gravity, whose last beam is
welded to the first one. FOLDER has C by hand, tb.c, see chains.py. All run alternately in one process, and their values
agree, as in chains.py; the table has nanoseconds per beam, the least of the slices.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Sequence
from pathlib import Path

from chain_scene import chain
from chains import COORDINATES, FLAGS, Call, Program, compiled, states
from interleaved import TimedCall
from machine import described

import derive
from derive.backends.c.source import CBackend
from derive.lowering.instances.lower import lower_instances
from derive.mechanics.multibody.mechanism import Mechanism

OURS = "instances"
ORDERS = {"one after the other": 0, "from both ends": 1, "in rounds": 2}
"""The elimination orders of the C by hand, with their numbers there."""
BEAM = "0.05, 0.1, 0.2, 0.0, 0.0"


def times(count: int, options: argparse.Namespace) -> dict[str, float]:
    """Nanoseconds per beam of a ring."""
    program = Program()
    with tempfile.TemporaryDirectory(prefix="tisserand-bench-") as directory:
        folder = Path(directory)
        calls = [ours(count, options, folder, program)]
        if options.yardsticks:
            calls += by_hand(count, options, folder, program)
        q, v = states(count, max(1, 80 // count))
        return program.times(calls, {"q": 0.3 * q, "v": v}, folder, options.repeats)


def added(source: Path, flags: str, program: Program) -> None:
    """Add the object of a source to a program. Raises RuntimeError if it does not compile."""
    target = source.parent / f"{len(program.objects)}.o" if source.parent.name.startswith("tisserand") else None
    if compiled(source, flags, target=target) is None:
        raise RuntimeError(f"{source} does not compile")
    program.objects.append(target or source.with_suffix(".o"))


def ours(count: int, options: argparse.Namespace, folder: Path, program: Program) -> Call:
    """The call of our accelerations."""
    mechanism = derive.derive(chain(count, f"ring_{count}", closed=True))
    assert isinstance(mechanism, Mechanism)
    header, source = CBackend().files(lower_instances(mechanism), "a benchmark")
    (folder / f"ring_{count}.h").write_text(header.text)
    path = folder / f"ring_{count}.c"
    path.write_text(source.text)
    added(path, options.flags, program)
    program.declare.append(f'#include "ring_{count}.h"')
    nv = COORDINATES * count
    return TimedCall(OURS, f"ring_{count}_accel(0.0, q + s * {nv}, v + s * {nv}, p, out);", nv), 1


def by_hand(count: int, options: argparse.Namespace, folder: Path, program: Program) -> list[Call]:
    """The calls of the C by hand."""
    given = options.yardsticks.resolve()
    parameters = folder / "parameters.c"
    parameters.write_text(
        f'#include "chain.h"\nstatic par p;\nvoid *hand_par(void) {{ par_set(&p, {BEAM}); return &p; }}\n'
    )
    added(parameters, f"{options.flags} -I{given}", program)
    program.declare.append("void *hand_par(void);")
    program.once.append("par = hand_par();")
    program.scratch |= {"par": 1}
    nv = COORDINATES * count
    calls: list[Call] = []
    for name, order in ORDERS.items():
        function = f"hand_ring_{order}"
        wrapper = folder / f"{function}.c"
        wrapper.write_text(f'#define ORDER {order}\n#define MODE 2\n#define NAME {function}\n#include "tb.c"\n')
        added(wrapper, f"{options.flags} -I{given}", program)
        arguments = "int, const double *, const double *, void *, double *, void *"
        program.declare.append(f"int {function}({arguments}); void {function}_setup(int, void *);")
        program.once.append(f"{function}_setup({count}, par);")
        calls.append((TimedCall(name, f"{function}({count}, q + s * {nv}, v + s * {nv}, par, out, 0);", nv), 1))
    return calls


def main(argv: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--counts", type=int, nargs="+", default=[10, 100])
    parser.add_argument("--yardsticks", type=Path, help="the folder of C by hand")
    parser.add_argument("--flags", default=FLAGS)
    parser.add_argument("--repeats", type=int, default=81)
    options = parser.parse_args(argv)
    print("\n".join([*described("casadi", "sympy"), f"flags     {options.flags}", ""]))
    names = [OURS, *(ORDERS if options.yardsticks else ())]
    print("| beams |", " | ".join(names), "| ratio |" if options.yardsticks else "|")
    print("| ---: |", " | ".join("---:" for _ in names), "| ---: |" if options.yardsticks else "|")
    for count in options.counts:
        of = times(count, options)
        ratio = f" {of[OURS] / min(of[name] for name in ORDERS):.2f} |" if options.yardsticks else ""
        print(f"| {count} |", " | ".join(f"{of[name]:.1f}" for name in names), f"|{ratio}")


if __name__ == "__main__":
    main()
