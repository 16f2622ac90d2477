"""Initial deflections and twists of beams in space: the amplitudes, and the frames of pieces against the straight beam.

What a curve moves and turns without bending it, moves and turns the frame of a piece: it is displaced along the axes of
the straight beam, and turned by the vector of the mean twist and the slopes, (theta, -w', v').
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from derive.mechanics.bodies.deflection_projection import Projection, projection
from derive.mechanics.bodies.reference_conditions import CONSTANT, LINE
from derive.mechanics.bodies.section_fields import Direction, section_shapes
from derive.mechanics.symbols import amplitude_of
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.configurations import rotation_matrix, skew, turned
from derive.simulation.errors import ExcessiveDeformation
from derive.simulation.initial.deflection_remainders import remainder_line
from derive.simulation.initial.initial_state import MAX_DEFLECTION
from derive.simulation.observables.beams import function_values
from derive.simulation.observables.motion import si_value
from derive.simulation.space.poses import SpatialPoses
from derive.spec.model.beam_parts import Polynomial
from derive.spec.model.beam_pieces import piece_name, whole_beam
from derive.spec.model.spatial_beam import SpatialBeam, SpatialBody
from derive.spec.model.spatial_scene import SpatialScene

Pose = tuple[Vector, Matrix]
"""The position (3,), m, and the rotation tensor (3, 3) of a frame."""
PLACES = {Direction.ALONG_E2: (1, 2, 1.0), Direction.ALONG_E3: (2, 1, -1.0)}
"""Of each deflection: the axis along which it goes, and the axis and the sign of the rotation by its slope, from 0."""
OF_DEFLECTIONS = tuple(PLACES)
ALONG = np.linspace(-1, 1, 21)
"""The points at which a deflection is compared with the length."""


@dataclass(frozen=True)
class InitialCurve:
    """A polynomial of the initial values of a beam, and the nearest that its shapes have.

    key, rate: its key, and whether this is one of a rate; first: the number of its first amplitude, from 0; unit: of
    the amplitudes in that of the curve: half the length of a piece for torsion, m, else 1.
    """

    key: str
    rate: bool
    direction: Direction
    nearest: Projection
    first: int
    unit: float

    @property
    def angular(self) -> bool:
        """Whether it is an angle, not a length."""
        return self.direction is Direction.TORSION

    def amplitudes(self, piece: int) -> list[tuple[int, float]]:
        """The numbers, from 0, of the amplitudes of a piece and their values, m or m/s."""
        values = self.nearest.parts[piece].amplitudes
        return [(self.first + i, float(value) * self.unit) for i, value in enumerate(values)]


def initial_curves(beam: SpatialBeam, rigid: bool = False) -> tuple[InitialCurve, ...]:
    """The curves that the initial values of a whole beam give; rigid: as a beam without shapes has them."""
    shapes, start = () if rigid else section_shapes(beam), beam.start
    half, result = _half_length(beam), []

    def add(key: str, direction: Direction, curve: Polynomial | None) -> None:
        own = [(n, shape.of) for n, shape in enumerate(shapes) if shape.direction is direction]
        of_twist = direction is Direction.TORSION
        nearest = projection(curve or (), tuple(of for _, of in own), beam.pieces, CONSTANT if of_twist else LINE)
        first, unit = own[0][0] if own else 0, half if of_twist else 1.0
        result.append(InitialCurve(key, key.endswith("_rate"), direction, nearest, first, unit))

    for key, pair in (("deflection", start.deflection), ("deflection_rate", start.deflection_rate)):
        for direction, curve in zip(OF_DEFLECTIONS, pair or (), strict=False):
            add(key, direction, curve)
    for key, twist in (("twist", start.twist), ("twist_rate", start.twist_rate)):
        if twist is not None:
            add(key, Direction.TORSION, twist)
    return tuple(result)


def initial_remainders(scene: SpatialScene) -> tuple[str, ...]:
    """A line on each initial curve that is approximated by the nearest one that the shapes of its beam have."""
    beams = (body for body in scene.bodies if isinstance(body, SpatialBeam))
    wholes = {whole_beam(beam).name: whole_beam(beam) for beam in beams}
    return tuple(line for beam in wholes.values() for line in remainders_of(beam))


def remainders_of(beam: SpatialBeam, rigid: bool = False) -> Iterator[str]:
    """The lines on a beam; rigid: as a rigid body."""
    what = "the rigid motion" if rigid else "the shapes"
    for curve in initial_curves(beam, rigid):
        part = "" if curve.angular else f" along e{PLACES[curve.direction][0] + 1}"
        if curve.nearest.remainder:
            yield remainder_line(beam.name, curve.key, curve.nearest.remainder, what, part)


def initial_amplitudes(body: SpatialBody) -> Iterator[tuple[int, float]]:
    """The numbers, from 0, of amplitudes that curves give a body, or a piece of a beam, and their values, m."""
    if not isinstance(body, SpatialBeam):
        return
    number = body.piece_of.number if body.piece_of else 0
    for curve in initial_curves(whole_beam(body)):
        if not curve.rate:
            yield from curve.amplitudes(number)


def check_deflections(scene: SpatialScene, native: NativeScene, q: Vector) -> None:
    """Raise ExcessiveDeformation if a configuration (nq,) bends a beam too far."""
    largest: dict[str, float] = {}
    for beam in (body for body in scene.bodies if isinstance(body, SpatialBeam)):
        whole = whole_beam(beam)
        bent = np.zeros((2, len(ALONG)))
        for i, shape in enumerate(section_shapes(beam), 1):
            if shape.direction in PLACES:
                amplitude = q[native.coordinates.index(amplitude_of(beam.name, i).shown)]
                bent[OF_DEFLECTIONS.index(shape.direction)] += amplitude * function_values(shape.of, ALONG)
        value = float(np.abs(bent).max()) / (2 * _half_length(whole))
        largest[whole.name] = max(value, largest.get(whole.name, 0.0))
    if excessive := {name: value for name, value in largest.items() if value > MAX_DEFLECTION}:
        raise ExcessiveDeformation(excessive)


# ---- frames ----

SMALL = 1e-4
"""rad: below, the series of the rotation is cut."""


@dataclass(frozen=True, eq=False)
class BentBody:
    """A body, or a piece of a beam, whose body frame lies beside that of the undeformed body or of the straight beam.

    displacement (3,), m, along the axes of the straight beam, and rotation (3,), rad, a vector, are those of the body
    frame against it; velocity (3,), m/s, and turning (3,), rad/s, are their rates. All are zero without initial curves.
    """

    name: str
    displacement: Vector
    rotation: Vector
    velocity: Vector
    turning: Vector

    @cached_property
    def _turn(self) -> Matrix:
        if not self.rotation.any():
            return np.eye(3)
        return rotation_matrix(turned(np.array([1.0, 0.0, 0.0, 0.0]), self.rotation))

    @cached_property
    def _spin(self) -> Vector:
        """The angular velocity (3,) of the body frame against the straight beam, along its own axes."""
        angle, cross = float(np.linalg.norm(self.rotation)), skew(self.rotation)
        # (1 - cos x)/x^2 and (x - sin x)/x^3, which lose digits next to zero
        first, second = 0.5, 1 / 6
        if angle > SMALL:
            first, second = (1 - np.cos(angle)) / angle**2, (angle - np.sin(angle)) / angle**3
        return np.asarray(self.turning - first * cross @ self.turning + second * cross @ cross @ self.turning)

    def body_frame(self, straight: Pose) -> Pose:
        """The pose of the body frame for that of the straight beam."""
        position, S = straight
        return position + S @ self.displacement, S @ self._turn

    def frame_twist(self, axes: Matrix, velocity: Vector, angular_velocity: Vector) -> tuple[Vector, Vector]:
        """The velocity (3,) and the angular velocity (3,) of the body frame for those of the straight beam.

        axes (3, 3): the rotation tensor of the straight beam.
        """
        moved = np.cross(angular_velocity, self.displacement) + self.velocity
        return velocity + axes @ moved, self._turn.T @ angular_velocity + self._spin

    def position(self, poses: SpatialPoses) -> Vector:
        """The position (3,) of the straight beam."""
        return np.asarray(poses.position(self.name) - self.axes(poses) @ self.displacement)

    def axes(self, poses: SpatialPoses) -> Matrix:
        """The rotation tensor (3, 3) of the straight beam."""
        return np.asarray(poses.rotation(self.name) @ self._turn.T)

    def twist(self, poses: SpatialPoses) -> tuple[Matrix, Vector]:
        """The twist of the straight beam by unit velocities (6, nv), and at rest (6,), as `SpatialPoses.twist`."""
        of_frame, drift = poses.twist(self.name)
        S, lever = self.axes(poses), skew(self.displacement)
        turns, drifting = self._turn @ of_frame[3:], self._turn @ (drift[3:] - self._spin)
        moves = of_frame[:3] + S @ lever @ turns
        return np.vstack([moves, turns]), np.concatenate([drift[:3] + S @ (lever @ drifting - self.velocity), drifting])


def bent_bodies(body: SpatialBody, rigid: bool = False) -> tuple[BentBody, ...]:
    """A body, or all pieces of the beam that it is a piece of, with the initial curves of that, see there."""
    if not isinstance(body, SpatialBeam):
        return (BentBody(body.name, *np.zeros((4, 3))),)
    whole = whole_beam(body)
    curves, half, result = initial_curves(whole, rigid), _half_length(whole), []
    for k in range(whole.pieces):
        placed = np.zeros((2, 2, 3))  # of the rates or not: displacement and rotation
        for curve in curves:
            part, rate = curve.nearest.parts[k], int(curve.rate)
            if curve.angular:
                placed[rate, 1, 0] += float(part.offset)
                continue
            along, about, sign = PLACES[curve.direction]
            placed[rate, 0, along] += float(part.offset)
            placed[rate, 1, about] += sign * float(part.slope) / half
        (moved, rotated), (velocity, turning) = placed
        result.append(BentBody(piece_name(whole.name, whole.pieces, k), moved, rotated, velocity, turning))
    return tuple(result)


def _half_length(beam: SpatialBeam) -> float:
    """Half the length of a piece of a whole beam, m."""
    return si_value(beam.length) / beam.pieces / 2
