"""Beams in motion: their pieces, modal amplitudes, deformed shapes, and the size of their deflection."""

from __future__ import annotations

from fractions import Fraction
from functools import cache

import numpy as np

from derive.mechanics.bodies.beam_functions import BeamFunction
from derive.mechanics.bodies.beam_integrals import BeamField
from derive.mechanics.bodies.displacement_fields import displacement_fields, shortening
from derive.mechanics.bodies.reference_conditions import assumed_shapes
from derive.mechanics.multibody.bodies.beam import piece_name
from derive.mechanics.symbols import amplitude_of
from derive.simulation.observables.motion import Array, SceneMotion, si_value, transformed
from derive.spec.model.beam_parts import AssumedDeflection
from derive.spec.model.beam_pieces import piece_of, place_in_piece
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.specification import AnyScene


def beam_bodies(scene: AnyScene) -> tuple[BeamBody, ...]:
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
    return _shape_functions(beam.beam.deflection)


@cache
def _shape_functions(deflection: AssumedDeflection) -> tuple[BeamFunction, ...]:
    """The shape functions of a deflection, kept, since they are exact and take a hundredth of a second."""
    return assumed_shapes(deflection)


def fields_of(beam: BeamBody) -> tuple[BeamField, ...]:
    """The displacement fields of each piece: its shape functions, then those along the axis if it stretches."""
    return displacement_fields(beam.beam)


def shortening_functions(beam: BeamBody) -> tuple[tuple[int, int, BeamFunction], ...]:
    """Indices i <= j from 0 and a function of xi for each pair of shapes of a beam of second order; else nothing.

    The function, divided by half the length of a piece, is psi_ij: the displacement of each piece along its axis is
    1/2 sum_ij alpha_i alpha_j psi_ij.
    """
    if beam.beam.order is DisplacementOrder.FIRST_ORDER:
        return ()
    fields = list(enumerate(fields_of(beam)))[: len(shape_functions(beam))]
    return tuple((i, j, shortening(a, b, beam.beam.frame)) for i, a in fields for j, b in fields if i <= j)


def amplitudes(motion: SceneMotion, beam: BeamBody, piece: str) -> Array:
    """The modal amplitudes of a piece in bending (n, shapes), m."""
    return field_amplitudes(motion, beam, piece)[:, : len(shape_functions(beam))]


def field_amplitudes(motion: SceneMotion, beam: BeamBody, piece: str) -> Array:
    """All amplitudes of a piece (n, fields), m."""
    names = [amplitude_of(piece, i + 1).shown for i in range(len(fields_of(beam)))]
    values: Array = motion.q[:, [motion.native.coordinates.index(name) for name in names]]
    return values


def deflections(motion: SceneMotion, beam: BeamBody, piece: str, xi: Array) -> Array:
    """The distances of points of a piece from its axis (n, len(xi)), m."""
    values: Array = amplitudes(motion, beam, piece) @ np.array([function_values(f, xi) for f in shape_functions(beam)])
    return values


def function_values(function: BeamFunction, xi: Array) -> Array:
    """The values of a function of xi, of the shape of xi."""
    values = np.zeros_like(xi)
    for term in function.real_terms:
        wave = term.cosine * np.cos(term.frequency * xi) + term.sine * np.sin(term.frequency * xi)
        values += xi**term.power * np.exp(term.growth * xi) * wave
    return values


def axis_points(motion: SceneMotion, beam: BeamBody, piece: str, xi: Array) -> Array:
    """The positions (n, len(xi), 2), m, of points of the deformed axis of a piece, in the inertial frame."""
    alpha = field_amplitudes(motion, beam, piece)
    x = np.zeros((len(alpha), len(xi), 2))
    x[:, :, 0] = xi * half_length(beam)
    for field, a in zip(fields_of(beam), alpha.T, strict=True):
        x[:, :, field.axis - 1] += np.outer(a, function_values(field.of, xi))
    for i, j, psi in shortening_functions(beam):
        product = alpha[:, i] * alpha[:, j] / half_length(beam) / (2 if i == j else 1)
        x[:, :, 0] += np.outer(product, function_values(psi, xi))
    return np.stack([transformed(motion.pose(piece), point) for point in x.swapaxes(0, 1)], axis=1)


def beam_points(motion: SceneMotion, beam: BeamBody) -> list[Array]:
    """The positions (n, 2), m, of the ends and the middle of every piece, in the inertial frame."""
    xi = np.array([-1.0, 0.0, 1.0])
    return [x for piece in piece_names(beam) for x in axis_points(motion, beam, piece, xi).swapaxes(0, 1)]


def relative_deflection(motion: SceneMotion, beam: BeamBody) -> float:
    """The largest deflection of a piece from its axis, divided by the length of the piece."""
    xi = np.linspace(-1, 1, 21)
    largest = max(float(np.abs(deflections(motion, beam, piece, xi)).max()) for piece in piece_names(beam))
    return largest / (2 * half_length(beam))
