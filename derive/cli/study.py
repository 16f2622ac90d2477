"""`tisserand study`: compare frames or models of beams, or methods, on a scene."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from derive.artifacts import File, check_folder, write
from derive.cli import accuracy, methods, stability
from derive.cli.result_files import print_result
from derive.cli.specifications import read_planar_scene, read_scene
from derive.errors import SpecError
from derive.lowering.elimination_orders import EliminationRule
from derive.remaining_time import RemainingTime
from derive.simulation.inputs import with_functions
from derive.simulation.observables.beams import beam_bodies
from derive.spec.model.scene import Scene
from derive.spec.toml.read import with_lines
from derive.study.frame_cost import compare_frames
from derive.study.frame_cost_chart import frame_cost_svg
from derive.study.frame_cost_table import frame_cost_data, frame_cost_text
from derive.study.pivot_stability import frame_stability
from derive.study.pivot_table import pivot_data, pivot_legend, pivot_text
from derive.study.states import period
from derive.study.studied_scene import COMPARED, planar_scene
from derive.study.variants import variant
from derive.terminal import show_progress

FRAMES, PIVOTS = "frames", "pivots"
EXPECTED_SIZE = 100_000
"""The approximate size of the chart of frames, in bytes."""


def run(options: argparse.Namespace) -> int:
    """Run the study that is asked for, a key of `STUDIES`. Raises SpecError if it needs a beam and there is none."""
    scene = read_scene(options.spec) if options.study in IN_SPACE else read_planar_scene(options.spec)
    try:
        return STUDIES[options.study](scene, options)
    except SpecError as error:
        raise (with_lines(error, options.spec) if error.source is None else error) from None
    finally:
        show_progress()


def _frames(scene: Scene, options: argparse.Namespace) -> int:
    scene = with_functions(planar_scene(scene, COMPARED.format(FRAMES)), {})
    names = options.frames
    target = options.chart or Path("results") / scene.name / f"{FRAMES}.svg"
    check_folder([File(target.name, "")], target.parent, EXPECTED_SIZE)
    elimination = EliminationRule(options.elimination)
    rows = compare_frames(scene, options.pieces, names, options.runs, elimination)
    show_progress()
    write([File(target.name, frame_cost_svg(scene.name, names, rows))], target.parent)
    data = frame_cost_data(scene.name, names, rows, elimination)
    print_result(frame_cost_text(scene.name, names, rows, elimination), data, [str(target)], options.json)
    return 0


def _pivots(scene: Scene, options: argparse.Namespace) -> int:
    scene = with_functions(planar_scene(scene, COMPARED.format(PIVOTS)), {})
    along = period(scene)[1]
    numbers = options.pieces or sorted({beam.pieces for beam in beam_bodies(scene)})
    results = []
    remaining = RemainingTime(len(numbers) * len(options.frames))
    for n in numbers:
        first, second = (
            frame_stability(variant(scene, n, name), options.states, options.numberings, f"model {remaining.next()}: ")
            for name in options.frames
        )
        results.append((n, (first, second)))
    show_progress()
    if options.json:
        print(json.dumps([pivot_data(scene.name, n, both) for n, both in results], indent=2))
    else:
        blocks = [pivot_text(scene.name, n, along, both) for n, both in results]
        print("\n\n".join([*blocks, pivot_legend()]))
    return 0


STUDIES: dict[str, Callable[[Any, argparse.Namespace], int]] = {
    FRAMES: _frames,
    PIVOTS: _pivots,
    accuracy.NAME: accuracy.run,
    methods.NAME: methods.run,
    stability.NAME: stability.run,
}
IN_SPACE = (accuracy.NAME, methods.NAME, stability.NAME)
"""The studies that scenes in space have as well."""
