"""The predicted cost of a model of a scene, before it is derived: stability limits the steps of explicit methods.

The steps of stiff models have the length at which the fastest vibration is stable. Its frequency is taken from a free
piece of a beam: the joints of a mechanism add constraints, which lower it. The evaluations of a run are proportional to
this frequency, and the operations of an evaluation about to the number of coordinates; both factors are fitted to the
runs so far.
"""

from __future__ import annotations

from functools import cache
from statistics import median

import numpy as np
from scipy.linalg import eigh

from derive.mechanics.bodies.beam_functions import ONE, XI, BeamFunction
from derive.mechanics.bodies.reference_conditions import assumed_shapes
from derive.simulation.observables.beams import beam_bodies, function_values
from derive.simulation.observables.motion import si_value
from derive.spec.model.beam_parts import AssumedDeflection
from derive.spec.model.scene import BeamBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.accuracy.measurement import Line
from derive.study.accuracy.models import model_scene, modelled
from derive.study.accuracy.spatial_models import coordinates
from derive.study.accuracy.spatial_rates import fastest_spatial_rate

PER_RADIAN = 2.3
"""Evaluations of the adaptive method per radian of the fastest vibration, in stiff models."""
PER_COORDINATE = 100.0
"""Operations of an evaluation, with its part of factorisations and projections, per coordinate of the bodies."""
JOINED = 0.4
"""The operations relative to those predicted from a free beam, before any are measured: joints slow vibrations down."""
RIGID = 3
"""The number of coordinates of a rigid body."""
POINTS = 24
"""The number of points of the quadrature of products of shape functions."""


def fastest_rate(scene: AnyScene, model: LadderModel) -> float:
    """The fastest vibration, or decay, of the flexible bodies of a scene with a model, rad/s; 0 if all are rigid."""
    if isinstance(scene, SpatialScene):
        return fastest_spatial_rate(model_scene(scene, model))
    return max((beam_rate(body, model.of(body.name)) for body in beam_bodies(scene)), default=0.0)


def beam_rate(body: BeamBody, model: LadderModel) -> float:
    """The fastest vibration of a free piece of a beam, rad/s, or its decay by damping if that is faster."""
    if model.shapes is Shapes.RIGID:
        return 0.0
    beam = modelled(body, model)
    assert isinstance(beam, BeamBody)
    mass, length = (si_value(q) / model.pieces for q in (beam.beam.mass, beam.beam.length))
    stiffness, damping = si_value(beam.beam.bending_stiffness), beam.beam.damping
    frequency = _dimensionless(beam.beam.deflection) * float(np.sqrt(stiffness / (mass * length**3)))
    return max(frequency, frequency**2 * (si_value(damping.stiffness) if damping else 0.0))


def beam_coordinates(model: LadderModel) -> int:
    """The number of coordinates of a beam with a model, without joints."""
    return max(RIGID, model.size)


@cache
def _dimensionless(deflection: AssumedDeflection) -> float:
    """The highest frequency of a free beam with m = l = EI = 1: its velocities are 1, xi and the shapes."""
    xi, weights = np.polynomial.legendre.leggauss(POINTS)
    fields: tuple[BeamFunction, ...] = (ONE, XI, *assumed_shapes(deflection))
    v, curvature = (np.array([function_values(f.derivative(n), xi) for f in fields]) for n in (0, 2))
    mass, stiffness = (v * weights) @ v.T / 2, 8 * (curvature * weights) @ curvature.T
    return float(np.sqrt(eigh(stiffness, mass, eigvals_only=True)[-1]))


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
        if isinstance(self._scene, SpatialScene):
            return coordinates(self._scene, model)
        beams = beam_bodies(self._scene)
        own = [beam_coordinates(model.of(beam.name)) for beam in beams]
        return sum(own) + RIGID * (len(self._scene.bodies) - len(beams))
