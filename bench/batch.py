"""Nanoseconds per state of mass, force and accel: called for one state at a time, and for a batch of many states.

python bench/batch.py [--states 256] [--repeats 21] [--flags="-O3 -march=native"] [--rows]

Both are timed in one process, interleaved. With --rows the beam with two shapes is compared with handwritten_batch.c.
Values have to agree to 1e-12 of the largest value; the compiler may fuse products and sums.
"""

from __future__ import annotations

import argparse
import shlex
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from bodies import dense, states
from interleaved import TimedCall, interleaved
from limited import limited
from machine import OWN_OPTION, described
from problem import beam
from rows import Row, row

import derive
from derive.backends.c.source import CBackend
from derive.ir.model import Model
from derive.runtime.compiler import compiler

FLAGS = ("-O3 -march=native", "-O3")
KERNELS = ("mass", "force", "accel")
TOLERANCE = 1e-12
HAND_FLAGS = "-O3 -march=x86-64-v3"
GOAL = 1.3
"""The largest ratio of a batch to C by hand."""
NOT_SLOWER = 1.05
"""The largest ratio of a batch to as many single calls; two measurements of one call differ by a few percent."""
BEAMS, FEW = 64, (1, 2, 4)
"""The sizes of batches of beams, beside the 8 of handwritten_batch.c."""
HERE = Path(__file__).parent


def planar(frame: str, shapes: int) -> tuple[Model, np.ndarray]:
    """The model of a beam, and its parameters."""
    model = derive.lower(derive.derive(beam(frame, shapes)))
    return model, np.array(model.defaults)


def spatial(shapes: int, frame: str, lowering: str) -> tuple[Model, np.ndarray]:
    """The model of a spatial body, and its parameters: a dense body or, in the mean frame, perturbed defaults."""
    spec = derive.symbolic_body("body", shapes, frame=frame, lowering=lowering)
    model = derive.lower(derive.derive(spec))
    if frame == "given":
        return model, derive.parameters(dense(shapes), spec)
    return model, np.array(model.defaults) + np.random.default_rng(1).uniform(0, 0.01, len(model.defaults))


FLAT = (("mean", 2), ("mean", 8), ("given", 8))
MODELS: dict[str, Callable[[], tuple[Model, np.ndarray]]] = {
    **{f"beam {f} {n}": lambda f=f, n=n: planar(f, n) for f in ("mean", "point") for n in (2, 8)},
    **{f"body {f} {n} flat": lambda f=f, n=n: spatial(n, f, "flat") for f, n in FLAT},
    **{
        f"body {f} {n} loops": lambda f=f, n=n: spatial(n, f, "loops")
        for f in ("mean", "given")
        for n in (8, 32, 100, 300)
    },
}  # fmt: skip


def timed_calls(model: Model, count: int) -> list[TimedCall]:
    """The calls of each kernel for single states (rows of q, v), and for a batch (columns of Q, V)."""
    nq, nv = sum(v.size for v in model.coordinates), sum(v.size for v in model.velocities)
    calls = []
    for kernel in KERNELS:
        size, name = model.kernel(kernel).outputs[0].size, f"{model.name}_{kernel}"
        single = f"q + s * {nq}, k" if kernel == "mass" else f"0.0, q + s * {nq}, v + s * {nv}, k"
        every = "Q, k" if kernel == "mass" else "0.0, Q, V, k"
        calls.append(TimedCall(kernel, f"{name}({single}, out);", size))
        calls.append(TimedCall(f"{kernel} batch", f"{name}_batch({count}, {every}, out);", size * count, count))
    return calls


def random_states(model: Model, count: int) -> tuple[np.ndarray, np.ndarray]:
    """q (count, nq) and v (count, nv)."""
    n = sum(v.size for v in model.coordinates)
    if model.coordinates[2].name != "phi":
        arrays = states(n - 7, count)
        return arrays["q"], arrays["v"]
    rng = np.random.default_rng(n)
    q, v = rng.uniform(-1, 1, (count, n)), rng.uniform(-1, 1, (count, n))
    q[:, 2] *= np.pi
    q[:, 3:] *= 0.1
    return q, v


def nanoseconds(model: Model, p: np.ndarray, flags: str, count: int, repeats: int, folder: Path) -> list[float]:
    """The times per state in the order of `timed_calls`. Raises ArithmeticError if a batch has other values."""
    derive.write(CBackend().files(model, "a benchmark"), folder)
    source = folder / model.name / f"{model.name}.c"
    limited([*compiler(), *shlex.split(flags), OWN_OPTION, "-w", "-c", source, "-o", source.with_suffix(".o")])
    q, v = random_states(model, count)
    calls = timed_calls(model, count)
    times, values = interleaved(
        calls,
        declare=f'#include "{source.with_suffix(".h").resolve()}"',
        once=f"if ({model.name}_setup(p, k)) return 5;",
        arrays={"p": np.append(p, 0.0), "q": q, "v": v, "Q": q.T, "V": v.T},
        scratch={"k": sum(c.size for c in model.constants) + 1},
        objects=[source.with_suffix(".o")],
        folder=folder,
        states=count,
        repeats=repeats,
    )
    for single, batch, call in zip(values[::2], values[1::2], calls[1::2], strict=True):
        error = np.max(np.abs(batch.reshape(-1, count).T - single)) / np.max(np.abs(single))
        if not error < TOLERANCE:
            raise ArithmeticError(f"{call.name} of {model.name} is off by {error:.1e}")
    return times


def beam_times(frame: str, flags: str, repeats: int, folder: Path) -> dict[str, float]:
    """The times per state of M and h and of the accelerations: `single`, and by hand and generated for some n.

    Raises ArithmeticError if the values differ.
    """
    model, p = planar(frame, 2)
    derive.write(CBackend().files(model, "a benchmark"), folder)
    source, hand = folder / model.name / f"{model.name}.c", folder / "hand.o"
    for file, target, more in (
        (source, source.with_suffix(".o"), [OWN_OPTION]),
        (HERE / "handwritten_batch.c", hand, []),
    ):
        limited([*compiler(), *shlex.split(flags), *more, "-w", "-c", file, "-o", target])
    q, v = random_states(model, BEAMS)
    blocks = {name: x.reshape(-1, 8, x.shape[1]).transpose(0, 2, 1) for name, x in (("Q8", q), ("V8", v))}
    nq, nnz = q.shape[1], model.kernel("mass").outputs[0].size
    calls = []
    for function, size, first, by_hand in (
        ("mass_force", nnz + nq, nnz, frame),
        ("accel", nq, 0, f"accel_{frame}"),
    ):
        name = f"{model.name}_{function}"
        out = {n: f"out, out + {n * first}" if first else "out" for n in (*FEW, 8, BEAMS)}
        calls.append(TimedCall(f"{function} single", f"{name}(0.0, q + s * {nq}, v + s * {nq}, k, {out[1]});", size))
        block = f"Q8 + s * {nq}, V8 + s * {nq}"
        calls.append(TimedCall(f"{function} hand", f"hand_batch_{by_hand}({block}, hand, {out[8]});", 8 * size, 8))
        calls.append(TimedCall(f"{function} 8", f"{name}_batch(8, 0.0, {block}, k, {out[8]});", 8 * size, 8))
        every = f"{name}_batch({BEAMS}, 0.0, Q, V, k, {out[BEAMS]});"
        calls.append(TimedCall(f"{function} {BEAMS}", every, size * BEAMS, BEAMS))
        for n in FEW:
            few = f"{name}_batch({n}, 0.0, q + s * {nq}, v + s * {nq}, k, {out[n]});"
            calls.append(TimedCall(f"{function} {n}", few, size * n, n))
    declared = "void hand_batch_setup(const double *, int, double *);" + "".join(
        f"void hand_batch_{kind}(const double *, const double *, const double *{outputs});"
        for kind, outputs in ((frame, ", double *, double *"), (f"accel_{frame}", ", double *"))
    )
    times, values = interleaved(
        calls,
        declare=f'#include "{source.with_suffix(".h").resolve()}"\n{declared}',
        once=f"if ({model.name}_setup(p, k)) return 5; hand_batch_setup(p, {int(frame == 'point')}, hand);",
        arrays={"p": p, "q": q, "v": v, "Q": q.T, "V": v.T, **blocks},
        scratch={"k": sum(c.size for c in model.constants), "hand": 12},
        objects=[source.with_suffix(".o"), hand],
        folder=folder,
        states=BEAMS,
        repeats=repeats,
    )
    for n in range(0, len(calls), len(calls) // 2):
        single, *batches = values[n : n + 4]
        for call, batch in zip(calls[n + 1 : n + 4], batches, strict=True):
            rows = batch.reshape(-1, single.shape[1], call.together).transpose(0, 2, 1).reshape(single.shape)
            if not np.max(np.abs(rows - single)) < TOLERANCE * np.max(np.abs(single)):
                raise ArithmeticError(f"{call.name} of {model.name}: other values")
    return dict(zip((call.name for call in calls), times, strict=True))


def rows(quick: bool = False) -> list[Row]:
    """Batches of beams per body compared with C by hand, and with as many single calls; see `rows.py`."""
    result = []
    for frame in ("mean", "point"):
        with tempfile.TemporaryDirectory(prefix="tisserand-bench-") as folder:
            times = beam_times(frame, HAND_FLAGS, 1 if quick else 51, Path(folder))
        for function, label in (("mass_force", "M and h"), ("accel", "accelerations")):
            single, hand = times[f"{function} single"], times[f"{function} hand"]
            for n in (8, BEAMS):
                name, ours = f"batch of {n} beams, {label}, per body, {frame}", times[f"{function} {n}"]
                note = f"{ours / single:.2f} of a single call, {single:.2f} ns"
                result.append(row(name, ours, peers={"single calls": single}, hand=hand, goal=GOAL, note=note))
            for n in FEW:
                name, ours = f"batch of {n} beams, {label}, per body, {frame}", times[f"{function} {n}"]
                result.append(row(name, ours, peers={"single calls": single}, goal=NOT_SLOWER))
    return result


def main(argv: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--models", nargs="+", choices=list(MODELS), default=list(MODELS), metavar="MODEL")
    parser.add_argument("--states", type=int, default=256)
    parser.add_argument("--repeats", type=int, default=21)
    parser.add_argument("--flags", action="append", help=f"may be repeated; instead of {' and '.join(FLAGS)}")
    parser.add_argument("--rows", action="store_true", help="the rows of all.py")
    options = parser.parse_args(argv)
    print("\n".join(described("casadi", "sympy")))
    if options.rows:
        print(f"flags     {HAND_FLAGS}")
        for each in rows():
            hand = f"{each['hand_ns']:8.2f}" if each["hand_ns"] else " " * 8
            figures = f"{each['ours_ns']:8.2f}{hand}{each['peer_ns']:8.2f}{each['ratio']:8.2f}"
            print(f"{each['name']:50}{figures}   {each['note']}")
        return
    print(f"figures   ns per state, alone and in a batch of {options.states} states (64 states for 100 modes and more)")
    models = {name: MODELS[name]() for name in options.models}
    with tempfile.TemporaryDirectory(prefix="tisserand-bench-") as folder:
        for flags in options.flags or FLAGS:
            print("\n" + flags.ljust(22) + "".join(f"{kernel:>10}     batch" for kernel in KERNELS))
            for name, (model, p) in models.items():
                count = min(options.states, 64) if len(p) > 10_000 else options.states
                times = nanoseconds(model, p, flags, count, options.repeats, Path(folder))
                print(name.ljust(22) + "".join(f"{t:10.2f}" for t in times), flush=True)


if __name__ == "__main__":
    main()
