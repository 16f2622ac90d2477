"""The errors that the monitors of beams in space imply, compared with finer models.

python bench/spatial_monitors.py FILE 4000:4223    (random scenes of `bench/spatial_monitor_scenes.py`, a minute each)
python bench/spatial_monitors.py FILE 0:8 --kind buckling    (scenes of `bench/composed_monitor_scenes.py`, or inertia)
python bench/spatial_monitors.py FILE              (the tables of what FILE has)

Every scene is run with one model of its beam and with the truth, three stiffnesses each; a line of FILE in JSON has the
error of a beam along e2 or e3 and its monitors. What FILE has already is not run again, and the truth is kept in a
folder beside it, so that changed monitors take less time. The truth is a beam of second order in three pieces with
three polynomials each. That in two pieces says how well it has converged: errors above .2 % that are not three times as
large are left out of the tables. The error is that of `bench/monitors.py`; deflections are along the axes of the
section at the left end, or at the end that is held against rotation if there is one, from the chord, or from the
tangent there. Beams that bend by less than a millionth of their length are left out of the tables.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from itertools import cycle
from pathlib import Path
from typing import Any

import numpy as np
from composed_monitor_scenes import MODELS as COMPOSED
from composed_monitor_scenes import composed_scenes
from resumed_rows import resumed
from spatial_monitor_scenes import RandomScene, random_scenes

from derive.errors import TisserandError, first_line
from derive.percentages import percent
from derive.simulation.observables.motion import si_value
from derive.simulation.scene_start import state_of
from derive.simulation.trajectory import Trajectory
from derive.simulation.validity.monitors import ERROR_LIMIT
from derive.simulation.validity.spatial_sections import held_in_plane
from derive.spec.model.beam_pieces import in_pieces
from derive.spec.model.markers import MarkerRef
from derive.spec.model.plots import ColumnCurves, Plot
from derive.spec.model.ports import SceneOutput
from derive.spec.model.quantity import Parameter
from derive.spec.model.spatial_beam import SpatialBeam
from derive.spec.model.spatial_beam_parts import SectionFrame
from derive.spec.model.spatial_scene import SpatialScene
from derive.study.accuracy.ladder_model import ORDERS, LadderModel, Shapes
from derive.study.accuracy.measurement import CompiledLadderModel, compiled, motion
from derive.study.accuracy.models import model_scene

FIRST, TRUNCATED, FULL = ORDERS["first"], ORDERS["truncated"], ORDERS["full"]
POLYNOMIALS = Shapes.POLYNOMIALS
TRUTH, OTHER = (LadderModel(POLYNOMIALS, 3, TRUNCATED, "mean", pieces, torsion=2) for pieces in (3, 2))
"""The truth, and what it is compared with."""
MODELS = (
    LadderModel(POLYNOMIALS, 2, FIRST),
    LadderModel(POLYNOMIALS, 3, TRUNCATED),
    LadderModel(POLYNOMIALS, 3, FIRST, torsion=1),
    LadderModel(POLYNOMIALS, 2, TRUNCATED),
    LadderModel(POLYNOMIALS, 3, FIRST, torsion=2),
    LadderModel(POLYNOMIALS, 3, FIRST, "tangent", torsion=2),
    LadderModel(Shapes.SINES, 2, FIRST, "chord"),
    LadderModel(POLYNOMIALS, 3, TRUNCATED, "chord"),
)
"""Each scene has one of them, in turn."""
PLACES = [Fraction(n, 3) for n in (-3, -1, 1, 3)]
TOLERANCE = 1e-7
LEAST = 0.002
"""Errors below it do not count."""
STRAIGHT = 1e-6
Row = dict[str, Any]


def base(scene: SpatialScene, beam: str, axis: int) -> int:
    """The number of the place whose tangent deflections along an axis are measured from."""
    return len(PLACES) - 1 if held_in_plane(scene, beam, axis) == (Fraction(1),) else 0


def seen(scene: SpatialScene, beam: SpatialBeam) -> SpatialScene:
    """The scene with outputs of the places of points along its beam."""
    markers = (*beam.markers, *(SectionFrame(f"seen{i}", at) for i, at in enumerate(PLACES)))
    bodies = tuple(replace(beam, markers=markers) if body.name == beam.name else body for body in scene.bodies)
    outputs = [
        SceneOutput(
            f"seen_{of}_{i}",
            "position",
            {"marker": MarkerRef(beam.name, f"seen{i}"), "frame": MarkerRef(beam.name, f"seen{of}")},
        )
        for of in sorted({base(scene, beam.name, axis) for axis in (2, 3)})
        for i in range(len(PLACES))
        if i != of
    ]
    columns = tuple(f"{output.name}_{axis}" for output in outputs for axis in (1, 2, 3))
    plots = (Plot("seen", ColumnCurves(columns)),)
    return replace(scene, bodies=bodies, outputs=tuple(outputs), plots=plots)


def deflections(run: Trajectory, scene: SpatialScene, beam: str, axis: int) -> np.ndarray:
    """(n, places) of a beam along an axis."""
    of = base(scene, beam, axis)
    x = np.zeros((len(run.motion.t), len(PLACES)))
    for i in range(len(PLACES)):
        if i != of:
            x[:, i] = run[f"seen_{of}_{i}_{axis}"]
    if len(held_in_plane(scene, beam, axis)) != 1:
        x = x - np.outer(x[:, -1], (np.array(PLACES, float) + 1) / 2)
    return x


def with_stiffness(of: CompiledLadderModel, scene: SpatialScene) -> CompiledLadderModel:
    """A compiled model with the stiffnesses of another scene, whose defaults they are."""
    changed = in_pieces(model_scene(scene, of.model))
    (beam,) = (body for body in scene.bodies if isinstance(body, SpatialBeam))
    quantities = (*beam.bending_stiffnesses, *([beam.torsion.stiffness] if beam.torsion else []))
    values = {q.symbol: q.default for q in quantities if isinstance(q, Parameter)}
    k = of.native.setup(values)
    return replace(of, scene=changed, k=k, start=state_of(changed, of.native, k))


def rows(random: RandomScene, model: LadderModel, kept: Path) -> Iterator[Row]:
    """The errors of the beam of a scene along both axes for each stiffness, and what its monitors imply.

    kept: the folder of the deflections of the truth, which are computed once.
    """
    scenes = []
    for n in range(len(random.stiffnesses)):
        scene = random.with_stiffness(n)
        scenes.append(seen(scene, next(body for body in scene.bodies if isinstance(body, SpatialBeam))))
    name, of = random.beam.name, compiled(scenes[0], model, True)
    truths = [truth(scenes, finer, kept) for finer in (TRUTH, OTHER)]
    for n, scene in enumerate(scenes):
        about = {"scene": scene.name, "model": model.label, "stiffness": n}
        try:
            run = motion(with_stiffness(of, scene), TOLERANCE, True)
        except TisserandError as stopped:
            yield {**about, "stopped": first_line(stopped)}
            continue
        if any(f"{n}_2" not in known for known in truths):
            yield {**about, "stopped": "no truth"}
            continue
        for axis in (2, 3):
            own, (exact, other) = deflections(run, scene, name, axis), (known[f"{n}_{axis}"] for known in truths)
            yield {
                **about,
                "beam": name,
                "axis": axis,
                "size": float(np.abs(exact).max()) / si_value(random.beam.length),
                "rms": error(own, exact),
                "reference": error(other, exact),
                "monitors": [m.data for m in run.validity if (m.beam, m.axis) == (name, axis)],
            }


def error(of: np.ndarray, exact: np.ndarray) -> float:
    """The root mean square over the time of the difference, where it is largest, over the peak of what is exact."""
    peak = float(np.abs(exact).max())
    return float(np.sqrt(((of - exact) ** 2).mean(axis=0)).max()) / peak if peak else 0.0


def truth(scenes: Sequence[SpatialScene], model: LadderModel, kept: Path) -> dict[str, np.ndarray]:
    """The deflections of the beam in a finer model by stiffness and axis; none where its run fails."""
    path = kept / f"{scenes[0].name}_{model.pieces}.npz"
    if not path.exists():
        of, known = compiled(scenes[0], model, False), dict[str, np.ndarray]()
        for n, scene in enumerate(scenes):
            (beam,) = (body for body in scene.bodies if isinstance(body, SpatialBeam))
            try:
                run = motion(with_stiffness(of, scene), TOLERANCE)
            except TisserandError as stopped:
                print(scene.name, n, first_line(stopped), file=sys.stderr)
                continue
            known |= {f"{n}_{axis}": deflections(run, scene, beam.name, axis) for axis in (2, 3)}
        kept.mkdir(exist_ok=True, parents=True)
        np.savez(path, allow_pickle=False, **known)
    with np.load(path) as loaded:
        return dict(loaded)


def implied(row: Row) -> tuple[float, str]:
    """The largest implied error, and what it is of."""
    return max(((float(m["error"]), str(m["quantity"])) for m in row["monitors"]), default=(0.0, "none"))


def reliable(row: Row) -> bool:
    """Whether a beam bends, and the error of the truth is small against its own, or both are small."""
    return "rms" in row and row["size"] > STRAIGHT and row["reference"] < max(row["rms"], 3 * LEAST) / 3


def table(known: Sequence[Row]) -> str:
    """By the quantity with the largest error, and of all: verdicts, and ratios of estimates to errors."""
    lines = [
        "| largest estimate by | beams | wrong, warned | missed | false alarm | right, silent | within 2 | within 4 |",
        "|---|---:|---:|---:|---:|---:|---:|---:|",
    ]
    groups: dict[str, list[Row]] = {}
    for row in filter(reliable, known):
        for key in ("all", implied(row)[1]):
            groups.setdefault(key, []).append(row)
    for key, of in sorted(groups.items()):
        counts = {(wrong, warned): 0 for wrong in (True, False) for warned in (True, False)}
        for row in of:
            counts[row["rms"] > ERROR_LIMIT, implied(row)[0] > ERROR_LIMIT] += 1
        off = [
            np.exp(abs(np.log(max(min(implied(row)[0], 1.0), 1e-12) / min(row["rms"], 1.0))))
            for row in of
            if row["rms"] > LEAST
        ]
        within = [percent(float(np.mean(np.array(off) <= limit))) if off else "" for limit in (2, 4)]
        verdict = " | ".join(str(counts[pair]) for pair in ((True, True), (True, False), (False, True), (False, False)))
        lines.append(f"| {key} | {len(of)} | {verdict} | {' | '.join(within)} |")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path)
    parser.add_argument("seeds", type=lambda text: range(*map(int, text.split(":"))), nargs="?", default=range(0))
    parser.add_argument("--alone", action="store_true", help="only scenes without other bodies, which take less time")
    parser.add_argument("--kind", choices=COMPOSED, help="composed scenes in place of random ones")
    options = parser.parse_args()
    if options.kind:
        scenes = composed_scenes(options.kind, options.seeds)
    else:
        drawn = (of for of in random_scenes(options.seeds) if not options.alone or len(of.scene.bodies) == 1)
        scenes = zip(drawn, cycle(MODELS), strict=False)
    print(table(resumed(options.file, _named(options.file, scenes))))


def _named(
    path: Path, scenes: Iterable[tuple[RandomScene, LadderModel]]
) -> Iterator[tuple[str, Callable[[], Iterator[Row]]]]:
    """The names of scenes with models, and what computes their rows."""
    for scene, model in scenes:
        yield scene.scene.name, partial(rows, scene, model, path.with_suffix(""))


if __name__ == "__main__":
    main()
