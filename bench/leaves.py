"""Flexible bodies on trees of rigid ones: what accelerations take by articulated bodies and by the KKT matrix.

python bench/leaves.py [--only NAME ...] [--flags FLAGS] [--repeats N]

Arms whose last link is flexible, satellites with two panels, a crane, and a linkage with a flexible coupler, in
straight-line code; the number behind a name is that of the modes of a flexible body. Non-zeros, operations and ns as in
bench/coordinates.py; the forms run alternately in one process. That they have the same values is tested in
tests/space/test_flexible_leaves.py.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from unittest import mock

from coordinates import FLAGS, REPEATS, figures_of, table
from leaf_scenes import leaf_scene
from machine import described

import derive
from derive.ir.model import Model
from derive.lowering.flat import constraints
from derive.lowering.flat.lower import lower

CASES = ("arm_4", "arm_8", "satellite_4", "satellite_8", "crane_4", "crane_8", "linkage_4", "linkage_8")


def models(case: str) -> dict[str, Model]:
    """The models of a case: as they are lowered, with the KKT matrix, and with coordinates of each body."""
    scene = replace(leaf_scene(case), lowering="flat")
    equations = derive.derive(replace(scene, coordinates="relative")).expanded()
    with mock.patch.object(constraints, "by_articulated_bodies", lambda *_: False):
        by_factors = lower(equations, explicit=True)
    absolute = lower(derive.derive(replace(scene, coordinates="absolute")).expanded(), explicit=True)
    return {"relative": lower(equations, explicit=True), "relative, KKT matrix": by_factors, "absolute": absolute}


def main(argv: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="+", default=CASES, metavar="NAME", help=", ".join(CASES))
    parser.add_argument("--flags", default=FLAGS)
    parser.add_argument("--repeats", type=int, default=REPEATS)
    options = parser.parse_args(argv)
    found = []
    for case in options.only:
        with tempfile.TemporaryDirectory(prefix="tisserand-bench-") as folder:
            found += figures_of(case, models(case), options.flags, options.repeats, Path(folder))
    print("\n".join([*described(), "", table(found)]))


if __name__ == "__main__":
    main()
