"""Which lowering of a mechanism evaluates its accelerations faster: as measured, and as the cost model predicts.

python bench/lowerings.py [FILE ...] [--chains 2 3 4 6 8 10 12] [--corpus 33 166 ...] [--graphs 0 5 ...]
                          [--space 0 1 ...] [--rows 0 1 ...] [--held-out] [--flags FLAGS]

Straight-line code and loops over instances of the same scene run alternately in one process, and their values agree to
1e-9 of the largest acceleration before they are timed; the least CPU time counts. The chains are welded and pinned
beams with two shapes; without files those of `scenes` and `examples` are measured. --corpus, --graphs: seeds of random
scenes of the tests; those of the corpus from 2000 on are in space. --space: seeds of graphs of rigid bodies in space.
--rows: seeds of rows of finite-element bodies. --held-out: `HELD_OUT` alone, which no constant of the cost model was
fitted to. Prints a table of Markdown, and what the choices have cost.
"""

from __future__ import annotations

import argparse
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from interleaved import TimedCall, interleaved
from limited import limited
from machine import OWN_OPTION, described
from numpy.typing import NDArray
from space_scenes import graph_of_rigid_bodies, row_of_flexible_bodies

import derive
from derive.backends.c.source import CBackend
from derive.errors import TisserandError
from derive.ir.model import Model, Variable
from derive.lowering.flat.lower import lower as lower_flat
from derive.lowering.instances.lower import lower_instances
from derive.lowering.mechanism_costs import MechanismCosts, estimate_mechanism_costs, is_predicted
from derive.mechanics.multibody.mechanism import Mechanism
from derive.mechanics.multibody.space.mechanism import SpatialMechanism
from derive.roles import Role
from derive.runtime.compiler import WITHOUT_BATCHES, compiler
from derive.spec.model.scene import SceneLowering
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene

ROOT = Path(__file__).parents[1]
FLAGS = ("-O3 -march=x86-64-v3", "-O2")
CHAINS = (2, 3, 4, 6, 8, 10, 12)
STATES = 16
HELD_OUT = {
    "corpus": (2162, 2169, 2186, 2226, 2228, 2235, 2236, 2253, 2265, 2287),
    "space": (0, 1, 2, 3, 4, 5, 6, 7, 8, 9),
    "rows": (0, 1, 2, 3, 4, 5, 6, 7, 8, 9),
}
"""The seeds of scenes in space on which the cost model is judged. They were drawn after it was fitted: keep it so."""
TOLERANCE = 1e-9
"""The largest relative difference of values, which the condition numbers of random scenes magnify."""


@dataclass(frozen=True)
class Comparison:
    """The predicted times of both lowerings of a scene, and the measured ones (ns) by the flags of the compiler."""

    scene: str
    bodies: int
    costs: MechanismCosts
    flat: tuple[float, ...]
    instances: tuple[float, ...]

    @property
    def row(self) -> str:
        """The row of the table."""
        costs, (flat, looped) = self.costs, (self.flat[0], self.instances[0])
        ratios = [f"{b / a:.2f}" for a, b in zip(self.flat, self.instances, strict=True)]
        predicted = f"{costs.flat:.0f} | {costs.instances:.0f} | {costs.instances / costs.flat:.2f}"
        cells = [self.scene, str(self.bodies), f"{flat:.0f}", f"{looped:.0f}", *ratios, predicted, costs.lowering]
        return f"| {' | '.join(cells)} |"

    @property
    def loss(self) -> float:
        """The time of the chosen form over that of the faster one, with the first flags."""
        of = {"flat": self.flat[0], "instances": self.instances[0]}
        return of[self.costs.lowering] / min(of.values())


def comparison(scene: AnyScene, flags: Sequence[str], repeats: int) -> Comparison:
    """The times of a scene. Raises ArithmeticError if the values of both lowerings differ."""
    if isinstance(scene, SpatialScene):
        scene = replace(scene, coordinates="absolute")  # in which both lowerings have the same unknowns
    mechanism = derive.derive(scene)
    assert isinstance(mechanism, (Mechanism, SpatialMechanism))
    if isinstance(mechanism, SpatialMechanism) and not is_predicted(mechanism):
        raise ArithmeticError("nothing is predicted for such bodies, or where joints leave coordinates")
    costs = estimate_mechanism_costs(mechanism)
    unrolled, looped = (derive.derive(_lowered(scene, form)) for form in ("flat", "instances"))
    assert isinstance(looped, (Mechanism, SpatialMechanism))
    models = {
        "flat": lower_flat(unrolled.expanded(), explicit=True),
        "instances": lower_instances(looped, explicit=True),
    }
    bodies = sum(instance.moves for instance in mechanism.instances)
    times = zip(*(_times(models, options, repeats) for options in flags), strict=True)
    return Comparison(scene.name, bodies, costs, *map(tuple, times))


def _lowered(scene: AnyScene, lowering: SceneLowering) -> AnyScene:
    """The scene with a lowering, by which the equations of finite-element bodies have numbers or names."""
    return replace(scene, lowering=lowering)


def _times(models: dict[str, Model], flags: str, repeats: int) -> list[float]:
    """The least times (ns) of an evaluation in both lowerings, with some flags."""
    flat = models["flat"]
    nq, nv = sum(_sizes(flat.coordinates)), sum(_sizes(flat.velocities))
    given = {"t": "0.01", "q": f"q + s * {nq}", "v": f"v + s * {nv}", "u": "u"}
    used = [argument.name for argument in flat.kernel("accel").arguments]
    types = ", ".join("double" if name == "t" else "const double *" for name in used)
    calls, declared, once = [], [], []
    with tempfile.TemporaryDirectory(prefix="tisserand-bench-") as directory:
        folder = Path(directory)
        objects = [compiled_accelerations(model, form, flags, folder) for form, model in models.items()]
        for form in models:
            name = f"{flat.name}_{form}"
            arguments = ", ".join({**given, "k": f"k_{form}"}[argument] for argument in used)
            calls.append(TimedCall(form, f"if ({name}_accel({arguments}, out)) exit(7);", nv))
            declared.append(f"int {name}_setup(const double *, double *); int {name}_accel({types}, double *);")
            once.append(f"if ({name}_setup(p, k_{form})) return 5;")
        q, v = random_states(flat)
        times, (a, b) = interleaved(
            calls,
            declare="\n".join(declared),
            once=" ".join(once),
            arrays={"q": q, "v": v, "p": np.array([*flat.defaults, 0.0]), "u": np.zeros(len(flat.inputs) + 1)},
            scratch={f"k_{form}": 1 + sum(c.size for c in model.constants) for form, model in models.items()},
            objects=objects,
            folder=folder,
            states=STATES,
            repeats=repeats,
            statistic=np.min,
        )
    error = np.max(np.abs(a - b) / np.abs(a).max(axis=1, keepdims=True))
    if not error < TOLERANCE:
        raise ArithmeticError(f"accelerations differ by {error:.1e}")
    return times


def compiled_accelerations(model: Model, form: str, flags: str, folder: Path) -> Path:
    """The object of the functions `setup` and `accel` of a model, and of `solve`, which `accel` may call."""
    name = f"{model.name}_{form}"
    kept = ("setup", "accel", "solve")
    kernels = (k if k.name in kept else replace(k, sections=(), constants=()) for k in model.kernels)
    derive.write(CBackend().files(replace(model, name=name, kernels=tuple(kernels)), "a benchmark"), folder)
    source = folder / name / f"{name}.c"
    target = source.with_suffix(".o")
    limited([*compiler(), *shlex.split(flags), OWN_OPTION, "-w", WITHOUT_BATCHES, "-c", source, "-o", target])
    return target


def random_states(model: Model) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Random q (STATES, nq) and v (STATES, nv) with small amplitudes of the deformation, and unit quaternions."""
    rng = np.random.default_rng(1)
    scale = np.repeat([0.01 if c.role is Role.AMPLITUDE else 1.0 for c in model.coordinates], _sizes(model.coordinates))
    q = rng.uniform(-1, 1, (STATES, len(scale))) * scale
    names = [name for variable in model.coordinates for name in variable.elements]
    for first in (i for i, name in enumerate(names) if model.in_space and name.endswith("e0")):
        q[:, first : first + 4] /= np.linalg.norm(q[:, first : first + 4], axis=1, keepdims=True)
    return q, rng.uniform(-0.1, 0.1, (STATES, sum(_sizes(model.velocities))))


def _sizes(variables: Sequence[Variable]) -> list[int]:
    return [variable.size for variable in variables]


def chain(count: int, kind: str) -> derive.Scene:
    """A chain of equal beams that hangs from the ground, welded or pinned to each other."""
    beam = {"ansatz": ["1", "xi", "xi^2", "xi^3"], "bending_stiffness": "1/5", "markers": {"left": -1, "right": 1}}
    pairs = {f"joint_{k}": [f"link_{k}.right", f"link_{k + 1}.left"] for k in range(count - 1)}
    return derive.scene(
        f"{kind}_{count}",
        ground={"origin": [0, 0]},
        gravity=[0, -9.81],
        bodies={f"link_{k}": {**beam, "mass": "1/20", "length": "1/10"} for k in range(count)},
        joints={
            "pin": {"kind": "revolute", "between": ["ground.origin", "link_0.left"]},
            **{name: {"kind": kind, "between": between} for name, between in pairs.items()},
        },
    )


def scenes(options: argparse.Namespace) -> Iterator[AnyScene]:
    """The scenes that are measured."""
    sys.path[1:1] = [str(ROOT / "tests"), str(ROOT / "tests" / "kernel")]
    with tempfile.TemporaryDirectory(prefix="tisserand-bench-") as folder:
        if options.held_out:
            yield from _corpus(HELD_OUT["corpus"], Path(folder))
            yield from (graph_of_rigid_bodies(seed, Path(folder)) for seed in HELD_OUT["space"])
            yield from (row_of_flexible_bodies(seed, Path(folder)) for seed in HELD_OUT["rows"])
            return
        for kind in ("weld", "revolute"):
            yield from (chain(count, kind) for count in options.chains)
        for path in options.files or sorted([*ROOT.glob("scenes/*.toml"), *ROOT.glob("examples/*.toml")]):
            spec = derive.read(path)
            is_measured = isinstance(spec, AnyScene if options.files else derive.Scene)
            if is_measured and len(spec.bodies) < 50:
                yield spec
        if options.graphs:
            from random_graphs import graph

            yield from (graph(seed, most=12).scene for seed in options.graphs)
        yield from _corpus(options.corpus, Path(folder))
        yield from (graph_of_rigid_bodies(seed, Path(folder)) for seed in options.space)
        yield from (row_of_flexible_bodies(seed, Path(folder)) for seed in options.rows)


def _corpus(seeds: Sequence[int], folder: Path) -> Iterator[AnyScene]:
    if seeds:
        from corpus.generator import corpus_scene
    for seed in seeds:
        spec = derive.read(corpus_scene(seed).write(folder))
        assert isinstance(spec, AnyScene)
        yield spec


def main(argv: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", type=Path, nargs="*")
    parser.add_argument("--chains", type=int, nargs="*", default=CHAINS)
    parser.add_argument("--corpus", type=int, nargs="*", default=())
    parser.add_argument("--graphs", type=int, nargs="*", default=())
    parser.add_argument("--space", type=int, nargs="*", default=())
    parser.add_argument("--rows", type=int, nargs="*", default=())
    parser.add_argument("--held-out", action="store_true")
    parser.add_argument("--flags", nargs="+", default=FLAGS)
    parser.add_argument("--repeats", type=int, default=41)
    options = parser.parse_args(argv)
    print("\n".join([*described("sympy"), *(f"flags     {flags}" for flags in options.flags), ""]))
    ratios = " | ".join(f"ratio, {flags.split()[0]}" for flags in options.flags)
    print(f"| scene | bodies | unrolled | looped | {ratios} | predicted | looped | ratio | chosen |")
    print(f"| --- | {'---: | ' * (6 + len(options.flags))}--- |")
    losses = []
    for scene in scenes(options):
        try:
            of = comparison(scene, options.flags, options.repeats)
            losses.append(of.loss)
            print(of.row, flush=True)
        except (TisserandError, ArithmeticError, RuntimeError, subprocess.CalledProcessError) as error:
            print(f"{scene.name}: {str(error).splitlines()[-1]}", file=sys.stderr, flush=True)
    if losses:
        fastest, mean = sum(loss == 1 for loss in losses), np.exp(np.mean(np.log(losses)))
        lost = f"it takes {mean:.3f} of the time of the faster one (geometric mean), and {max(losses):.2f} at most"
        print(f"\nThe choice is the faster form of {fastest} of {len(losses)} scenes; {lost}.")


if __name__ == "__main__":
    main()
