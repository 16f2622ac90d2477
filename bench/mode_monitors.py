"""The error of finite-element bodies that their loads imply, or the part of their fastest mode, and that of few modes.

python bench/mode_monitors.py FILE 4000:4400    (random scenes of the corpus, a minute each)
python bench/mode_monitors.py FILE              (the table of what FILE has)

Every scene with one finite-element body is run with few modes, in turn free ones and Craig-Bampton modes, with many,
the truth: nine beside the static ones of its interface, or sixteen free ones, and with two thirds of these, so that
some errors are small. A line of FILE in JSON has the error of the deformation, root mean square over the run, relative
to its peak, in the norm of the mass; deformations are relative to the mean frame. What FILE has already is not run
again.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from resumed_rows import resumed

import derive
from derive.mechanics.symbols import amplitude_of
from derive.percentages import percent
from derive.reduction.body import prepare
from derive.simulation.trajectory import Trajectory
from derive.simulation.validity.mode_content import mode_errors
from derive.simulation.validity.monitors import ERROR_LIMIT
from derive.spec.model.body import BodyFrame
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.accuracy.measurement import compiled, motion
from derive.study.accuracy.spatial_models import can_have

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from corpus.generator import corpus_scene

HELD, FREE = Shapes.CRAIG_BAMPTON, Shapes.FREE
FEW = (3, 4, 6, 9)
"""Free modes; of Craig-Bampton modes a third of these beside the static ones."""
MANY = {HELD: (9, 6), FREE: (16, 12)}
"""The modes of the truth, and two thirds of them."""
TOLERANCE = 1e-7
LEAST = 0.002
Row = dict[str, Any]


def scenes(seeds: range) -> Iterator[SpatialScene]:
    """The scenes of the corpus with one finite-element body, which starts undeformed, in its mean frame."""
    for seed in seeds:
        random = corpus_scene(seed)
        if sum("nodes" in table for table in random.tables["bodies"].values()) != 1:
            continue
        with tempfile.TemporaryDirectory() as folder:
            spec = derive.read(random.write(Path(folder) / "scene"))
        assert isinstance(spec, SpatialScene)
        bodies = tuple(
            replace(
                body,
                body=replace(body.body, frame=BodyFrame("mean")),
                start=replace(body.start, amplitudes=None, amplitude_rates=None),
            )
            if isinstance(body, FlexibleBody)
            else body
            for body in spec.bodies
        )
        yield replace(spec, bodies=bodies, outputs=(), plots=(), lowering="flat")


def of_scene(scene: SpatialScene) -> FlexibleBody:
    """The finite-element body."""
    return next(body for body in scene.bodies if isinstance(body, FlexibleBody))


def deformation(scene: SpatialScene, model: LadderModel) -> tuple[Trajectory, np.ndarray]:
    """A run, and the displacements (n, nodes, 3) of the nodes of the body in its frame times the root of their mass."""
    run = motion(compiled(scene, model, True), TOLERANCE)
    assert isinstance(run.scene, SpatialScene)
    body = of_scene(run.scene)
    known = prepare(body.body)
    modes = range(1, len(known.shapes.phi) + 1)
    columns = [run.motion.native.coordinates.index(amplitude_of(body.name, i).shown) for i in modes]
    return run, np.einsum("nm,mij->nij", run.motion.q[:, columns], known.shapes.phi)


def rows(scene: SpatialScene, number: int) -> Iterator[Row]:
    """The errors of two models of a scene, and what the loads or the fastest mode of each imply."""
    body = of_scene(scene)
    kind = HELD if can_have(scene, body, LadderModel(HELD)) else FREE
    count = FEW[number // 2 % len(FEW)]
    few = LadderModel(HELD, count // 3) if kind is HELD and number % 2 else LadderModel(FREE, count)
    many, most = MANY[kind]
    _, exact = deformation(scene, LadderModel(kind, many))
    mass = prepare(body.body).mass

    def size(u: np.ndarray) -> np.ndarray:
        """(n,): the norm of the mass."""
        return np.sqrt(np.maximum([np.sum(x * (mass @ x)) for x in u], 0))

    peak = float(size(exact).max())
    for model in (few, LadderModel(kind, most)):
        run, own = deformation(scene, model)
        row: Row = {"scene": scene.name, "model": model.label, "peak": peak}
        row["rms"] = float(np.sqrt(np.mean(size(own - exact) ** 2))) / peak if peak else 0.0
        moved = run.motion
        known = list(mode_errors(run.scene, moved.native, moved.k, moved.t, moved.q, moved.v))
        yield row | ({"error": known[0].error, "by": "loads" if known[0].of_loads else "fastest mode"} if known else {})


def table(known: Sequence[Row]) -> str:
    """Verdicts and ratios of estimates to errors, of all and by kind of modes."""
    lines = [
        "| modes | bodies | wrong, warned | missed | false alarm | right, silent | within 2 | within 4 |",
        "|---|---:|---:|---:|---:|---:|---:|---:|",
    ]
    groups: dict[str, list[Row]] = {}
    for row in (row for row in known if "error" in row):
        for key in ("all", f"{'Craig-Bampton' if 'Craig' in row['model'] else 'free'} modes, {row['by']}"):
            groups.setdefault(key, []).append(row)
    for key, of in sorted(groups.items()):
        counts = {(wrong, warned): 0 for wrong in (True, False) for warned in (True, False)}
        for row in of:
            counts[row["rms"] > ERROR_LIMIT, row["error"] > ERROR_LIMIT] += 1
        ratios = np.array([max(row["error"], 1e-12) / row["rms"] for row in of if row["rms"] > LEAST])
        within = [percent(float(np.mean(np.abs(np.log(ratios)) <= np.log(f)))) for f in (2, 4)]
        verdict = " | ".join(str(counts[pair]) for pair in ((True, True), (True, False), (False, True), (False, False)))
        lines.append(f"| {key} | {len(of)} | {verdict} | {' | '.join(within)} |")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path)
    parser.add_argument("seeds", type=lambda text: range(*map(int, text.split(":"))), nargs="?", default=range(0))
    options = parser.parse_args()
    named = ((scene.name, partial(rows, scene, number)) for number, scene in enumerate(scenes(options.seeds)))
    print(table(resumed(options.file, named)))


if __name__ == "__main__":
    main()
