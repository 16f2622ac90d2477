"""`tisserand study`: compare frames or models of beams, or methods, on a scene."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Sequence
from pathlib import Path

from derive.artifacts import File, check_folder, write
from derive.cli import accuracy, methods, stability
from derive.cli.arguments.keywords import keywords
from derive.cli.result_files import drawing, print_result
from derive.cli.specifications import read_changed_scene, read_planar_scene
from derive.errors import SpecError
from derive.progress_line import show_progress
from derive.spec.model.scene import Scene
from derive.spec.model.specification import AnyScene
from derive.spec.set_values import SetValue
from derive.spec.toml.read import with_lines
from derive.study.frame_cost_chart import frame_cost_svg
from derive.study.frame_cost_table import frame_cost_data, frame_cost_text
from derive.study.frame_study import study_frames
from derive.study.pivot_study import study_pivots
from derive.study.pivot_table import pivot_data, pivot_text

FRAMES, PIVOTS = "frames", "pivots"
EXPECTED_SIZE = 100_000
"""The approximate size of the chart of frames, in bytes."""


def run(options: argparse.Namespace) -> int:
    """Run the study that is asked for. Raises SpecError if it needs a beam and there is none."""
    try:
        if options.study in IN_PLANE:
            return IN_PLANE[options.study](read_planar_scene(options.spec), options)
        scene, changes = read_changed_scene(options.spec, options.set)
        return STUDIES[options.study](scene, changes, options)
    except SpecError as error:
        raise (with_lines(error, options.spec) if error.source is None else error) from None
    finally:
        show_progress()


def _frames(scene: Scene, options: argparse.Namespace) -> int:
    target = options.chart or Path("results") / scene.name / f"{FRAMES}.svg"
    check_folder([File(target.name, "")], target.parent, EXPECTED_SIZE)
    study = study_frames(scene, **keywords(study_frames, options), progress=True)
    with drawing(scene.name):
        write([File(target.name, frame_cost_svg(study))], target.parent)
    print_result(frame_cost_text(study), frame_cost_data(study), [str(target)], options.json)
    return 0


def _pivots(scene: Scene, options: argparse.Namespace) -> int:
    study = study_pivots(scene, **keywords(study_pivots, options), progress=True)
    print(json.dumps(pivot_data(study), indent=2) if options.json else pivot_text(study))
    return 0


IN_PLANE: dict[str, Callable[[Scene, argparse.Namespace], int]] = {FRAMES: _frames, PIVOTS: _pivots}
"""The studies of planar scenes alone."""
STUDIES: dict[str, Callable[[AnyScene, Sequence[SetValue], argparse.Namespace], int]] = {
    accuracy.NAME: accuracy.run,
    methods.NAME: methods.run,
    stability.NAME: stability.run,
}
"""The studies that scenes in space have as well, with values that are set."""
