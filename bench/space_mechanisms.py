"""Mechanisms in space: M and h of a body, accelerations of mechanisms of 3 bodies, beside CasADi and C by hand.

python bench/space_mechanisms.py [--yardsticks FOLDER] [--only NAME ...] [--counts N ...] [--lowering NAME]

All implementations of a scene run alternately in one process, with one compiler and the same flags; each time is the
least of many slices, and values are compared first. CasADi gets our M, h, G and gamma, and our elimination order.
FOLDER has C by hand for chains: joints2.c (rigid bodies, -DKIND=5, 3 or 6) and flex3.c (bodies with 8 modes, welded),
with `eval(n, class, tables, q, v, vdot, work)`; without it these rows have CasADi alone. Chains have any number of
bodies; CasADi takes part in straight-line code of chains of 3. Exudyn, if it is installed, evaluates the mass matrix,
the forces and the constraint Jacobian of the slider-cranks (`exudyn_space.py`).
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import space_scenes as scenes
from chain_model import casadi_accelerations, numeric_function
from exudyn_space import evaluation
from interleaved import TimedCall, interleaved
from machine import OWN_OPTION, described
from rows import Row, row
from space_tables import flexible_tables, free_tables, rigid_tables
from timed_program import Program

from derive.backends.c.source import CBackend
from derive.derivation import derive
from derive.ir.model import Model
from derive.lowering.flat.context import Context
from derive.mechanics.equations import Equations
from derive.model_lowering import lower
from derive.spec.model.spatial_scene import SpatialScene

Array = scenes.Array

FLAGS = "-O3 -march=x86-64-v3"
STATES = 8
REPEATS = 41
TOLERANCE = 1e-9
"""The largest difference relative to the largest value, or to gravity where it is larger: bodies that are welded to the
ground stay at rest. Multipliers of badly placed joints lose some digits."""
GOAL = 1.0
HAND_GOAL = 1.1
COUNT = 3
"""The bodies of the chains in whose times CasADi takes part."""
OWN_FILE = "handwritten_body.c"
EVALUATION = "const int *, const void *, const double *, const double *, double *, void *"


@dataclass(frozen=True)
class HandCode:
    """C by hand for accelerations: its file, its options, its tables, and the C that declares, prepares and calls it.

    The file of a chain is in the folder of yardsticks, that of a free body beside this one.
    """

    file: str
    options: str
    tables: Array
    declare: str
    call: str
    once: str = ""


@dataclass(frozen=True)
class Case:
    """A scene, its states, and the C by hand that computes its accelerations."""

    title: str
    make: Callable[[Path], SpatialScene]
    states: Callable[[SpatialScene, Model], tuple[Array, Array]]
    functions: Sequence[str] = ("accel",)
    hand: Callable[[SpatialScene], HandCode] | None = None
    casadi: bool = True
    exudyn: Callable[[SpatialScene], float] | None = None
    bodies: int = 1


def _random(scene: SpatialScene, model: Model) -> tuple[Array, Array]:
    names = [name for variable in model.coordinates for name in variable.elements]
    quaternions = [i for i, name in enumerate(names) if name.endswith("e0")]
    return scenes.any_states(len(names), sum(v.size for v in model.velocities), quaternions, STATES)


def _chain(file: str, options: str, tables: Array, count: int) -> HandCode:
    classes = ", ".join(map(str, range(count)))
    declare = f"int eval(int, {EVALUATION}); static const int classes[] = {{{classes}}};"
    return HandCode(file, options, tables, declare, f"eval({count}, classes, tables, {{state}}, out, work);")


def _free(scene: SpatialScene) -> HandCode:
    (link,) = scenes.reduced_links(scene)
    declare = "void hand_setup(const double *); void hand_accel(const double *, const double *, double *);"
    call, options = "hand_accel({state}, out);", f"-DMEAN -DN={scenes.MODES}"
    return HandCode(OWN_FILE, options, free_tables(link), declare, call, "hand_setup(tables);")


def _rigid_case(kind: str, count: int) -> Case:
    return Case(
        f"chain of {count} rigid bodies, {kind} joints",
        lambda folder: scenes.chain_of_rigid_bodies(count, kind, folder),
        lambda scene, model: scenes.rigid_states(count, kind, STATES),
        hand=lambda scene: _chain(
            "joints2.c",
            f"-DKIND={scenes.AXES[kind]}",
            rigid_tables([scenes.rigid_link(i) for i in range(count)]),
            count,
        ),
        casadi=count == COUNT,
        bodies=count,
    )


def _flexible_case(count: int) -> Case:
    return Case(
        f"chain of {count} bodies with {scenes.MODES} modes, welded",
        lambda folder: scenes.chain_of_flexible_bodies(count, "fixed", folder),
        lambda scene, model: scenes.flexible_states(scenes.reduced_links(scene), True, STATES),
        hand=lambda scene: _chain("flex3.c", "", flexible_tables(scenes.reduced_links(scene)), count),
        casadi=False,  # its C takes the compiler minutes
        bodies=count,
    )


def _chains(count: int) -> dict[str, Case]:
    """The chains of so many bodies."""
    rigid = {f"rigid_{kind}": _rigid_case(kind, count) for kind in scenes.AXES}
    return {**rigid, "flexible_fixed": _flexible_case(count)}


CASES = {
    "free_rod": Case("rod of the example, 6 modes", scenes.free_rod, _random, ("mass", "force", "accel")),
    "free_cloud": Case(
        f"body with {scenes.MODES} modes, all integrals",
        lambda folder: scenes.chain_of_flexible_bodies(1, "", folder),
        _random,
        ("mass", "force", "accel"),
        _free,
    ),
    "slider_crank_rigid": Case(
        "slider-crank, 3 rigid bodies",
        lambda folder: scenes.slider_crank(False, folder),
        _random,
        exudyn=lambda scene: evaluation(scene, False),
    ),
    "slider_crank_flexible": Case(
        "slider-crank, flexible rod",
        lambda folder: scenes.slider_crank(True, folder),
        _random,
        exudyn=lambda scene: evaluation(scene, True),
    ),
    **_chains(COUNT),
}


def times(
    case: Case, folder: Path, flags: str, repeats: int, yardsticks: Path | None, lowering: str = "auto"
) -> dict[str, dict[str, float]]:
    """The least times (ns) of an evaluation by function and maker. Raises ArithmeticError if values differ."""
    options: dict[str, Any] = {"lowering": lowering}
    scene = replace(case.make(folder), **options)
    mechanism = derive(scene)
    with_casadi = case.casadi and lowering != "instances"
    equations = mechanism.expanded() if with_casadi or not case.hand else None
    model = lower(mechanism, explicit=True)
    program, name = Program(folder, flags), model.name
    header, source = CBackend().files(model, "a benchmark")
    for file in (header, source):
        (folder / Path(file.path).name).write_text(file.text)
    program.compile(folder / f"{name}.c", OWN_OPTION)
    program.declare.append(f'#include "{(folder / name).resolve()}.h"')
    program.once.append(f"if ({name}_setup(p, k)) return 5;")
    q, v = case.states(scene, model)
    program.arrays |= {"q": q, "v": v, "p": np.append(np.array(model.defaults), 0.0)}
    program.scratch["k"] = sum(constant.size for constant in model.constants) + 1
    state = f"q + s * {q.shape[1]}, v + s * {v.shape[1]}"
    result: dict[str, dict[str, float]] = {}
    hand = _add_hand(case, scene, program, yardsticks) if case.hand else None
    for function in case.functions:
        size = model.kernel(function).outputs[0].size
        own = f"q + s * {q.shape[1]}" if function == "mass" else f"0.0, {state}"
        calls = [TimedCall("ours", f"{name}_{function}({own}, k, out);", size)]
        if with_casadi:
            assert equations is not None
            (folder / f"casadi_{function}.c").write_text(_casadi(function, equations).dump())
            program.compile(folder / f"casadi_{function}.c")
            peer = f"casadi_{function}"
            program.declare.append(f"int {peer}(const double **, double **, long long *, double *, int);")
            given = f"const double *given[] = {{{state}}}; double *result[] = {{out}};"
            calls.append(TimedCall("CasADi", f"{given} {peer}(given, result, 0, 0, 0);", size))
        if hand and function == "accel":
            calls.append(TimedCall("hand", hand.call.format(state=state), size))
        found, values = interleaved(
            calls,
            declare="\n".join(program.declare),
            once=" ".join(program.once),
            arrays=program.arrays,
            scratch=program.scratch,
            objects=program.objects,
            folder=folder,
            states=STATES,
            repeats=repeats,
            statistic=np.min,
        )
        for call, other in zip(calls, values, strict=True):
            error = np.max(np.abs(other - values[0])) / np.max([*np.abs(values[0].ravel()), abs(scenes.GRAVITY)])
            if not error < TOLERANCE:
                raise ArithmeticError(f"{name}: {function} of {call.name} is off by {error:.1e}")
        result[function] = {call.name: t for call, t in zip(calls, found, strict=True)}
        if case.exudyn and repeats > 1 and find_spec("exudyn"):
            result[function]["Exudyn"] = case.exudyn(scene)
        result[function]["operations"] = model.kernel(function).operations
    return result


def _casadi(function: str, equations: Equations) -> ca.CodeGenerator:
    """The C that CasADi writes for a function of our equations."""
    if function == "accel":
        made = casadi_accelerations(equations)
    else:
        context = Context(equations)
        symbols = context.symbols(context.q, context.v)
        if function == "mass":
            values = [symbols(equations.mass[i, j]) for i, j in context.mass_pattern().entries]
        else:
            values = [symbols(h) for h in equations.force]
        made = numeric_function(equations.name, context, symbols, ca.vertcat(*values))
    generator = ca.CodeGenerator(f"casadi_{function}.c", {"with_header": False})
    generator.add(ca.Function(f"casadi_{function}", made.sx_in(), made.call(made.sx_in()), {"cse": True}))
    return generator


def _add_hand(case: Case, scene: SpatialScene, program: Program, yardsticks: Path | None) -> HandCode | None:
    """Add the C by hand; None if it is in a folder that is not given."""
    assert case.hand is not None
    code = case.hand(scene)
    folder = Path(__file__).parent if code.file == OWN_FILE else yardsticks
    if folder is None:
        return None
    program.compile(folder / code.file, code.options, "hand")
    program.arrays["tables"] = code.tables
    program.scratch["work"] = 400 * case.bodies + 64
    program.declare.append(code.declare)
    program.once.append(code.once)
    return code


def rows(
    flags: str = FLAGS,
    repeats: int = REPEATS,
    yardsticks: Path | None = None,
    only: Sequence[str] = (),
    quick: bool = False,
    lowering: str = "auto",
    count: int = COUNT,
) -> list[Row]:
    """The rows of mechanisms in space, see `rows.py`: those that need no yardsticks, or `only` some.

    quick: one small scene, once. lowering: that of our code; count: the bodies of chains.
    """
    cases = {**CASES, **_chains(count)}
    only = only or [name for name, case in cases.items() if yardsticks or case.casadi]
    if quick:
        only, flags, repeats = ("slider_crank_rigid",), "-O1", 1
    result = []
    for name in only:
        with tempfile.TemporaryDirectory(prefix="tisserand-bench-") as folder:
            by_function = times(cases[name], Path(folder), flags, repeats, yardsticks, lowering)
        result += [_row(cases[name], function, ns) for function, ns in by_function.items()]
    return result


LABELS = {"mass": "M", "force": "h", "accel": "accelerations"}


def _row(case: Case, function: str, ns: Mapping[str, float]) -> Row:
    goal = HAND_GOAL if "hand" in ns else GOAL
    peers = {name: ns[name] for name in ("CasADi", "Exudyn") if name in ns}
    note = f"{ns['operations']:.0f} operations" + (f", Exudyn {ns['Exudyn']:.0f}" if "Exudyn" in ns else "")
    return row(f"{LABELS[function]}, {case.title}", ns["ours"], peers=peers, hand=ns.get("hand"), goal=goal, note=note)


def main(argv: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--yardsticks", type=Path, help="the folder of C by hand")
    parser.add_argument("--only", nargs="+", choices=CASES, default=list(CASES), metavar="NAME")
    parser.add_argument("--counts", nargs="+", type=int, default=[COUNT], help="the bodies of the chains")
    parser.add_argument("--lowering", choices=("auto", "flat", "instances"), default="auto")
    parser.add_argument("--flags", default=FLAGS)
    parser.add_argument("--repeats", type=int, default=REPEATS)
    options = parser.parse_args(argv)
    print("\n".join(described("casadi", "sympy", "numpy")))
    print(f"flags     {options.flags}; ns of an evaluation\n")
    print("| | ours | CasADi | by hand | ours / CasADi | ours / by hand |\n| --- | ---: | ---: | ---: | ---: | ---: |")
    chains = _chains(COUNT)
    for name, count in ((n, c) for n in options.only for c in (options.counts if n in chains else [COUNT])):
        for r in rows(
            options.flags, options.repeats, options.yardsticks, (name,), lowering=options.lowering, count=count
        ):
            cells = [f"{r[k]:.4g}" if r[k] else "" for k in ("ours_ns", "peer_ns", "hand_ns")]
            ratios = [f"{r['ours_ns'] / r[k]:.2f}" if r[k] else "" for k in ("peer_ns", "hand_ns")]
            print(f"| {r['name']} ({r['note']}) | {' | '.join([*cells, *ratios])} |", flush=True)


if __name__ == "__main__":
    main()
