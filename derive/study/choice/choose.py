"""The public function that chooses a model: it checks what it is given, and runs the search."""

from __future__ import annotations

from collections.abc import Sequence

from derive.progress_line import timed_task
from derive.simulation.inputs import with_functions
from derive.spec.model.specification import AnyScene
from derive.study.accuracy.reference import compared_plot
from derive.study.choice.model_runs import ModelRuns
from derive.study.choice.screening import screening
from derive.study.choice.search import Choice, cheapest_model
from derive.study.computed_ahead import available_workers
from derive.study.studied_scene import flexible_scene
from derive.study.study_options import ERROR, fraction
from derive.terminal import Report, reports_of


def choose(
    scene: AnyScene,
    *,
    error: float = ERROR,
    plot: str | Sequence[str] | None = None,
    progress: Report | bool | None = None,
) -> Choice:
    """Choose the cheapest model of the flexible bodies of a scene that is accurate enough, and measure it.

    The command `tisserand choose` calls this function, and writes a specification of the chosen model.

    Arguments:
        scene: a scene with a beam, or in space a finite-element body, with a simulation and a plot.
        error: the largest error (rms) that is allowed, relative to the peak of a curve.
        plot: the name of a plot whose curves have to be accurate, or several; by default the first one.
        progress: called with a line of text on each step; True shows a line with the time so far, False shows none; by
            default notebooks show one.

    Raises:
        SpecError: if the scene has no flexible body, no plot or no simulation, or there is no such plot.
        ValueError: for an error that is not between 0 and 1.
        TypeError: for what is no scene.
        NotConverged: if no reference can be trusted.
        SimulationError: if a model of the reference cannot be simulated.
        CompilerError: if there is no compiler.

    Examples:
        >>> import derive
        >>> arm = derive.scene(
        ...     "arm",
        ...     gravity=(0, -9.81),
        ...     ground={"hub": [0, 0]},
        ...     bodies={"arm": {"mass": 1, "length": 1, "bending_stiffness": 20, "markers": {"root": -1, "tip": 1}}},
        ...     joints={"hub": {"kind": "revolute", "between": ["ground.hub", "arm.root"]}},
        ...     outputs={"tip": {"kind": "position", "marker": "arm.tip"}},
        ...     plots={"height": {"y": "tip_2"}},
        ...     simulation={"duration": 0.3, "output": 0.01},
        ... )
        >>> choice = derive.choose(arm, error=0.05)
        >>> choice.chosen[1].rms < 0.05
        True
    """
    error = fraction("error", error)
    given = flexible_scene(scene, "nothing to choose")
    names = [plot] if plot is None or isinstance(plot, str) else plot
    plots = [compared_plot(given, name) for name in dict.fromkeys(names)]
    with timed_task(f"choose {given.name} {error}"), reports_of(progress, given.name) as (task, result):
        runs = ModelRuns(with_functions(given, {}), plots, task, available_workers())
        try:
            return cheapest_model(runs, error, result, screening(runs))
        finally:
            runs.close()
