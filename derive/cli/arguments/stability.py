"""The arguments of `tisserand study stability`. Only light modules are imported here."""

from __future__ import annotations

import argparse
import math
from typing import Any

from derive.cli.arguments.ladder import add_ladder, add_spatial_ladder
from derive.cli.arguments.types import (
    SPEC,
    add_command,
    add_no_cache,
    add_set,
    folder,
    number,
    spec_file,
)
from derive.study.study_options import MAX_VALUES, NEVER, STABILITY


def add_stability(studies: Any) -> None:
    """Add the study `stability`."""
    stability = add_command(
        studies, "stability", "find where each model of a ladder loses its stability as a parameter grows"
    )
    stability.add_argument("spec", type=spec_file, metavar="SPEC", help=f"{SPEC} of a scene with a flexible body")
    stability.add_argument(
        "--parameter",
        type=parameter,
        required=True,
        metavar="NAME=A:B:N",
        help="a parameter or a key as that of --set, such as P or bodies.rod.start.spin, and N values from A to B",
    )
    stability.add_argument(
        "--exact",
        type=exact,
        metavar="X",
        help="the known value at which stability is lost, or none: the truth in place of the richest model",
    )
    add_ladder(stability, STABILITY)
    add_spatial_ladder(stability, STABILITY)
    stability.add_argument(
        "--out", type=folder, metavar="FOLDER", help="folder of the chart and the tables (default: results/NAME)"
    )
    add_set(stability)
    add_no_cache(stability)
    stability.add_argument("--json", action="store_true", help="print the numbers as JSON")


def parameter(text: str) -> tuple[str, float, float, int]:
    """A name, the first and the last value, and how many values there are."""
    wanted = f"expected NAME=A:B:N, such as P=0:30:31, with N values from A to B, not {text!r}"
    name, _, rest = (part.strip() for part in text.rpartition("="))
    parts = rest.split(":")
    if not name or len(parts) != 3 or not parts[2].strip().isdecimal():
        raise argparse.ArgumentTypeError(wanted)
    low, high, count = number(parts[0]), number(parts[1]), int(parts[2])
    if not (math.isfinite(low) and math.isfinite(high) and low < high):
        raise argparse.ArgumentTypeError(f"{wanted}; A and B are numbers, and A is less than B")
    if not 2 <= count <= MAX_VALUES:
        raise argparse.ArgumentTypeError(f"{wanted}; N is between 2 and {MAX_VALUES}")
    return name, low, high, count


def exact(text: str) -> float | str:
    """A number, or `none`."""
    value = number(text)
    if text.strip() == NEVER:
        return NEVER
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"expected a number, or {NEVER} if stability is never lost, not {text!r}")
    return value
