"""The inertia of a body with displacements of second order: that of energies up to second order in the deformation.

With amplitudes s alpha and rates s alphadot the kinetic energy of the nodes is a polynomial of degree four in s, and
so are M and h of virtual work. The model keeps the energies up to s^2, from which Lagrange's equations make terms up to
s^2 in rows of rigid motion and up to s in those of amplitudes, since these are derivatives by amplitudes. The
coefficients of the polynomials come from five values of s; at each of them the motion of the nodes is exact.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal
from typing import TYPE_CHECKING

import numpy as np
from decimal_vectors import ONE, STEP, ZERO, Array, array, cross, solved, zeros
from mass_points import PointBody

if TYPE_CHECKING:
    from space_kinematics import Columns, SpaceState

SCALES = array([0, 1, -1, 2, -2])
ORDER = 2


@dataclass(frozen=True, eq=False)
class BodyInertia:
    """M (n, n) and h (n,) of the velocities `rows` of a body, with gravity; its kinetic energy; momenta (6,)."""

    rows: list[int]
    M: Array
    h: Array
    kinetic: Decimal
    momentum: Array


def truncated_inertia(body: PointBody, columns: Columns, state: SpaceState, v: Array, gravity: Array) -> BodyInertia:
    """The inertia of a body that keeps all of its coordinates, in a state."""
    names = {f"{body.name}_alpha{i}" for i in range(1, body.n + 1)}
    rows, modal, i = [], [], 0
    for name, turns in columns.parts:
        count = 3 if turns else 1
        if name in names or name in {f"{body.name}_{x}" for x in ("c1", "c2", "c3", "")}:
            rows += range(i, i + count)
            modal += [int(name in names)] * count
        i += count
    values = [
        _exact(body, columns, _scaled(state, names, s), _scaled_rates(v, rows, modal, s), rows, gravity) for s in SCALES
    ]
    n = len(rows)
    of_amplitudes = np.array(modal)
    degrees = np.concatenate(
        [(ORDER - of_amplitudes[:, None] - of_amplitudes[None]).ravel(), ORDER - of_amplitudes, [ORDER] * 7]
    )
    powers = np.array([[s**k if k else ONE for k in range(len(SCALES))] for s in SCALES], dtype=object)
    coefficients = solved(powers, np.array(values, dtype=object))
    kept = np.array([sum(c[: d + 1], ZERO) for c, d in zip(coefficients.T, degrees, strict=True)], dtype=object)
    M, h, (kinetic, *momentum) = kept[: n * n].reshape(n, n), kept[n * n : n * n + n], kept[n * n + n :]
    return BodyInertia(rows, M, h, kinetic, np.array(momentum, dtype=object))


def _scaled(state: SpaceState, names: set[str], s: Decimal) -> SpaceState:
    """The state with other amplitudes."""
    scalars: Mapping[str, Decimal] = {k: s * x if k in names else x for k, x in state.scalars.items()}
    return type(state)(scalars, state.rotations)


def _scaled_rates(v: Array, rows: list[int], modal: list[int], s: Decimal) -> Array:
    """The velocities of a body alone, with other rates of its amplitudes."""
    result = zeros(len(v))
    for row, of_amplitude in zip(rows, modal, strict=True):
        result[row] = s * v[row] if of_amplitude else v[row]
    return result


def _exact(body: PointBody, columns: Columns, state: SpaceState, v: Array, rows: list[int], gravity: Array) -> Array:
    """M, h, the kinetic energy and the momenta of the nodes in a state, one after the other."""

    def nodes(at: SpaceState) -> Array:
        c = np.array([at.scalars[f"{body.name}_c{k}"] for k in (1, 2, 3)], dtype=object)
        alpha = np.array([at.scalars[f"{body.name}_alpha{i}"] for i in range(1, body.n + 1)], dtype=object)
        return c + body.deformed(alpha) @ at.rotations[f"{body.name}_"].T

    def apart(direction: Array) -> tuple[Array, Array]:
        return nodes(columns.moved(state, direction, STEP)), nodes(columns.moved(state, direction, -STEP))

    x, (ahead, behind) = nodes(state), apart(v)
    velocity, acceleration = (ahead - behind) / (2 * STEP), (ahead - 2 * x + behind) / STEP**2 - gravity
    J = []
    for row in rows:
        unit = zeros(len(v))
        unit[row] = Decimal(1)
        a, b = apart(unit)
        J.append((a - b) / (2 * STEP))
    weighted = [body.masses @ of for of in J]
    M = [(a * b).sum() for a in J for b in weighted]
    h = [(a * acceleration).sum() for a in weighted]
    momenta = body.masses @ velocity
    kinetic = (velocity * momenta).sum() / 2
    angular = sum((cross(r, p) for r, p in zip(x, momenta, strict=True)), zeros(3))
    return np.array([*M, *h, kinetic, *momenta.sum(axis=0), *angular], dtype=object)
