"""The stability of all models of a ladder over a parameter, beside the truth: a known value, or the richest model."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

from derive.display import Tabulated
from derive.enumerations import enumeration
from derive.remaining_time import RemainingTime
from derive.short_text import counted, summary
from derive.simulation.errors import SimulationError
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene
from derive.study.accuracy.ladder_model import LadderModel
from derive.study.accuracy.models import ladder, refinements
from derive.study.stability.model_path import ModelPath, model_path
from derive.study.stability.parameter import ParameterRange, StudiedParameter, parameter_range, studied
from derive.study.stability.thresholds import Interval, wrong_intervals
from derive.study.studied_scene import COMPARED, flexible_scene
from derive.study.study_options import NEVER, STABILITY, LadderRange
from derive.terminal import Report, reports_of

CONVERGED = 0.05
"""The reference has converged if the verdicts of both richest models differ over less than this part of a threshold."""


TRIED = 4
"""The number of models in space, ever finer, of which the first two that agree give the reference."""
HOPELESS = 3
"""The number of models of which none has a steady motion, after which no other is tried."""


@dataclass(frozen=True)
class KnownLoss:
    """The known value at which stability is lost; None if it is never lost."""

    value: float | None


@dataclass(frozen=True, eq=False, repr=False)
class LadderStability(Tabulated):
    """The result of a study of stability: where the models of a ladder lose their stability as a parameter grows.

    `to_pandas` returns a pandas.DataFrame with a row for each mode of each model at each value of the parameter.

    Attributes:
        name: that of the scene.
        range: the parameter with its values.
        paths: the models, each with its eigenvalues and thresholds.
        reference: the richest model.
        before: the next coarser one, whose difference is the error of the reference.
        known: the value at which stability is lost, where it is given.
        motion: the text on the motion about which the models are linearised.

    Examples:
        >>> import derive
        >>> column = derive.scene(
        ...     "column",
        ...     parameters={"P": {"unit": "N", "default": 0}},
        ...     ground={"base": [0, 0]},
        ...     bodies={"rod": {"mass": 1, "length": 1, "bending_stiffness": 1, "markers": {"root": -1, "tip": 1}}},
        ...     joints={"clamp": {"kind": "weld", "between": ["ground.base", "rod.root"]}},
        ...     forces={"load": {"at": "rod.tip", "components": ["-P", 0]}},
        ...     simulation={"duration": 1, "output": 0.1},
        ... )
        >>> study = derive.study_stability(column, ("P", 2, 3.5, 2), shapes=[2], pieces=[], sines=[])
        >>> [(path.model.label, round(path.loss, 2)) for path in study.paths if path.loss]
        [('1 beam, P2, P3, first', 3.01), ('1 beam, P2, P3, truncated', 2.49)]
        >>> study.to_pandas()["parameter"].max().item()
        3.5
    """

    name: str
    range: ParameterRange
    paths: tuple[ModelPath, ...]
    reference: ModelPath
    before: ModelPath
    known: KnownLoss | None = None
    motion: str = ""

    @property
    def unit(self) -> str:
        """The unit of the parameter; empty if it is not known."""
        return self.reference.unit

    @property
    def error(self) -> float | None:
        """The difference of the losses of the two richest models; None if one of them loses no stability."""
        a, b = self.reference.loss, self.before.loss
        return None if a is None or b is None else abs(a - b)

    @property
    def converged(self) -> bool:
        """Whether the truth is known: given, or both richest models have the same verdicts, up to small distances."""
        return self.known is not None or agree(self.before, self.reference)

    @property
    def truth(self) -> tuple[Interval, ...]:
        """The intervals in which the truth is stable or not: from the known value, or those of the richest model."""
        if self.known is None:
            return self.reference.intervals
        low, high, at = self.range.low, self.range.high, self.known.value
        if at is None or at >= high:
            return (Interval(low, high, True),)
        if at <= low:
            return (Interval(low, high, False),)
        return Interval(low, at, True), Interval(at, high, False)

    @property
    def true_loss(self) -> float | None:
        """The value at which the truth loses its stability; None if it does not."""
        return self.reference.loss if self.known is None else self.known.value

    def wrong(self, path: ModelPath) -> tuple[Interval, ...]:
        """The intervals where the model of a `path` is stable and the truth is not, or vice versa, beyond its error.

        Nothing is wrong while the truth is not known: then the verdict is undecided.

        Examples:
            >>> [(round(wrong.low, 2), round(wrong.high, 2)) for wrong in study.wrong(study.paths[1])]
            [(2.47, 3.01)]
        """
        if not self.converged:
            return ()
        return wrong_intervals(path.intervals, self.truth, 0.0 if self.known else self.error or 0.0)

    def __repr__(self) -> str:
        return summary(f"LadderStability of {self.name}: {counted(len(self.paths), 'model')}", {"about": self.motion})


def agree(before: ModelPath, richest: ModelPath) -> bool:
    """Whether the verdicts of two models are the same, up to small distances."""
    both = (richest, before)
    if any(path.failure or path.gaps for path in both) or (richest.loss is None) != (before.loss is None):
        return False
    largest = max((abs(c.value) for path in both for c in path.thresholds), default=0.0)
    return not wrong_intervals(before.intervals, richest.intervals, CONVERGED * largest)


def distance(value: float | None, truth: float | None) -> float | None:
    """The relative distance of a threshold from the true one; None if one of them is missing, or the true one is 0."""
    return None if value is None or not truth else (value - truth) / abs(truth)


def study_stability(
    scene: AnyScene,
    parameter: tuple[str, float, float, int],
    *,
    exact: float | str | None = None,
    orders: Sequence[str] = STABILITY.orders,
    frames: Sequence[str] = STABILITY.frames,
    shapes: Sequence[int] = STABILITY.shapes,
    pieces: Sequence[int] = STABILITY.pieces,
    sines: Sequence[int] = STABILITY.sines,
    modes: Sequence[str] = STABILITY.modes,
    torsion: Sequence[int] = STABILITY.torsion,
    component_modes: Sequence[str] = STABILITY.component_modes,
    component_counts: Sequence[int] = STABILITY.component_counts,
    progress: Report | bool | None = None,
) -> LadderStability:
    """Find where each model of a ladder loses its stability as a parameter of a scene grows.

    The command `tisserand study stability` calls this function.

    Arguments:
        scene: a scene with a beam, or in space with a finite-element body, and a simulation.
        parameter: the name of a parameter or a key such as "P" or "bodies.rod.start.spin", its first and its last
            value, and the number of values from 2 on.
        exact: the value at which stability is lost, or "none" if it never is: the truth in place of the richest model.
        orders: those of the displacements, among "first", "truncated" and "full".
        frames: those of polynomials, among "mean", "chord", "point" and "tangent".
        shapes: the numbers of polynomials of one beam.
        pieces: the numbers of beams, with two polynomials each, into which a beam is divided.
        sines: the numbers of half sine waves of one beam.
        modes: other natural modes in the same numbers, among "free-free" and "clamped-free".
        torsion: the numbers of shapes of torsion of a beam in space; by default as the scene has them.
        component_modes: modes of finite-element bodies, among "free", "craig_bampton" and "attachment".
        component_counts: the numbers of these modes, beside the static ones of the interface.
        progress: called with a line of text on each model; True shows a line with the remaining time, False shows none;
            by default notebooks show one.

    Raises:
        SpecError: if the scene has no flexible body or no simulation, or the parameter cannot have these values.
        UnknownNameError: for an order, a frame or modes that there are not.
        ValueError: for numbers out of their range.
        TypeError: for what is no scene.
        SimulationError: if no model has a steady motion.
        CompilerError: if there is no compiler.

    Examples:
        >>> import derive
        >>> column = derive.scene(
        ...     "column",
        ...     parameters={"P": {"unit": "N", "default": 0}},
        ...     ground={"base": [0, 0]},
        ...     bodies={"rod": {"mass": 1, "length": 1, "bending_stiffness": 1, "markers": {"root": -1, "tip": 1}}},
        ...     joints={"clamp": {"kind": "weld", "between": ["ground.base", "rod.root"]}},
        ...     forces={"load": {"at": "rod.tip", "components": ["-P", 0]}},
        ...     simulation={"duration": 1, "output": 0.1},
        ... )
        >>> study = derive.study_stability(column, ("P", 2, 3.5, 2), shapes=[2], pieces=[], sines=[])
        >>> round(study.reference.loss, 3)  # that of Euler is pi^2 / 4
        2.467
    """
    values = parameter_range(parameter)
    limits = LadderRange(orders, frames, shapes, pieces, sines, modes, torsion, component_modes, component_counts)
    if isinstance(exact, str) and exact != NEVER:
        raise ValueError(f'exact: a number or "{NEVER}" is needed, not {exact!r}')
    known = None if exact is None else KnownLoss(None if isinstance(exact, str) else exact)
    whole = flexible_scene(scene, COMPARED.format("stability"))
    given, models = studied(whole, values), ladder(limits, whole)
    with reports_of(progress, whole.name) as (task, result):
        return ladder_stability(scene.name, given, models, known, task, result)


def ladder_stability(
    name: str,
    parameter: StudiedParameter,
    models: Sequence[LadderModel],
    known: KnownLoss | None,
    progress: Callable[[str], None],
    result: Callable[[str], None],
) -> LadderStability:
    """The stability of the models of a ladder, and of the two richest models. Raises CompilerError, SimulationError."""
    if changing := parameter.functions.changing:
        raise SimulationError(
            f"no motion is steady, since these functions of time never come to rest: {enumeration(changing)}; give "
            "them an end, for example by step(t, ...), or a constant value by --set"
        )
    steps = refinements(parameter.scene)
    steps = steps[:TRIED] if isinstance(parameter.scene, SpatialScene) else steps[-2:]  # planar models are quick
    paths: dict[LadderModel, ModelPath] = {}
    remaining = RemainingTime(len({*models, *steps[:2]}))

    def compute(model: LadderModel) -> ModelPath:
        if model not in paths:
            model_text = f"model {remaining.next()}: {model.label}"
            progress(f"{model_text} ...")
            paths[model] = path = model_path(parameter, model)
            loss = "no loss of stability found" if path.loss is None else f"loses its stability at {path.loss:.7g}"
            result(f"{model_text}: {as_before(path) or path.failure or loss}")
        return paths[model]

    def as_before(path: ModelPath) -> str:
        """The text on a failure that an earlier model has as well, whose reason is told already."""
        earlier = next((other for other in paths.values() if path.failure and other.failure == path.failure), path)
        return "" if earlier is path else f"it fails as {earlier.model.label} does"

    def is_hopeless() -> bool:
        """Whether the first models, which are quick, have motions and no steady one: others cost minutes each."""
        return sum(path.coordinates > 0 for path in paths.values()) >= HOPELESS and all(
            p.failure for p in paths.values()
        )

    for model in models:
        compute(model)
        if is_hopeless():
            break
    for before, richest in pairwise(steps):
        if is_hopeless():
            break
        pair = compute(before), compute(richest)
        if known is not None or agree(*pair):
            break
    if all(path.failure for path in paths.values()):
        reasons = [f"  {reason}" for reason in dict.fromkeys(path.failure for path in paths.values())]
        advice = dict.fromkeys(f"advice: {path.advice}" for path in paths.values() if path.advice)
        left = len({*models} - {*paths})
        untried = (
            [f"{counted(left, 'finer model')} of the ladder {'was' if left == 1 else 'were'} not tried"] if left else []
        )
        raise SimulationError("\n".join(["no model has a steady motion:", *reasons, *advice, *untried]))
    shown = tuple(paths[model] for model in models)
    return LadderStability(name, parameter.range, shown, paths[richest], paths[before], known, parameter.motion)
