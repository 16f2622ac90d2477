"""Instructions and time of every kernel, for the beam in three frames: what the choice of the frame is worth.

python bench/evaluation.py [--shapes 2 4 6 8] [--flags "-O2"]

`point, orthogonal` is the point frame with its shapes made orthogonal, as those of the mean frame are.
"""

from __future__ import annotations

import argparse
import shlex
import tempfile
from pathlib import Path

from harness import Measured, Variant, measure
from machine import described, native_flags
from problem import Problem, beam, problem
from variants import ours

from derive import load

FRAMES: dict[str, tuple[str, bool | None]] = {
    "mean": ("mean", None),
    "point": ("point", None),
    "point, orthogonal": ("point", True),
}
KERNELS = ("mass", "force", "mass_force", "accel", "energy", "momentum", "residual", "jacobian")
SCALARS = {"t": "0.0", "cj": "10.0"}
ARRAYS = {"q": "q", "v": "v", "k": "k", "y": "q", "ydot": "ydot"}  # a state is [q; v] already


def variant(given: Problem, kernel: str) -> Variant:
    """A kernel of ours with a call: its inputs by name, its outputs into one array each."""
    whole = ours(given)
    found = given.model.kernel(kernel)
    inputs = [SCALARS[a.name] if a.scalar else ARRAYS[a.name] for a in found.arguments]
    outputs = [f"out_{o.name}" for o in found.outputs]
    arrays = "".join(f"\nstatic double out_{o.name}[{len(o.elements)}];" for o in found.outputs)
    function = f"{given.model.name}_{kernel}"
    return Variant(
        name=kernel,
        files=whole.files,
        function=function,
        declare=f"{whole.declare}{arrays}\nstatic const double ydot[{2 * given.inputs.nv}];",
        once=f"{whole.once}\n    (void) ydot;",
        call=f"{function}({', '.join(inputs + outputs)})",
    )


def solvable(given: Problem) -> None:
    """Raise ModelError if accel leaves early at one of the states: its count would be of another path."""
    native = load(given.files)
    k, nv = native.setup(given.inputs.p), given.inputs.nv
    for state in given.inputs.states:
        native.accel(0.0, state[:nv], state[nv:], k)


def rows(shapes: int, flags: tuple[str, ...], folder: Path) -> dict[str, list[Measured]]:
    """All kernels in all frames."""
    found = {}
    for n, (name, (frame, orthogonal)) in enumerate(FRAMES.items()):
        given = problem(beam(frame, shapes, orthogonal))
        solvable(given)
        found[name] = [
            measure(variant(given, kernel), given.inputs, flags, folder / f"{shapes}_{n}_{kernel}", None)
            for kernel in KERNELS
        ]
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--shapes", type=int, nargs="+", default=[2, 4, 6, 8])
    parser.add_argument("--flags", help="instead of -O3 -march=native")
    options = parser.parse_args()
    flags = tuple(shlex.split(options.flags)) if options.flags else native_flags()
    print("\n".join([*described("casadi", "sympy"), f"flags     {shlex.join(flags)}"]))
    print("columns   instructions (libm included) and nanoseconds an evaluation, of the call as well")
    with tempfile.TemporaryDirectory(prefix="tisserand-bench-") as folder:
        for shapes in options.shapes:
            print("\n" + f"{shapes} shapes".ljust(12) + "".join(name.rjust(22) for name in FRAMES))
            found = rows(shapes, flags, Path(folder))
            for n, kernel in enumerate(KERNELS):
                cells = [f"{found[f][n].instructions.total:9.1f} {found[f][n].nanoseconds:9.1f} ns" for f in FRAMES]
                print(kernel.ljust(12) + "".join(cell.rjust(22) for cell in cells), flush=True)


if __name__ == "__main__":
    main()
