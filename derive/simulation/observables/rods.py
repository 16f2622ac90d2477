"""Rods in motion: their pieces, and how far these bend from their frames."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from derive.mechanics.multibody.components import piece_name, piece_of, place_in_piece
from derive.mechanics.reference_conditions import assumed_shapes
from derive.simulation.observables.observables import Array, Motion, number, placed
from derive.spec.model.body import Polynomial
from derive.spec.model.scene import BeamBody

TRUSTED = 0.1
"""Of the length of a beam: a larger deflection is outside what displacements that are linear in the amplitudes hold."""


def pieces(rod: BeamBody) -> tuple[str, ...]:
    """The names of the beams that a rod is cut into, from its left to its right end."""
    return tuple(piece_name(rod, k) for k in range(rod.pieces))


def piece(rod: BeamBody, at: Fraction) -> tuple[int, float]:
    """The piece in which a point of a rod lies, counted from 0, and its xi there; where two meet, the left one."""
    return piece_of(at, rod.pieces), float(place_in_piece(at, rod.pieces))


def half_length(rod: BeamBody) -> float:
    """Half the length of a piece, m."""
    return number(rod.beam.length) / rod.pieces / 2


def shapes(rod: BeamBody) -> tuple[Polynomial, ...]:
    """The shapes of each piece, in xi."""
    return assumed_shapes(rod.beam.ansatz, rod.beam.frame, rod.beam.orthogonal)


def amplitudes(motion: Motion, rod: BeamBody, name: str) -> Array:
    """(n, shapes): those of a piece, m."""
    columns = [motion.native.coordinates.index(f"{name}_alpha{i + 1}") for i in range(len(shapes(rod)))]
    found: Array = motion.q[:, columns]
    return found


def deflections(motion: Motion, rod: BeamBody, name: str, xi: Array) -> Array:
    """(n, len(xi)): how far points of a piece are from its axis, m."""
    values = [sum(float(c) * xi**n for n, c in enumerate(shape)) for shape in shapes(rod)]
    found: Array = amplitudes(motion, rod, name) @ np.array(values)
    return found


def curve(motion: Motion, rod: BeamBody) -> list[Array]:
    """(n, 2) each: where the ends and the middle of every piece are."""
    xi, found = np.array([-1.0, 0.0, 1.0]), []
    for name in pieces(rod):
        for x, v in zip(xi * half_length(rod), deflections(motion, rod, name, xi).T, strict=True):
            found.append(placed(motion.pose(name), np.stack([np.full_like(v, x), v], axis=1)))
    return found


def bending(motion: Motion, rod: BeamBody) -> float:
    """The largest deflection of a piece from its axis, over the length of the piece."""
    xi = np.linspace(-1, 1, 21)
    most = max(float(np.abs(deflections(motion, rod, name, xi)).max()) for name in pieces(rod))
    return most / (2 * half_length(rod))
