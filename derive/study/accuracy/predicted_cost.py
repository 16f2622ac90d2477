"""What a model of a scene will cost, before it is derived: the steps of explicit methods are bound by stability.

The steps of stiff models have the length at which the fastest vibration is stable. It is that of a piece of a beam: the
joints of a mechanism add constraints, which lower it. The evaluations of a run are proportional to it, and the
operations of an evaluation to the number of coordinates, about; both factors are those of the runs so far.
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
from derive.spec.model.body import AssumedDeflection
from derive.spec.model.scene import BeamBody, Scene
from derive.study.accuracy.measurement import Line
from derive.study.accuracy.models import LadderModel, Shapes, modelled

PER_RADIAN = 2.3
"""Evaluations of the adaptive method per radian of the fastest vibration, in stiff models."""
PER_COORDINATE = 100.0
"""Operations of an evaluation, with its part of factorisations and projections, per coordinate of the bodies."""
HELD = 0.4
"""The operations over those that follow so from a free beam, before any are measured: joints slow vibrations down."""
RIGID = 3
"""The coordinates of a rigid body."""
POINTS = 24
"""Those of the quadrature of products of shape functions."""


def fastest_rate(scene: Scene, model: LadderModel) -> float:
    """The fastest vibration of the beams of a scene that are modelled so, or the fastest decay, rad/s; 0 if rigid."""
    return max((beam_rate(body, model.of(body.name)) for body in beam_bodies(scene)), default=0.0)


def beam_rate(body: BeamBody, model: LadderModel) -> float:
    """That of a free piece of a beam, and with damping in proportion to the stiffness of its decay."""
    if model.shapes is Shapes.RIGID:
        return 0.0
    beam = modelled(body, model)
    assert isinstance(beam, BeamBody)
    mass, length = (si_value(q) / model.pieces for q in (beam.beam.mass, beam.beam.length))
    stiffness, damping = si_value(beam.beam.bending_stiffness), beam.beam.damping
    frequency = _dimensionless(beam.beam.deflection) * float(np.sqrt(stiffness / (mass * length**3)))
    return max(frequency, frequency**2 * (si_value(damping.stiffness) if damping else 0.0))


def beam_coordinates(model: LadderModel) -> int:
    """The coordinates of a beam that is modelled so, without joints."""
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
    """Operations of a run of a model, and the seconds until it is measured, from those of the models so far."""

    def __init__(self, scene: Scene) -> None:
        assert scene.simulation is not None
        self._scene, self._duration = scene, scene.simulation.duration
        self._ratios: list[float] = []
        self._least: float = 0.0

    def add(self, line: Line) -> None:
        """Learn from the runs of a model."""
        if not line.points:
            return
        measured = min(point.operations for point in line.points)
        stiff = self._stiff(fastest_rate(self._scene, line.model), self.coordinates(line.model))
        if stiff > measured / 10:
            self._ratios.append(measured / stiff)
        each = min(point.evaluations for point in line.points)
        self._least = min(self._least, each) if self._least else each

    def operations(self, model: LadderModel) -> float:
        """Operations of a run, about."""
        return self.operations_of(fastest_rate(self._scene, model), self.coordinates(model))

    def operations_of(self, rate: float, coordinates: int) -> float:
        """Operations of a run with so many coordinates and a fastest vibration or decay of that rate (rad/s), about."""
        stiff = self._stiff(rate, coordinates) * (median(self._ratios) if self._ratios else HELD)
        return max(stiff, self._least * PER_COORDINATE * coordinates)

    def _stiff(self, rate: float, coordinates: int) -> float:
        """Operations of a run whose steps the fastest vibration bounds."""
        return PER_RADIAN * rate * self._duration * PER_COORDINATE * coordinates

    def coordinates(self, model: LadderModel) -> int:
        """The coordinates of all bodies, without joints."""
        beams = beam_bodies(self._scene)
        own = [beam_coordinates(model.of(beam.name)) for beam in beams]
        return sum(own) + RIGID * (len(self._scene.bodies) - len(beams))
