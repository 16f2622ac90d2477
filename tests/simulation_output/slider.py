"""A crank-slider whose motion is given: a stand-in for a compiled scene and its integration, exact and instant."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from derive.mechanics.bodies.reference_conditions import assumed_shapes
from derive.simulation.observables.beams import piece_at, piece_names
from derive.simulation.observables.motion import SceneMotion, si_value
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.beam_parts import Frame, Marker
from derive.spec.model.joints import Drive, Joint
from derive.spec.model.markers import MarkerRef, PointMarker
from derive.spec.model.planar_bodies import BeamBody, RigidBody
from derive.spec.model.plots import Deflection, Plot, ReferenceCurve
from derive.spec.model.scene import Scene
from derive.spec.model.simulation import Simulation

ANSATZ = ((Fraction(1),), (Fraction(0), Fraction(1)), (Fraction(0),) * 2 + (Fraction(1),))
ANSATZ = (*ANSATZ, (Fraction(0),) * 3 + (Fraction(1),))
XI, WEIGHTS = np.polynomial.legendre.leggauss(12)
CRANK, ROD, SPEED, MOST = 0.15, 0.3, 150.0, 0.0045  # m, m, rad/s, m: the largest deflection of the middle


def fraction(value: str) -> Fraction:
    return Fraction(value)


def scene(count: int = 3, name: str = "slider") -> Scene:
    markers = (Marker("left", Fraction(-1)), Marker("middle", Fraction(0)), Marker("right", Fraction(1)))
    beam = PlanarBeam(
        "rod", ANSATZ, Frame("mean"), fraction("0.07"), fraction("0.3"), fraction("12.7"), markers, orthogonal=True
    )
    nothing = fraction("0")
    crank = RigidBody(
        "crank",
        None,
        None,
        (nothing, nothing),
        (PointMarker("hub", nothing, nothing), PointMarker("pin", fraction("0.15"), nothing)),
    )
    mass, inertia = fraction("0.03"), fraction("1e-6")
    slider = RigidBody("slider", mass, inertia, (nothing, nothing), (PointMarker("pin", nothing, nothing),))
    quantity = Deflection(MarkerRef("rod", "middle"), (MarkerRef("rod", "left"), MarkerRef("rod", "right")), 0.3)
    reference = ReferenceCurve("given.csv", "x", "y", tuple((0.1 * i, deflection(0.1 * i) / 0.3) for i in range(100)))
    return Scene(
        name,
        (PointMarker("bearing", nothing, nothing),),
        None,
        (crank, BeamBody("rod", beam, count), slider),
        (
            Joint("crank_bearing", "revolute", MarkerRef("ground", "bearing"), MarkerRef("crank", "hub")),
            Joint("crank_pin", "revolute", MarkerRef("crank", "pin"), MarkerRef("rod", "left")),
            Joint("slider_pin", "revolute", MarkerRef("rod", "right"), MarkerRef("slider", "pin")),
            Joint("guide", "translational", MarkerRef("ground", "bearing"), MarkerRef("slider", "pin")),
        ),
        (Drive("motor", "crank_bearing", None, fraction("150")),),
        simulation=Simulation(0.1, 1e-4),
        plots=(Plot("deflection", quantity, "motor", "rod", (1, 2, 3), reference),),
    )


def deflection(angle: float) -> float:
    """The deflection of the middle of the rod, m."""
    return MOST * np.sin(angle) * (1 + 0.3 * np.cos(3 * angle))


@dataclass
class Double:
    """A substitute for `Native` with a scene whose rod bends as half a sine, as far as its shapes can."""

    scene: Scene

    def __post_init__(self) -> None:
        self.rod = next(b for b in self.scene.bodies if isinstance(b, BeamBody))
        self.shapes = [
            np.polynomial.Polynomial([float(c) for c in s.coefficients])
            for s in assumed_shapes(self.rod.beam.deflection)
        ]
        self.beams = piece_names(self.rod)
        self.bodies = ("crank", *self.beams, "slider")
        names = ("c1", "c2", "phi", *(f"alpha{i + 1}" for i in range(len(self.shapes))))
        self.coordinates = (*(f"{b}_{n}" for b in self.beams for n in names), "slider_s")
        self.multipliers = ("crank_pin_1", "crank_pin_2")
        self.nq = self.nv = len(self.coordinates)
        self.nlambda = len(self.multipliers)
        self.inputs = self.outputs = ()
        self.markers = tuple(f"{self.rod.name}_{marker.name}" for marker in self.rod.markers)

    def state(self, t: float) -> np.ndarray:
        return self.states(np.array([t]))[0]

    def states(self, t: np.ndarray) -> np.ndarray:
        """The coordinates (rows, nq) at the times t (rows,)."""
        angle = SPEED * t
        lean = -np.arcsin(CRANK / ROD * np.sin(angle))
        q, n = [], len(self.beams)
        pin = CRANK * np.array([np.cos(angle), np.sin(angle)])
        along, across = np.array([np.cos(lean), np.sin(lean)]), np.array([-np.sin(lean), np.cos(lean)])
        for i in range(n):
            middle = (2 * i + 1) / n - 1
            v = np.outer(deflection(angle), np.cos(np.pi / 2 * (middle + XI / n)))
            mean, slope = v @ WEIGHTS / 2, 3 * (XI * v) @ WEIGHTS / 2
            rest = v - mean[:, None] - np.outer(slope, XI)
            alphas = [(rest * s(XI)) @ WEIGHTS / (WEIGHTS @ s(XI) ** 2) for s in self.shapes]
            c = pin + (middle + 1) / 2 * ROD * along + mean * across
            q += [*c, lean + slope / (ROD / n / 2), *alphas]
        return np.array([*q, CRANK * np.cos(angle) + ROD * np.cos(lean)]).T

    def inputs_at(self, t: float) -> np.ndarray:
        return np.zeros(0)

    def poses(self, t: float, q: np.ndarray, k: np.ndarray) -> np.ndarray:
        width = 3 + len(self.shapes)
        rods = [q[i * width : i * width + 3] for i in range(len(self.beams))]
        return np.array([[0, 0, SPEED * t], *rods, [q[-1], 0, 0]])

    def marker_positions(self, name: str, q: np.ndarray, v: np.ndarray, k: np.ndarray) -> np.ndarray:
        at = next(m.at for m in self.rod.beam.markers if f"rod_{m.name}" == name)
        index, xi = piece_at(self.rod, at)
        width = 3 + len(self.shapes)
        c1, c2, phi, *alphas = q.T[index * width : (index + 1) * width]
        x, y = (
            xi * si_value(self.rod.beam.length) / len(self.beams) / 2,
            sum(a * s(xi) for a, s in zip(alphas, self.shapes, strict=True)),
        )
        return np.array([c1 + np.cos(phi) * x - np.sin(phi) * y, c2 + np.sin(phi) * x + np.cos(phi) * y]).T


def motion(count: int = 3, instants: int = 1001, name: str = "slider") -> SceneMotion:
    given = scene(count, name)
    native = Double(given)
    t = np.linspace(0, 0.1, instants)
    q = native.states(t)
    return SceneMotion(given, native, np.zeros(0), t, q, np.zeros_like(q))
