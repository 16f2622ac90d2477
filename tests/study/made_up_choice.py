"""Searches of `tisserand choose` with errors that are made up: scenes, runs and trials."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import pytest

from derive.simulation.observables.plots import PlotCurve
from derive.simulation.validity.monitors import Monitor
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.scene import Scene
from derive.spec.model.specification import AnyScene
from derive.spec.toml.read import parse
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.accuracy.measurement import CompiledLadderModel, Curves, Line, Point
from derive.study.accuracy.modelled_bodies import flexible_members
from derive.study.accuracy.predicted_cost import PredictedCost
from derive.study.choice import trials
from derive.study.choice.beam_shares import BeamShare
from derive.study.choice.model_runs import ModelRuns
from derive.study.choice.reference_errors import Agreement, TrustedReference
from derive.study.choice.trials import Trials
from derive.study.choice.trusted_reference import COARSE, FINE, trusted_references

RIGID = LadderModel(Shapes.RIGID)
TRUNCATED, FULL, FIRST = DisplacementOrder.TRUNCATED, DisplacementOrder.FULL, DisplacementOrder.FIRST_ORDER


def sines(count: int, order: DisplacementOrder = TRUNCATED) -> LadderModel:
    return LadderModel(Shapes.SINES, count, order, "chord")


def clamped(count: int) -> LadderModel:
    return LadderModel(Shapes.CLAMPED_FREE, count, TRUNCATED, "tangent")


def polynomials(count: int, pieces: int = 1, order: DisplacementOrder = TRUNCATED) -> LadderModel:
    return LadderModel(Shapes.POLYNOMIALS, count, order, "mean", pieces)


BASE = polynomials(4)


def chain(beams: int) -> Scene:
    """A chain of beams between pins."""
    lines = ["ground.markers = { pin = [0, 0] }"]
    for n in range(beams):
        before = "ground.pin" if n == 0 else f"b{n - 1}.right"
        lines += [
            f"[bodies.b{n}]\nmass = 1\nlength = 1\nbending_stiffness = {10 + n}",
            "markers = { left = -1, middle = 0, right = 1 }",
            f"start = {{ position = [{n + 0.5}, 0], angle = 0 }}",
            f'[joints.j{n}]\nkind = "revolute"\nbetween = ["{before}", "b{n}.left"]',
        ]
    lines.append("[simulation]\nduration = 1\noutput = 0.01")
    lines.append('[plots.it]\ndeflection = "b0.middle"\nchord = ["b0.left", "b0.right"]')
    scene = parse('name = "chain"\n' + "\n".join(lines))
    assert isinstance(scene, Scene)
    return scene


Errors = Callable[[LadderModel, float], dict[str, float]]
"""The errors of a model in a run with a tolerance, which each beam adds independently, by its name."""


class MadeUpRuns(ModelRuns):
    """Runs whose curves have errors that are made up; asked: the models that were run, once each."""

    def __init__(
        self, scene: AnyScene, errors: Errors, seconds: Callable[[LadderModel], float] = lambda _: 0.1
    ) -> None:
        super().__init__(scene, scene.plots, lambda _: None)
        self.names = [body.name for body in flexible_members(scene)]
        self.errors, self._time = errors, seconds
        self.asked: list[LadderModel] = []

    def compiled(self, model: LadderModel, monitored: bool = True) -> CompiledLadderModel:
        if model not in self.asked:
            self.asked.append(model)
        return model  # type: ignore[return-value]

    def curves(self, model: LadderModel, tolerance: float, monitored: bool = False) -> Curves:
        self.compiled(model, monitored)
        self._seconds[model] = self._time(model)
        errors = self.errors(model, tolerance)
        y = np.array([1.0, *(errors[name] for name in self.names)])
        y[1:] *= np.sqrt(len(y))  # rms
        self._curves[model, tolerance] = (PlotCurve("it", y, y, None),)
        return self._curves[model, tolerance]


def converging(model: LadderModel, tolerance: float) -> dict[str, float]:
    """Shapes and beams help, truncation is worst in one beam, and larger steps change most in many beams."""
    shapes = 0.2 * 4.0**-model.count / model.pieces**3
    truncation = 0.004 / model.pieces**2 if model.order is TRUNCATED else 0.0
    steps = 4e-4 * model.pieces if tolerance == COARSE else 0.0
    return {"b0": shapes + truncation + steps}


@dataclass
class MadeUpTrials:
    """Lines of made-up runs: the error of all beams, and the operations that `PredictedCost` predicts for them."""

    runs: MadeUpRuns
    implied: Callable[[LadderModel], Monitor | None] = lambda _: None

    def measured(self, of: LadderModel, *_: object) -> Line:
        rms = float(np.sqrt(sum(e**2 for e in self.runs.errors(of, FINE).values())))
        operations = int(PredictedCost(self.runs.scene).operations(of) * (1.0 if of.order is not FIRST else 0.8)) + 1
        return Line(of, 1, (Point(1e-3, rms, rms, (1e-3,) * 3, 10, operations),), self.implied(of))


def trials_of(
    monkeypatch: pytest.MonkeyPatch, runs: MadeUpRuns, error: float, known: TrustedReference, **how: object
) -> Trials:
    monkeypatch.setattr(trials, "measured", MadeUpTrials(runs, **how).measured)  # type: ignore[arg-type]
    return Trials(runs, known, error)


def reference(runs: ModelRuns, error: float, rigid: Sequence[BeamShare] = ()) -> TrustedReference:
    """The first reference that is good enough."""
    return next(trusted_references(runs, error, lambda _: None, rigid))


def reference_of(*errors: tuple[LadderModel, float], truncation: float = 0.0) -> TrustedReference:
    return TrustedReference((), BASE, (Agreement("fewer beams", 0.001),), errors, truncation)


def decreasing(matter: dict[str, float]) -> Errors:
    """Sines halve the error of a rigid beam with each shape, which is 1e-5 where a beam does not matter."""

    def errors(model: LadderModel, _: float) -> dict[str, float]:
        return {name: _beam_error(model.of(name), matter.get(name, 1e-5)) for name in matter}

    return errors


def _beam_error(model: LadderModel, rigid: float) -> float:
    if model in (BASE, polynomials(3)):
        return 0.0
    wrong = 3.0 if model.order is FIRST else 1.0
    return rigid if model.shapes is Shapes.RIGID else wrong * rigid / (20 * 2**model.count)
