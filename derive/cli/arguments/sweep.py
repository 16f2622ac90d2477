"""The arguments of `tisserand sweep`. Only the standard library is imported here."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from derive.cli.arguments.types import (
    SPEC,
    add_command,
    add_no_cache,
    assignment,
    count,
    folder,
    seconds,
    spec_file,
    tolerance,
)


def add_sweep(commands: Any) -> None:
    """Add the command `sweep`."""
    sweep = add_command(
        commands, "sweep", "run a scene with many values of its parameters: a table (CSV, NPZ) and a picture (SVG)"
    )
    sweep.add_argument(
        "spec", type=spec_file, metavar="SPEC", help=f"{SPEC} of a scene or a beam with a [simulation] table"
    )
    sweep.add_argument(
        "--set",
        action="append",
        type=assignment,
        default=[],
        metavar="NAME=VALUES",
        help="values of a parameter or a key: a grid start:stop:count (EI=10:100:40, or 10:100:40:log), a list "
        "(EI=10,20,50), a number, or a distribution: uniform(10,100), loguniform(1,100), normal(10,0.5); repeated, "
        "all combinations are run",
    )
    sweep.add_argument(
        "--output",
        action="append",
        required=True,
        metavar="KIND[:NAME]",
        help="the result of a run: peak, rms or final value of a column or a plot, such as peak:slider_s; without a "
        "name that of the first plot; may be repeated",
    )
    sweep.add_argument(
        "--list", type=Path, metavar="FILE", help="samples one by one: a CSV file with a line of names, then of numbers"
    )
    sweep.add_argument("--samples", type=count, metavar="N", help="the number of random samples")
    sweep.add_argument("--seed", type=int, metavar="N", help="the seed of random samples (default: 0)")
    sweep.add_argument(
        "--out", type=folder, default=Path("results"), metavar="FOLDER", help="output folder (default: results)"
    )
    sweep.add_argument(
        "--picture", type=Path, metavar="FILE", help="the picture (default: sweep.svg in the folder of the tables)"
    )
    sweep.add_argument("--duration", type=seconds, metavar="S", help="duration, s, in place of the specified one")
    sweep.add_argument(
        "--interval", type=seconds, metavar="S", help="time between the rows in which peaks are looked for, s"
    )
    sweep.add_argument(
        "--tolerance", type=tolerance, metavar="X", help="tolerance of the error of a step, relative and absolute"
    )
    sweep.add_argument(
        "--until", metavar="CONDITION", help='ends each run, such as "rod_phi > pi/2"; final is the value there'
    )
    workers = sweep.add_mutually_exclusive_group()
    workers.add_argument(
        "--workers", type=count, metavar="N", help="processes of this machine (default: one for each processor)"
    )
    workers.add_argument(
        "--scheduler", metavar="ADDRESS", help="a Dask scheduler whose workers run the samples, tcp://10.0.0.1:8786"
    )
    sweep.add_argument("--resume", action="store_true", help="continue an interrupted sweep in the output folder")
    add_no_cache(sweep)
    sweep.add_argument("--json", action="store_true", help="print the summary as JSON")
