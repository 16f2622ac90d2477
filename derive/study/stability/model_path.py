"""A model of a ladder over the parameter: the eigenvalues of its steady motions, and its thresholds of stability."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from derive.errors import Problem, SpecError, TisserandError, first_line
from derive.generated_models import generated
from derive.ir.model import Model
from derive.runtime.compiler import WITHOUT_BATCHES
from derive.runtime.loading import load_scene
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.linear.linearisation import linearise
from derive.simulation.linear.steady_motion import NoSteadyMotion
from derive.simulation.redundant_joints import refuse_dependent, with_redundant_joints
from derive.simulation.scene_start import steady_motion_of, units_of_initial_values
from derive.simulation.validity.fast_spin import fast_spin_notes
from derive.spec.model.beam_pieces import in_pieces
from derive.spec.model.specification import AnyScene
from derive.study.accuracy.ladder_model import LadderModel
from derive.study.accuracy.models import model_scene
from derive.study.stability.eigenvalues import Eigenvalues, eigenvalues
from derive.study.stability.parameter import StudiedParameter
from derive.study.stability.thresholds import Interval, Threshold, intervals, loss, thresholds

FLAGS = ("-std=c99", "-O0", "-ffp-contract=off", WITHOUT_BATCHES)
"""Compiler options: a study calls a model a hundred times, so that -O2 would take longer; it gives the same bits."""


@dataclass(frozen=True, eq=False)
class PathPoint:
    """A value of the parameter with the eigenvalues there, and the coordinates (nq,) of the steady motion.

    failure: the reason why there is no steady motion; empty if there is one. advice: what is to be done then. spins:
    the notes on finite-element bodies that spin fast, by their names.
    """

    value: float
    eigenvalues: Eigenvalues | None
    q: Vector | None = None
    failure: str = ""
    advice: str = ""
    spins: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class ModelPath:
    """A model over the parameter.

    failure: the reason why it has no points; empty if it has some. advice: what is to be done then.
    """

    model: LadderModel
    coordinates: int = 0
    unit: str = ""
    points: tuple[PathPoint, ...] = ()
    thresholds: tuple[Threshold, ...] = ()
    intervals: tuple[Interval, ...] = ()
    failure: str = ""
    advice: str = ""

    @property
    def loss(self) -> float | None:
        """The least value of the parameter at which stability is lost."""
        return loss(self.intervals)

    @property
    def spins(self) -> dict[str, str]:
        """The notes on finite-element bodies that spin fast, each of the last point that has it."""
        return {body: note for point in self.points for body, note in point.spins.items()}

    @property
    def gaps(self) -> tuple[PathPoint, ...]:
        """The points without steady motion."""
        return tuple(point for point in self.points if point.eigenvalues is None)


def model_path(parameter: StudiedParameter, model: LadderModel) -> ModelPath:
    """The eigenvalues of a model over the parameter, and its thresholds. Raises CompilerError."""
    try:
        evaluate, native, unit = _compiled(parameter, model)
    except SpecError as error:
        return ModelPath(model, failure=first_line(error))
    points: list[PathPoint] = []
    for value in parameter.range.values:
        points.append(evaluate(value, points[-1].q if points else None))
    if all(point.eigenvalues is None for point in points):
        return ModelPath(model, native.nq, unit, failure=points[0].failure, advice=points[0].advice)

    def count(value: float) -> int | None:
        return _growing(evaluate(value, next(p.q for p in reversed(points) if p.value <= value)))

    values, counts = parameter.range.values, [_growing(point) for point in points]
    changes = thresholds(count, values, counts)
    return ModelPath(model, native.nq, unit, tuple(points), changes, intervals(values, counts, changes))


def _growing(point: PathPoint) -> int | None:
    return None if point.eigenvalues is None else point.eigenvalues.growing


def _with_start(scene: AnyScene) -> tuple[Model, NativeScene]:
    """The model of a scene and its compiled code. Raises the errors for redundant joints."""
    code, files = generated(scene)
    native = load_scene(files, FLAGS)
    refuse_dependent(scene, native)
    return code, native


def _compiled(
    parameter: StudiedParameter, model: LadderModel
) -> tuple[Callable[[float, Vector | None], PathPoint], NativeScene, str]:
    """The function that evaluates a model at a value of the parameter, its compiled code, and the parameter's unit."""

    def scene_at(value: float) -> AnyScene:
        bare: Any = replace(parameter.scene_at(value), plots=())  # a rigid body has no deflection to plot
        result: AnyScene = in_pieces(model_scene(bare, model))
        return result

    first = scene_at(parameter.range.low)
    code, native = with_redundant_joints(first, _with_start)
    missing = parameter.symbol is not None and parameter.symbol not in native.parameters
    if missing and first != scene_at(parameter.range.high):
        text = "this model has numbers in place of the parameter, on which its code depends"
        raise SpecError((Problem(parameter.range.name, text),))
    units = {p.name: p.unit for p in code.parameters} | units_of_initial_values(first, native)

    def evaluate(value: float, guess: Vector | None) -> PathPoint:
        try:
            scene = scene_at(value)
            k = native.setup({parameter.symbol: value} if parameter.symbol in native.parameters else None)
            steady = steady_motion_of(scene, native, k, guess)
            linear = linearise(native, k, 0.0, steady.q, steady.v, steady.axes)
        except NoSteadyMotion as error:
            return PathPoint(value, None, failure=error.reason, advice=error.advice)
        except TisserandError as error:
            return PathPoint(value, None, failure=first_line(error))
        spins = fast_spin_notes(scene, native, k, steady.q[None], steady.v[None], beams=False)
        return PathPoint(value, eigenvalues(linear.A, steady.spin), steady.q, spins=spins)

    return evaluate, native, units.get(parameter.symbol or parameter.range.name, "")
