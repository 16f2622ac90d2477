"""The arguments of `tisserand study`. Only light modules are imported here."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from derive.cli.arguments.ladder import add_ladder, add_spatial_ladder, joined
from derive.cli.arguments.stability import add_stability
from derive.cli.arguments.types import (
    SPEC,
    add_command,
    add_no_cache,
    add_set,
    among,
    count,
    error_fraction,
    folder,
    pieces,
    spec_file,
    tolerance,
)
from derive.study.study_options import (
    ACCURACY,
    COMPARED_FRAMES,
    ELIMINATIONS,
    ERROR,
    FIXED_STEPS,
    FRAME_PAIR,
    FRAME_PIECES,
    FRAME_RUNS,
    METHODS,
    NUMBERINGS,
    PIVOT_STATES,
    RUNS,
    STATES,
    STEPS,
    STUDIED_METHODS,
    TOLERANCES,
)


def add_study(commands: Any) -> None:
    """Add the command `study` with its studies."""
    study = add_command(
        commands, "study", "compare models of a scene, frames, or methods: what they cost, and where they fail"
    )
    studies = study.add_subparsers(dest="study", metavar="STUDY", required=True, title="studies")
    frames = add_command(studies, "frames", "compare non-zeros, operations and CPU time in two frames")
    pivots = add_command(studies, "pivots", "compare vanishing pivots, pivot growth and backward errors in two frames")
    for command in (frames, pivots):
        command.add_argument("spec", type=spec_file, metavar="SPEC", help=f"{SPEC} of a scene with a beam")
        command.add_argument(
            "--frames",
            type=two_frames,
            default=FRAME_PAIR,
            metavar="A,B",
            help=f"two frames (default: {joined(FRAME_PAIR)})",
        )
        add_no_cache(command)
        command.add_argument("--json", action="store_true", help="print the numbers as JSON")
    frames.add_argument(
        "--pieces",
        type=pieces,
        default=FRAME_PIECES,
        metavar="N,...",
        help=f"numbers of beams per rod (default: {joined(FRAME_PIECES)})",
    )
    frames.add_argument(
        "--elimination",
        choices=ELIMINATIONS,
        default=ELIMINATIONS[0],
        help="the order in which KKT matrices are eliminated: safe in every state as in generated code, or each "
        "multiplier matched to a coordinate, with less fill-in (default: safe)",
    )
    frames.add_argument(
        "--runs",
        type=count,
        default=FRAME_RUNS,
        metavar="N",
        help=f"interleaved measurements of each frame (default: {FRAME_RUNS})",
    )
    frames.add_argument("--chart", type=Path, metavar="FILE", help="chart (default: results/NAME/frames.svg)")
    pivots.add_argument(
        "--pieces", type=pieces, metavar="N,...", help="numbers of beams per rod (default: as specified)"
    )
    pivots.add_argument(
        "--states",
        type=count,
        default=PIVOT_STATES,
        metavar="N",
        help=f"states along the motion (default: {PIVOT_STATES})",
    )
    pivots.add_argument(
        "--numberings",
        type=count,
        default=NUMBERINGS,
        metavar="N",
        help=f"random numberings of the unknowns (default: {NUMBERINGS})",
    )
    _add_accuracy(studies)
    _add_methods(studies)
    add_stability(studies)


def _add_methods(studies: Any) -> None:
    methods = add_command(studies, "methods", "limits of steps, drift, ringing, conditioning: by theory and experiment")
    methods.add_argument("spec", type=spec_file, metavar="SPEC", help=f"{SPEC} of a scene, which may be rigid")
    methods.add_argument(
        "--steps", type=count, default=STEPS, metavar="N", help=f"steps of the runs that show drift (default: {STEPS})"
    )
    methods.add_argument(
        "--states", type=states, default=STATES, metavar="N", help=f"states along the motion (default: {STATES})"
    )
    methods.add_argument(
        "--integrators",
        type=integrators,
        default=STUDIED_METHODS,
        metavar="A,...",
        help="among rk4, adaptive, rk45, generalised-alpha and trapezoidal, which is generalised-alpha with rho = 1 "
        "(default: all but rk45, which calls Python at each step)",
    )
    methods.add_argument(
        "--out",
        type=folder,
        metavar="FOLDER",
        help="folder of the picture, the page and the table (default: results/NAME)",
    )
    add_set(methods)
    add_no_cache(methods)
    methods.add_argument("--json", action="store_true", help="print the numbers as JSON")


def integrators(text: str) -> tuple[str, ...]:
    """Integrators of a study of methods by their names."""
    return among(text, METHODS)


def states(text: str) -> int:
    """A number of states along a motion, at least two for its ends."""
    number = count(text)
    if number < 2:
        raise argparse.ArgumentTypeError(f"a motion has at least 2 states, not {number}")
    return number


def _add_accuracy(studies: Any) -> None:
    accuracy = add_command(studies, "accuracy", "chart the error of a ladder of models against what they cost")
    accuracy.add_argument(
        "spec", type=spec_file, metavar="SPEC", help=f"{SPEC} of a scene with a flexible body and a plot"
    )
    accuracy.add_argument(
        "--out",
        type=folder,
        metavar="FOLDER",
        help="folder of the chart, the page and the table (default: results/NAME)",
    )
    accuracy.add_argument("--plot", metavar="NAME", help="the plot that is compared (default: the first one)")
    accuracy.add_argument(
        "--error",
        type=error_fraction,
        default=ERROR,
        metavar="X",
        help=f"largest error (rms) that is allowed, relative to the peak (default: {ERROR})",
    )
    accuracy.add_argument(
        "--reference-error",
        type=error_fraction,
        metavar="X",
        help="error (rms) of the reference file itself, relative to the peak",
    )
    accuracy.add_argument(
        "--own-reference", action="store_true", help="compare with ever finer models in place of the file of the plot"
    )
    add_ladder(accuracy, ACCURACY)
    add_spatial_ladder(accuracy, ACCURACY)
    accuracy.add_argument(
        "--tolerances",
        type=tolerances,
        default=TOLERANCES,
        metavar="X,...",
        help=f"of the adaptive integrator, for each model (default: {joined(TOLERANCES)})",
    )
    accuracy.add_argument(
        "--integrators",
        type=fixed_step_integrators,
        default=(),
        metavar="A,...",
        help="integrators with fixed steps beside the adaptive one, among rk4 and generalised-alpha: parts of the "
        "longest stable step, and of the longest period (default: none)",
    )
    accuracy.add_argument(
        "--also",
        type=spec_file,
        action="append",
        default=[],
        metavar="SPEC",
        help="scene with other bodies in place of these, whose models are compared as well (default: none)",
    )
    accuracy.add_argument(
        "--peers",
        type=Path,
        metavar="FILE",
        help="CSV of runs of other programs: model, cpu_s, rms_error, largest_error (default: none)",
    )
    accuracy.add_argument(
        "--runs", type=count, default=RUNS, metavar="N", help=f"interleaved measurements of each run (default: {RUNS})"
    )
    add_set(accuracy)
    add_no_cache(accuracy)
    accuracy.add_argument("--json", action="store_true", help="print the numbers as JSON")


def fixed_step_integrators(text: str) -> tuple[str, ...]:
    """Integrators with fixed steps by their names."""
    return among(text, FIXED_STEPS)


def tolerances(text: str) -> tuple[float, ...]:
    """Tolerances from coarse to fine."""
    return tuple(sorted({tolerance(part) for part in text.split(",")}, reverse=True))


def two_frames(text: str) -> Sequence[str]:
    """Two frames by their names."""
    names = tuple(text.split(","))
    if len(set(names)) != 2 or len(names) != 2 or not set(names) <= set(COMPARED_FRAMES):
        raise argparse.ArgumentTypeError(f"expected two of mean, point and chord, such as mean,point, not {text!r}")
    return names
