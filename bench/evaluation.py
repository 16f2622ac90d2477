"""Instructions and time of every kernel of the beam in three frames, which shows the effect of the choice of frame.

python bench/evaluation.py [--shapes 2 4 6 8] [--flags "-O2"]

`point, orthogonal` is the point frame with orthogonal shape functions, which the mean frame always has.
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
    """A generated kernel, with a call that passes its inputs by name and stores each output in an array."""
    all_kernels = ours(given)
    generated = given.model.kernel(kernel)
    inputs = [SCALARS[a.name] if a.scalar else ARRAYS[a.name] for a in generated.arguments]
    outputs = [f"out_{o.name}" for o in generated.outputs]
    arrays = "".join(f"\nstatic double out_{o.name}[{len(o.elements)}];" for o in generated.outputs)
    function = f"{given.model.name}_{kernel}"
    return Variant(
        name=kernel,
        files=all_kernels.files,
        function=function,
        declare=f"{all_kernels.declare}{arrays}\nstatic const double ydot[{2 * given.inputs.nv}];",
        once=f"{all_kernels.once}\n    (void) ydot;",
        call=f"{function}({', '.join(inputs + outputs)})",
    )


def solvable(given: Problem) -> None:
    """Raise ModelError if accel returns early in a state, in which case its instructions are not representative."""
    native = load(given.files)
    k, nv = native.setup(given.inputs.p), given.inputs.nv
    for state in given.inputs.states:
        native.accel(0.0, state[:nv], state[nv:], k)


def rows(shapes: int, flags: tuple[str, ...], folder: Path) -> dict[str, list[Measured]]:
    """The results of all kernels, by frame."""
    results = {}
    for n, (name, (frame, orthogonal)) in enumerate(FRAMES.items()):
        given = problem(beam(frame, shapes, orthogonal))
        solvable(given)
        results[name] = [
            measure(variant(given, kernel), given.inputs, flags, folder / f"{shapes}_{n}_{kernel}", None)
            for kernel in KERNELS
        ]
    return results


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--shapes", type=int, nargs="+", default=[2, 4, 6, 8])
    parser.add_argument("--flags", help="instead of -O3 -march=native")
    options = parser.parse_args()
    flags = tuple(shlex.split(options.flags)) if options.flags else native_flags()
    print("\n".join([*described("casadi", "sympy"), f"flags     {shlex.join(flags)}"]))
    print("columns   instructions (libm included) and nanoseconds of an evaluation, including the call")
    with tempfile.TemporaryDirectory(prefix="tisserand-bench-") as folder:
        for shapes in options.shapes:
            print("\n" + f"{shapes} shapes".ljust(12) + "".join(name.rjust(22) for name in FRAMES))
            results = rows(shapes, flags, Path(folder))
            for n, kernel in enumerate(KERNELS):
                cells = [f"{results[f][n].instructions.total:9.1f} {results[f][n].nanoseconds:9.1f} ns" for f in FRAMES]
                print(kernel.ljust(12) + "".join(cell.rjust(22) for cell in cells), flush=True)


if __name__ == "__main__":
    main()
