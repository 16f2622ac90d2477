"""The study of frames: the cost of one scene in two frames of its beams, for several numbers of beams in a rod."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from derive.display import Tabulated
from derive.lowering.elimination_orders import EliminationRule
from derive.short_text import summary
from derive.simulation.inputs import with_functions
from derive.spec.model.scene import Scene
from derive.study.frame_cost import FrameComparison, compare_frames
from derive.study.studied_scene import COMPARED, planar_scene
from derive.study.study_options import (
    ELIMINATIONS,
    FRAME_PAIR,
    FRAME_PIECES,
    FRAME_RUNS,
    MAX_PIECES,
    among,
    frame_pair,
    numbers,
    whole,
)
from derive.terminal import Report, beam_count, reports_of


@dataclass(frozen=True, repr=False)
class FrameStudy(Tabulated):
    """The non-zeros, operations and CPU times of a scene in two frames.

    `to_pandas` returns a pandas.DataFrame with a row for each frame and number of beams, and one for their ratio.

    Attributes:
        name: that of the scene.
        frames: the two frames, of which the cost of the first is divided by that of the second.
        elimination: the order in which the KKT matrices are eliminated.
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
        >>> study = derive.study_frames(rod, pieces=[1], runs=1)
        >>> [cost.counts.mass for cost in study.rows[0].costs]
        [5, 15]
        >>> list(study.to_pandas().columns[:3])
        ['pieces', 'frame', 'mass']
    """

    name: str
    frames: tuple[str, str]
    elimination: EliminationRule
    rows: tuple[FrameComparison, ...]

    def __repr__(self) -> str:
        ratios = (f"{beam_count(row.pieces)} {row.times.integration_ratio.median:.2f}" for row in self.rows)
        frames = " over ".join(self.frames)
        return summary(f"FrameStudy of {self.name}", {f"CPU time, {frames}": ", ".join(ratios)})


def study_frames(
    scene: Scene,
    *,
    frames: Sequence[str] = FRAME_PAIR,
    pieces: Sequence[int] = FRAME_PIECES,
    elimination: str = ELIMINATIONS[0],
    runs: int = FRAME_RUNS,
    progress: Report | bool | None = None,
) -> FrameStudy:
    """Compare the non-zeros, operations and CPU times of a scene in two frames of its beams.

    The command `tisserand study frames` calls this function.

    Arguments:
        scene: a planar scene with a beam and a simulation.
        frames: two among "mean", "point" and "chord".
        pieces: the numbers of beams into which a rod is divided.
        elimination: "safe", the order of generated code, in which no pivot vanishes, or "matched", with less fill-in.
        runs: the number of measurements of each frame, which take turns.
        progress: called with a line of text on each step; True shows a line with the remaining time, False shows none;
            by default notebooks show one.

    Raises:
        SpecError: if the scene has no beam or no simulation, or its shapes do not fit a frame.
        UnknownNameError: for a frame or an elimination that there is not.
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
        >>> [row.pieces for row in derive.study_frames(rod, pieces=[1, 2], runs=1).rows]
        [1, 2]
    """
    compared = frame_pair(frames)
    rule = EliminationRule(*among("elimination", [elimination], ELIMINATIONS))
    counts, measurements = numbers("pieces", pieces, MAX_PIECES), whole("runs", runs)
    given = with_functions(planar_scene(scene, COMPARED.format("frames")), {})
    with reports_of(progress, given.name) as (task, _):
        rows = compare_frames(given, counts, compared, measurements, rule, task)
    return FrameStudy(given.name, compared, rule, rows)
