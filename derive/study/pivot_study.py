"""The study of pivots: how stable the elimination of the KKT matrix of a scene is in two frames of its beams."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from derive.display import Tabulated
from derive.remaining_time import RemainingTime
from derive.short_text import summary
from derive.simulation.inputs import with_functions
from derive.simulation.observables.beams import beam_bodies
from derive.spec.model.scene import Scene
from derive.study.pivot_stability import FrameStability, frame_stability
from derive.study.states import period
from derive.study.studied_scene import COMPARED, planar_scene
from derive.study.study_options import (
    FRAME_PAIR,
    MAX_PIECES,
    NUMBERINGS,
    PIVOT_STATES,
    frame_pair,
    numbers,
    whole,
)
from derive.study.variants import variant
from derive.terminal import Report, beam_count, reports_of


@dataclass(frozen=True)
class PivotComparison:
    """The stability of the elimination in two frames, with rods of `pieces` beams."""

    pieces: int
    frames: tuple[FrameStability, FrameStability]


@dataclass(frozen=True, repr=False)
class PivotStudy(Tabulated):
    """The pivots of the KKT matrix of a scene in two frames, in elimination orders that are determined once.

    `to_pandas` returns a pandas.DataFrame with a row for each elimination order, frame and kind of states.

    Attributes:
        name: that of the scene.
        along: the motion from which the states are taken, in words.
        rows: a comparison for each number of beams in a rod.

    Examples:
        >>> import derive
        >>> rod = derive.scene(
        ...     "rod",
        ...     ground={"pin": [0, 0]},
        ...     bodies={"rod": {"mass": 1, "length": 1, "bending_stiffness": 20, "markers": {"left": -1}}},
        ...     joints={"pin": {"kind": "revolute", "between": ["ground.pin", "rod.left"]}},
        ...     simulation={"duration": 0.1, "output": 0.01},
        ... )
        >>> study = derive.study_pivots(rod, states=5, numberings=2)
        >>> study.along, [frame.undeformed.vanishing_mass for frame in study.rows[0].frames]
        ('0.1 s', [0, 6])
        >>> list(study.to_pandas().columns[:4])
        ['pieces', 'order', 'frame', 'states']
    """

    name: str
    along: str
    rows: tuple[PivotComparison, ...]

    def __repr__(self) -> str:
        frames = " and ".join(frame.frame for frame in self.rows[0].frames)
        return summary(
            f"PivotStudy of {self.name} along {self.along}",
            {"frames": frames, "rods of": ", ".join(beam_count(row.pieces) for row in self.rows)},
        )


def study_pivots(
    scene: Scene,
    *,
    frames: Sequence[str] = FRAME_PAIR,
    pieces: Sequence[int] | None = None,
    states: int = PIVOT_STATES,
    numberings: int = NUMBERINGS,
    progress: Report | bool | None = None,
) -> PivotStudy:
    """Compare vanishing pivots, pivot growth and backward errors of a scene in two frames of its beams.

    The command `tisserand study pivots` calls this function.

    Arguments:
        scene: a planar scene with a beam and a simulation.
        frames: two among "mean", "point" and "chord".
        pieces: the numbers of beams into which a rod is divided; by default as the scene has them.
        states: the number of states of each kind, undeformed and simulated.
        numberings: the number of random numberings of the unknowns in which orders are tried.
        progress: called with a line of text on each step; True shows a line with the remaining time, False shows none;
            by default notebooks show one.

    Raises:
        SpecError: if the scene has no beam or no simulation, or its shapes do not fit a frame.
        RedundantJoints: if joints are redundant, so that a pivot vanishes in every order.
        UnknownNameError: for a frame that there is not.
        ValueError: for a number out of its range, and unless there are two frames.
        TypeError: for what is no planar scene.
        SimulationError: if the scene cannot be simulated.
        CompilerError: if there is no compiler.

    Examples:
        >>> import derive
        >>> rod = derive.scene(
        ...     "rod",
        ...     ground={"pin": [0, 0]},
        ...     bodies={"rod": {"mass": 1, "length": 1, "bending_stiffness": 20, "markers": {"left": -1}}},
        ...     joints={"pin": {"kind": "revolute", "between": ["ground.pin", "rod.left"]}},
        ...     simulation={"duration": 0.1, "output": 0.01},
        ... )
        >>> study = derive.study_pivots(rod, states=5, numberings=2)
        >>> [frame.frame for frame in study.rows[0].frames]
        ['mean', 'point']
    """
    compared, counts = frame_pair(frames), (whole("states", states), whole("numberings", numberings))
    cut = None if pieces is None else numbers("pieces", pieces, MAX_PIECES)
    given = with_functions(planar_scene(scene, COMPARED.format("pivots")), {})
    cut = cut or tuple(sorted({beam.pieces for beam in beam_bodies(given)}))
    remaining = RemainingTime(len(cut) * len(compared))
    with reports_of(progress, given.name) as (task, _):
        rows = []
        for n in cut:
            first, second = (
                frame_stability(variant(given, n, frame), *counts, f"model {remaining.next()}: ", task)
                for frame in compared
            )
            rows.append(PivotComparison(n, (first, second)))
    return PivotStudy(given.name, period(given)[1], tuple(rows))
