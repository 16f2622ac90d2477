"""The predicted cost of a model of a scene, before it is derived: stability limits the steps of explicit methods.

The steps of stiff models have the length at which the fastest vibration is stable. Its frequency is taken from a free
piece of a beam: the joints of a mechanism add constraints, which lower it. The evaluations of a run are proportional to
this frequency, and the operations of an evaluation about to the number of coordinates; both factors are fitted to the
runs so far.
"""

from __future__ import annotations

from statistics import median

from derive.spec.model.specification import AnyScene
from derive.study.accuracy.free_rates import body_coordinates, fastest_rate, rigid_coordinates
from derive.study.accuracy.ladder_model import LadderModel
from derive.study.accuracy.measurement import Line
from derive.study.accuracy.modelled_bodies import flexible_members

PER_RADIAN = 2.3
"""Evaluations of the adaptive method per radian of the fastest vibration, in stiff models."""
PER_COORDINATE = 100.0
"""Operations of an evaluation, with its part of factorisations and projections, per coordinate of the bodies."""
JOINED = 0.4
"""The operations relative to those predicted from a free beam, before any are measured: joints slow vibrations down."""


class PredictedCost:
    """A prediction of the operations of a run of a model, from those of the models so far."""

    def __init__(self, scene: AnyScene) -> None:
        assert scene.simulation is not None
        self._scene, self._duration = scene, scene.simulation.duration
        self._rates: dict[LadderModel, float] = {}
        self._ratios: list[float] = []
        self._least: float = 0.0

    def add(self, line: Line) -> None:
        """Fit the prediction to the runs of a model as well."""
        if not line.points:
            return
        measured = min(point.operations for point in line.points)
        stiff = self._stiff(self.rate(line.model), self.coordinates(line.model))
        if stiff > measured / 10:
            self._ratios.append(measured / stiff)
        each = min(point.evaluations for point in line.points)
        self._least = min(self._least, each) if self._least else each

    def operations(self, model: LadderModel) -> float:
        """The approximate number of operations of a run of a model."""
        return self.operations_of(self.rate(model), self.coordinates(model))

    def rate(self, model: LadderModel) -> float:
        """The fastest vibration, or decay, of the flexible bodies with a model, rad/s, computed once."""
        if model not in self._rates:
            self._rates[model] = fastest_rate(self._scene, model)
        return self._rates[model]

    def operations_of(self, rate: float, coordinates: int) -> float:
        """The approximate operations of a run; rate: its fastest vibration or decay, rad/s."""
        stiff = self._stiff(rate, coordinates) * (median(self._ratios) if self._ratios else JOINED)
        return max(stiff, self._least * PER_COORDINATE * coordinates)

    def _stiff(self, rate: float, coordinates: int) -> float:
        """Operations of a run whose steps the fastest vibration bounds."""
        return PER_RADIAN * rate * self._duration * PER_COORDINATE * coordinates

    def coordinates(self, model: LadderModel) -> int:
        """The number of coordinates of all bodies, without joints."""
        flexible = flexible_members(self._scene)
        own = [body_coordinates(self._scene, body, model.of(body.name)) for body in flexible]
        return sum(own) + rigid_coordinates(self._scene) * (len(self._scene.bodies) - len(flexible))
