"""The paper's question with beams of second order: which frame needs fewer terms, fewer non-zeros and less time?

    python bench/second_order.py [--runs N] [--write] [--json]

One beam as the rod of the crank-slider of set A, with three shapes in each frame, of first and of second order. Errors
are of the deflection of its middle over two and a half revolutions, as a root mean square over the peak of the
reference, which is itself good to 0.03 %. Each model is measured in the safe elimination order of generated code and in
the best one that was found; calls are interleaved. The definiteness limit is the |v|/l of a half-sine bend at which the
mass matrix of the free beam becomes indefinite.

`--write` writes docs/second_order.md and docs/second_order.svg: run it on a machine without other load.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
import second_order_page

import derive
from derive.backends.model_files import emit
from derive.ir.model import Kkt
from derive.lowering.elimination_orders import EliminationRule
from derive.lowering.flat.lower import lower
from derive.mechanics.bodies.reference_conditions import assumed_shapes
from derive.mechanics.equations import Equations
from derive.runtime.loading import load_scene
from derive.simulation.observables.beams import function_values
from derive.spec.model.beam_parts import Frame
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.scene import Scene
from derive.spec.parsing import values
from derive.spec.toml.read import parse
from derive.study.elimination import eliminate, equilibrated, kkt_systems
from derive.study.states import simulated_states
from derive.study.timing import RepeatedCalls, interleaved
from derive.study.variants import OperationCounts, operation_counts

SCENE = Path(__file__).parents[1] / "scenes" / "crank_slider_3.toml"
REFERENCE = SCENE.with_name("crank_slider_A.csv")
SHAPES = 3
CALLS, STATES = 20_000, 64
FRAMES = (Frame("mean"), Frame("chord"), Frame("point", 0), Frame("tangent", -1))
MODELS = tuple((frame, order) for frame in FRAMES for order in DisplacementOrder)


@dataclass(frozen=True)
class Elimination:
    """A model in one elimination order: its counts, whether each multiplier comes after all of its coordinates, which
    is safe in every state, the pivots that vanish within a revolution, and the seconds of `accel`."""

    counts: OperationCounts
    safe: bool
    vanishing: int
    seconds: float = float("nan")


@dataclass(frozen=True)
class Row:
    """The figures of one model, in the safe and in the best elimination order."""

    frame: str
    order: DisplacementOrder
    error: float
    definite: float
    safe: Elimination
    best: Elimination


def crank_slider(frame: Frame, order: DisplacementOrder) -> Scene:
    """The scene with its rod as one beam, and the ends and the middle of the rod as outputs."""
    text = SCENE.read_text()
    outputs = "".join(f'[outputs.{m}]\nkind = "position"\nmarker = "rod.{m}"\n' for m in ("left", "middle", "right"))
    scene = parse(text[: text.index("[plots")].replace("output = 1e-4", "tolerance = 1e-8\noutput = 1e-4") + outputs)
    ansatz = tuple(values.shape(f"xi^{n}") for n in range(SHAPES + 2))

    def changed(body: object) -> object:
        if not isinstance(body, BeamBody):
            return body
        beam = replace(body.beam, ansatz=ansatz, frame=frame, orthogonal=frame.kind == "mean", order=order)
        return replace(body, pieces=1, beam=beam)

    return replace(scene, bodies=tuple(map(changed, scene.bodies)))


def error(scene: Scene) -> float:
    """The root mean square of the error of the deflection, over the peak of the reference."""
    motion = derive.simulate(scene)
    left, middle, right = (np.stack([motion[f"{m}_1"], motion[f"{m}_2"]], 1) for m in ("left", "middle", "right"))
    chord = (right - left) / np.linalg.norm(right - left, axis=1)[:, None]
    normal = np.stack([-chord[:, 1], chord[:, 0]], 1)
    deflection = ((middle - (left + right) / 2) * normal).sum(1) / 0.3
    expected = np.genfromtxt(REFERENCE, delimiter=",", names=True)["midpoint_deflection_over_L"]
    return float(np.sqrt(np.mean((deflection - expected) ** 2)) / np.abs(expected).max())


def definiteness_limit(frame: Frame, order: DisplacementOrder) -> float:
    """The |v|/l of a half-sine bend at which M of the free beam becomes indefinite; inf if it does not."""
    spec = derive.planar_beam(
        "beam", ansatz=[f"xi^{n}" for n in range(SHAPES + 2)], frame=frame, mass=1, length=1, bending_stiffness=1
    )
    spec = replace(spec, order=order)
    shapes = assumed_shapes(spec.deflection)
    xi = np.linspace(-1, 1, 201)
    fields = np.array([function_values(shape, xi) for shape in shapes])
    rigid = np.stack([np.ones_like(xi), xi])
    bend = np.linalg.lstsq(np.vstack([fields, rigid]).T, np.cos(np.pi * xi / 2), rcond=None)[0][: len(shapes)]
    native = derive.load(derive.model_files(derive.lower(derive.derive(spec)), spec))
    k = native.setup()
    for size in np.arange(0.001, 0.8, 0.001):
        mass = native.mass_pattern.dense(native.mass([0, 0, 0, *(size * bend)], k))
        if np.linalg.eigvalsh(mass)[0] <= 0:
            return float(size)
    return float("inf")


def is_safe(kkt: Kkt, coordinates: int) -> bool:
    """Whether each multiplier is eliminated after all of its coordinates."""
    place = {node: n for n, node in enumerate(kkt.order)}
    return all(place[i] > place[j] for i, j in kkt.pattern.entries if i >= coordinates > j)


def models(equations: Equations) -> dict[EliminationRule, tuple[derive.Model, OperationCounts]]:
    """The model of a scene in each elimination order, with its counts."""
    lowered = {rule: lower(equations, elimination=rule) for rule in EliminationRule}
    return {rule: (model, operation_counts(equations, model, rule)) for rule, model in lowered.items()}


def equations_of(scene: Scene) -> Equations:
    """The equations of a scene without its outputs."""
    return derive.derive(replace(scene, outputs=())).expanded()


def measured(runs: int) -> list[Row]:
    """All models; the calls of all of them are timed in turn."""
    repeater, rows, timed = RepeatedCalls(), [], []
    for frame, order in MODELS:
        scene = crank_slider(frame, order)
        found = {}
        for rule, (model, counts) in models(equations_of(scene)).items():
            native = load_scene(emit(model, scene))
            states = simulated_states(scene, native, native.setup(), STATES)
            t, q, v = (np.array([state[n] for state in states]) for n in range(3))
            systems = equilibrated(*kkt_systems(native, native.setup(), states))
            vanishing = int(eliminate(*systems, model.kkt.order, model.kkt.order).vanished.sum())
            found[rule] = Elimination(counts, is_safe(model.kkt, native.nv), vanishing)
            timed.append(lambda native=native, t=t, q=q, v=v: repeater.seconds(native, "accel", CALLS, t, q, v))
        safe, best = found[EliminationRule.SAFE], found[EliminationRule.MATCHED]
        assert safe.safe, "the order of generated code"
        rows.append(Row(frame.kind, order, error(scene), definiteness_limit(frame, order), safe, best))
    seconds = iter(np.median(interleaved(timed, runs), axis=0).tolist())
    return [
        replace(row, safe=replace(row.safe, seconds=next(seconds)), best=replace(row.best, seconds=next(seconds)))
        for row in rows
    ]


def main() -> None:
    """Print the table, and write the pages if asked to."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=15)
    parser.add_argument("--write", action="store_true", help="write docs/second_order.*")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    rows = measured(options.runs)
    if options.json:
        print(json.dumps([asdict(row) | {"order": row.order.value} for row in rows], indent=2))
    else:
        print(second_order_page.accuracy_table(rows), second_order_page.cost_table(rows), sep="\n\n")
    if options.write:
        second_order_page.write(rows)


if __name__ == "__main__":
    main()
