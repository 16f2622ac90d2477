"""The forms of the equations of trees: relative against absolute coordinates, and two ways to accelerations.

Both coordinates give the same motion of the markers. Articulated bodies with flexible ones as leaves and the factors of
the KKT matrix give the same accelerations and multipliers in a random state.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

import derive
from corpus.commands import Finding
from corpus.flexible_trees import NAME
from corpus.generator import CorpusScene
from derive.simulation.prepared_run import PreparedRun
from derive.spec.model.spatial_scene import SpatialScene

sys.path.append(str(Path(__file__).parents[1] / "space"))
from leaves_on_trees import both_ways_of

SAME = 1e-6
"""The largest distance of two motions, relative to the largest number above 1 in them."""
TOLERANCE = 1e-9
"""The error of the integration of these motions."""
BENT = 1e-4
"""The amplitudes of this state: matrices of truncated beams that bend far are not positive definite."""
ROUNDING = 1e-9
"""The largest difference of accelerations in a state, relative to the largest one; frequencies of beams are high."""


def has_flexible_trees(scene: CorpusScene) -> bool:
    """Whether a scene is drawn with flexible bodies on trees of rigid ones."""
    return NAME in scene.linkage


def forms(path: Path) -> Iterator[Finding]:
    """Yield the differences between the forms of the equations of a scene."""
    spec = derive.read(path)
    assert isinstance(spec, SpatialScene)
    yield from _motions(spec)
    yield from _accelerations(spec)


def _motions(spec: SpatialScene) -> Iterator[Finding]:
    """The poses of all bodies along the motion in both coordinates."""
    relative, absolute = (_poses(replace(spec, coordinates=of)) for of in ("relative", "absolute"))
    size = max(1.0, float(np.abs(absolute).max(initial=0)))
    worst = float(np.abs(relative - absolute).max(initial=0)) / size
    if not worst < SAME:
        yield Finding("coordinates", "relative and absolute ones have different motions", f"{worst:.2g}")


def _poses(spec: SpatialScene) -> np.ndarray:
    """Positions and rotation matrices of all bodies in the rows of the motion."""
    assert spec.simulation
    run = PreparedRun(replace(spec, simulation=replace(spec.simulation, tolerance=TOLERANCE)), complete=False)
    motion = run.trajectory().motion
    return np.array([motion.native.poses(t, q, motion.k) for t, q in zip(motion.t, motion.q, strict=True)])


def _accelerations(spec: SpatialScene) -> Iterator[Finding]:
    """Accelerations and multipliers by both ways; none if the scene has no tree, or redundant constraints."""
    solved = both_ways_of(replace(spec, coordinates="relative", redundant="auto"), bent=BENT)
    for name in ("vdot", "multipliers") if solved else ():
        a, b = (getattr(way, name) for way in solved)
        worst = float(np.abs(a - b).max(initial=0)) / max(float(np.abs(b).max(initial=0)), 1e-12)
        if not worst < ROUNDING:
            yield Finding("accelerations", f"articulated bodies and the KKT matrix differ in {name}", f"{worst:.2g}")
