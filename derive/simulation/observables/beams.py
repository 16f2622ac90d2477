"""Beams in motion: their pieces, modal amplitudes, deformed shapes, and the size of their deflection."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from derive.mechanics.bodies.beam_functions import BeamFunction
from derive.mechanics.bodies.beam_integrals import BeamField
from derive.mechanics.bodies.displacement_fields import displacement_fields
from derive.mechanics.bodies.reference_conditions import assumed_shapes
from derive.mechanics.multibody.bodies.beam import piece_name, piece_of, place_in_piece
from derive.mechanics.symbols import amplitude, owned
from derive.simulation.observables.motion import Array, SceneMotion, si_value, transformed
from derive.spec.model.scene import BeamBody, Scene


def beam_bodies(scene: Scene) -> tuple[BeamBody, ...]:
    """The flexible bodies of a scene."""
    return tuple(body for body in scene.bodies if isinstance(body, BeamBody))


def piece_names(beam: BeamBody) -> tuple[str, ...]:
    """The names of the pieces that a beam is cut into, from its left to its right end."""
    return tuple(piece_name(beam, k) for k in range(beam.pieces))


def piece_at(beam: BeamBody, xi: Fraction) -> tuple[int, float]:
    """The index, from 0, of the piece at a point of a beam, and xi in that piece; of two adjacent ones the left one."""
    return piece_of(xi, beam.pieces), float(place_in_piece(xi, beam.pieces))


def half_length(beam: BeamBody) -> float:
    """Half the length of a piece, m."""
    return si_value(beam.beam.length) / beam.pieces / 2


def shape_functions(beam: BeamBody) -> tuple[BeamFunction, ...]:
    """The shape functions of each piece."""
    return assumed_shapes(beam.beam.deflection)


def fields_of(beam: BeamBody) -> tuple[BeamField, ...]:
    """The displacement fields of each piece: its shape functions, then those along the axis if it stretches."""
    return displacement_fields(beam.beam)


def amplitudes(motion: SceneMotion, beam: BeamBody, piece: str) -> Array:
    """(n, shapes): the modal amplitudes of a piece, m."""
    names = [owned(amplitude(i + 1), piece).name for i in range(len(shape_functions(beam)))]
    columns = [motion.native.coordinates.index(name) for name in names]
    values: Array = motion.q[:, columns]
    return values


def deflections(motion: SceneMotion, beam: BeamBody, piece: str, xi: Array) -> Array:
    """(n, len(xi)): the distances of points of a piece from its axis, m."""
    values: Array = amplitudes(motion, beam, piece) @ np.array([function_values(f, xi) for f in shape_functions(beam)])
    return values


def function_values(function: BeamFunction, xi: Array) -> Array:
    """The values of a function of xi, of the shape of xi."""
    values = np.zeros_like(xi)
    for term in function.real_terms:
        wave = term.cosine * np.cos(term.frequency * xi) + term.sine * np.sin(term.frequency * xi)
        values += xi**term.power * np.exp(term.growth * xi) * wave
    return values


def beam_points(motion: SceneMotion, beam: BeamBody) -> list[Array]:
    """(n, 2) each: the positions (m) of the ends and the middle of every piece, in the inertial frame."""
    xi, points = np.array([-1.0, 0.0, 1.0]), []
    for piece in piece_names(beam):
        for x, y in zip(xi * half_length(beam), deflections(motion, beam, piece, xi).T, strict=True):
            points.append(transformed(motion.pose(piece), np.stack([np.full_like(y, x), y], axis=1)))
    return points


def relative_deflection(motion: SceneMotion, beam: BeamBody) -> float:
    """The largest deflection of a piece from its axis, divided by the length of the piece."""
    xi = np.linspace(-1, 1, 21)
    largest = max(float(np.abs(deflections(motion, beam, piece, xi)).max()) for piece in piece_names(beam))
    return largest / (2 * half_length(beam))
