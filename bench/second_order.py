"""The paper's question with beams of second order: which frame needs fewer terms, fewer non-zeros and less time?

    python bench/second_order.py [--runs N] [--picture FILE]

One beam as the rod of the crank-slider of set A, with three shapes in each frame, of first and of second order. Errors
are of the deflection of its middle over two and a half revolutions, as a root mean square over the peak of the
reference, which is itself good to 0.03 %. Each model is measured in the safe elimination order of generated code and in
the best one that was found; calls are interleaved. The definiteness limit is the |v|/l of a half-sine bend at which the
mass matrix of the free beam becomes indefinite.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import derive
from derive.backends.model_files import model_files
from derive.lowering.elimination_orders import EliminationRule
from derive.lowering.flat.lower import lower
from derive.mechanics.bodies.reference_conditions import assumed_shapes, exact_polynomial
from derive.runtime.integrators.fixed_step import FixedStep
from derive.spec.model.body import DisplacementOrder, Frame
from derive.spec.model.scene import BeamBody, Scene
from derive.spec.parsing import values
from derive.spec.toml.read import parse
from derive.study.states import simulated_states
from derive.study.timing import RepeatedCalls, interleaved, machine_description, scene_of
from derive.study.variants import OperationCounts, operation_counts

SCENE = Path(__file__).parents[1] / "scenes" / "crank_slider_3.toml"
REFERENCE = SCENE.with_name("crank_slider_A.csv")
SHAPES = 3
CALLS, STATES = 20_000, 64
MEAN, CHORD, POINT, TANGENT = Frame("mean"), Frame("chord"), Frame("point", 0), Frame("tangent", -1)
MODELS = (
    (MEAN, DisplacementOrder.FIRST_ORDER),
    (MEAN, DisplacementOrder.TRUNCATED),
    (MEAN, DisplacementOrder.FULL),
    (CHORD, DisplacementOrder.TRUNCATED),
    (CHORD, DisplacementOrder.FULL),
    (POINT, DisplacementOrder.TRUNCATED),
    (POINT, DisplacementOrder.FULL),
    (TANGENT, DisplacementOrder.TRUNCATED),
    (TANGENT, DisplacementOrder.FULL),
)
NAMES = {
    DisplacementOrder.FIRST_ORDER: "first order",
    DisplacementOrder.TRUNCATED: "second, truncated",
    DisplacementOrder.FULL: "second, full",
}


@dataclass(frozen=True)
class Row:
    """The figures of one model: counts and seconds of `accel` in both elimination orders."""

    frame: str
    order: DisplacementOrder
    error: float
    definite: float
    counts: dict[EliminationRule, OperationCounts]
    seconds: dict[EliminationRule, float]


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
    shapes = [exact_polynomial(s) for s in assumed_shapes(spec.deflection)]
    xi = np.linspace(-1, 1, 201)
    fields = np.array([[float(s.eval(x)) for x in xi] for s in shapes])
    rigid = np.stack([np.ones_like(xi), xi])
    bend = np.linalg.lstsq(np.vstack([fields, rigid]).T, np.cos(np.pi * xi / 2), rcond=None)[0][: len(shapes)]
    native = derive.load(derive.model_files(derive.lower(derive.derive(spec)), spec))
    k = native.setup()
    for size in np.arange(0.001, 0.8, 0.001):
        mass = native.mass_pattern.dense(native.mass([0, 0, 0, *(size * bend)], k))
        if np.linalg.eigvalsh(mass)[0] <= 0:
            return float(size)
    return float("inf")


def measured(runs: int) -> list[Row]:
    """All models; the calls of all of them are timed in turn."""
    repeater, prepared, timed = RepeatedCalls(), [], []
    for frame, order in MODELS:
        scene = crank_slider(frame, order)
        equations = derive.derive(replace(scene, outputs=())).expanded()
        counts = {}
        for rule in EliminationRule:
            host = FixedStep(model_files(lower(equations, elimination=rule), scene))
            native = scene_of(host)
            states = simulated_states(scene, native, native.setup(), STATES)
            t, q, v = (np.array([state[n] for state in states]) for n in range(3))
            counts[rule] = operation_counts(equations, rule)
            timed.append(lambda native=native, t=t, q=q, v=v: repeater.seconds(native, "accel", CALLS, t, q, v))
        prepared.append((frame, order, error(scene), definiteness_limit(frame, order), counts))
    medians = np.median(interleaved(timed, runs), axis=0)
    return [
        Row(
            frame.kind, order, error, limit, counts, dict(zip(EliminationRule, medians[2 * i : 2 * i + 2], strict=True))
        )
        for i, (frame, order, error, limit, counts) in enumerate(prepared)
    ]


def table(rows: list[Row]) -> str:
    """The figures as a table of Markdown."""
    safe, best = EliminationRule.SAFE, EliminationRule.MATCHED
    lines = [
        "| frame | displacement | error, rms | nnz(M) | nnz(KKT) | LDL^T, safe / best | accel, safe / best "
        "| ns, safe / best | definite to \\|v\\|/l |",
        "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    for row in rows:
        a, b = row.counts[safe], row.counts[best]
        ns = (f"{1e9 * row.seconds[rule]:.0f}" for rule in (safe, best))
        limit = "always" if np.isinf(row.definite) else f"{row.definite:.3f}"
        cells = (
            *(row.frame, NAMES[row.order], f"{100 * row.error:.2g} %", a.mass, a.kkt),
            *(f"{a.flops} / {b.flops}", f"{a.accel} / {b.accel}", " / ".join(ns), limit),
        )
        lines.append(f"| {' | '.join(map(str, cells))} |")
    return "\n".join(lines)


def picture(rows: list[Row], target: Path) -> None:
    """Error over the time of an evaluation, each model in its best order."""
    figure, axes = plt.subplots(figsize=(6.4, 4.0))
    markers = {"mean": "o", "chord": "s", "point": "^", "tangent": "D"}
    colours = dict(zip(NAMES, ("0.55", "tab:blue", "tab:orange"), strict=True))
    for row in rows:
        ns = 1e9 * min(row.seconds.values())
        axes.loglog(ns, 100 * row.error, markers[row.frame], color=colours[row.order], markersize=7)
        axes.annotate(f"  {row.frame}", (ns, 100 * row.error), color=colours[row.order], fontsize=9, va="center")
    for order, name in NAMES.items():
        axes.plot([], [], "o", color=colours[order], label=name)
    axes.axhline(0.03, color="0.6", linestyle=":", linewidth=1)
    axes.annotate("error of the reference", (0.99, 0.03), xycoords=("axes fraction", "data"), ha="right", va="bottom")
    axes.set_xlabel("time of an evaluation of the accelerations / ns")
    axes.set_ylabel("error of the deflection, rms / %")
    axes.legend(title="displacement", frameon=False)
    figure.patch.set_facecolor("white")
    figure.tight_layout()
    figure.savefig(target, metadata={"Date": None})


def main() -> None:
    """Print the table, and draw the picture if a file is given."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=15)
    parser.add_argument("--picture", type=Path)
    options = parser.parse_args()
    rows = measured(options.runs)
    print(table(rows))
    print("; ".join(machine_description().values()))
    if options.picture:
        picture(rows, options.picture)


if __name__ == "__main__":
    main()
