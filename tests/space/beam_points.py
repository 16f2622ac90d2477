"""Beams in space as material points: sections with seven points each, of which some have negative masses.

A section with the axis at (s, v, w) is first turned about its axis e1 by the angle theta and then to the tangent of the
axis, by the least rotation that does so; each factor is a series up to second order. Parallel transport along the bent
axis adds the angle 1/2 int (v' w'' - v'' w') dx. Second derivatives by amplitudes are differences of this quadratic
function.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from decimal import Decimal
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np
from beam_shapes import BeamShapes, beam_shapes, gauss_points, integral
from decimal_vectors import ONE, ZERO, Array, array, cross, identity, number, zeros
from mass_points import MarkerFrame, PointBody
from nodal_points import NodalFields, damping_matrix
from written_scene import Numbers, Table, rotation

E1 = array([1, 0, 0])
DERIVATIVES = {"v1": ("v", 1), "v2": ("v", 2), "w1": ("w", 1), "w2": ("w", 2), "theta": ("theta", 0), "u1": ("u", 1)}
"""The quantities of a section that follow from its axis: functions with the order of their derivatives by x."""


@dataclass(frozen=True, eq=False)
class BeamKinematics:
    """The displacements of the sections of a beam of some length by amplitudes."""

    shapes: BeamShapes
    length: Decimal

    @cached_property
    def n(self) -> int:
        """The number of amplitudes."""
        return len(self.shapes.numbered)

    def sums(self, amplitudes: Mapping[int, Decimal], xi: Decimal) -> dict[str, Decimal]:
        """The derivatives of the axis and the angle of the section at xi."""
        result = dict.fromkeys(DERIVATIVES, ZERO)
        for i, a in amplitudes.items():
            direction, shape = self.shapes.numbered[i]
            for name, (of, order) in DERIVATIVES.items():
                if of == direction:
                    unit = (2 / self.length) ** (1 if of == "theta" else order)
                    result[name] += a * unit * shape(xi, order)
        return result

    def displacement(self, i: int, xi: Decimal) -> Array:
        """The displacement of the axis by amplitude i."""
        direction, shape = self.shapes.numbered[i]
        result = zeros(3)
        if direction != "theta":
            result["uvw".index(direction)] = shape(xi, 0)
        return result

    def turn(self, i: int, xi: Decimal) -> Array:
        """The rotation vector of the section at xi by amplitude i."""
        of = self.sums({i: ONE}, xi)
        return of["theta"] * E1 + tilt(of)

    def primitive(self, rate: Callable[[dict[str, Decimal]], Decimal], amplitudes: Mapping[int, Decimal]) -> Any:
        """The integral by x of a function of the section, as a function of xi, with the condition of the frame."""
        nodes, frame = self.shapes.nodes, self.shapes.frame

        def whole(xi: Decimal) -> Decimal:
            return self.length / 2 * integral(lambda x: rate(self.sums(amplitudes, x)), xi, nodes)

        if frame["kind"] == "mean":
            constant = integral(whole, ONE, nodes) / 2
        elif frame["kind"] == "chord":
            constant = whole(ONE) / 2
        else:
            constant = whole(number(frame.get("at", 0)))
        return lambda xi: whole(xi) - constant

    def quadratic(self, amplitudes: Mapping[int, Decimal]) -> Quadratic:
        """The second-order part of the motion of sections with some amplitudes."""
        short = self.primitive(lambda of: -(of["v1"] ** 2 + of["w1"] ** 2) / 2, amplitudes)
        twist = self.primitive(lambda of: (of["v1"] * of["w2"] - of["v2"] * of["w1"]) / 2, amplitudes)
        return Quadratic(self, amplitudes, short, twist)

    def second(self, of: Callable[[Quadratic], Array]) -> Array:
        """The second derivatives (N, N, ...) of a quadratic function by amplitudes."""
        alone = [of(self.quadratic({i: ONE})) for i in range(self.n)]
        result: dict[tuple[int, int], Array] = {(i, i): 2 * x for i, x in enumerate(alone)}
        for i, j in product(range(self.n), repeat=2):
            if i < j:
                result[i, j] = result[j, i] = of(self.quadratic({i: ONE, j: ONE})) - alone[i] - alone[j]
        rows = [[result[i, j] for j in range(self.n)] for i in range(self.n)]
        return np.array(rows, dtype=object)


def tilt(of: Mapping[str, Decimal]) -> Array:
    """The rotation vector to first order that turns e1 to the tangent."""
    return np.array([ZERO, -of["w1"], of["v1"]], dtype=object)


@dataclass(frozen=True, eq=False)
class Quadratic:
    """The parts of second order for some amplitudes: displacements of points, and rotation vectors."""

    beam: BeamKinematics
    amplitudes: Mapping[int, Decimal]
    short: Callable[[Decimal], Decimal]
    twist: Callable[[Decimal], Decimal]

    def _axial(self, of: Mapping[str, Decimal], xi: Decimal) -> Array:
        """The rotation vector by parallel transport, and by the tangent that stretching turns back."""
        return self.twist(xi) * E1 - of["u1"] * tilt(of)

    def point(self, xi: Decimal, p: Array) -> Array:
        """The displacement of a point of the section: the least rotation to the tangent times that about e1."""
        of = self.beam.sums(self.amplitudes, xi)
        n, theta = tilt(of), of["theta"]
        turned = cross(n, cross(n, p)) / 2 + theta * theta * cross(E1, cross(E1, p)) / 2
        turned = turned + theta * cross(n, cross(E1, p))
        return self.short(xi) * E1 + turned + cross(self._axial(of, xi), p)

    def turn(self, xi: Decimal) -> Array:
        """The rotation vector of the section: of the product of two rotations it is half of the vector product."""
        of = self.beam.sums(self.amplitudes, xi)
        return of["theta"] * cross(tilt(of), E1) / 2 + self._axial(of, xi)


# ---- bodies


def beam_body(name: str, table: Table, value: Numbers) -> PointBody:
    """The beam of a scene, whose frame is at its middle."""
    beam = BeamKinematics(beam_shapes(table), value(table["length"]))
    mass, inertia = value(table["mass"]), value(table["rotary_inertia"])
    places, weights = [], []
    for xi, w in gauss_points(beam.shapes.nodes):
        for p, share in section_points(mass, inertia, value.vector(table.get("centre", (0, 0)))):
            places.append((xi, p))
            weights.append(w * share / 2)
    for carried in table.get("masses", {}).values():
        for p, share in mass_points(carried, value):
            places.append((number(carried["at"]), p))
            weights.append(share)
    at = [xi * beam.length / 2 * E1 + p for xi, p in places]
    turns = {(i, xi): beam.turn(i, xi) for i in range(beam.n) for xi in {xi for xi, _ in places}}
    fields = [[beam.displacement(i, xi) + cross(turns[i, xi], p) for xi, p in places] for i in range(beam.n)]
    order = int(table.get("order", 1))
    psi = beam.second(lambda of: np.array([of.point(xi, p) for xi, p in places], dtype=object)) if order == 2 else None
    K, cubic, preload = elasticity(beam, table, value)
    return PointBody(
        name,
        np.diag(weights),
        np.array(at, dtype=object),
        np.array(fields, dtype=object),
        K,
        damping(beam, table, value, K),
        {marker: beam_marker(of, beam, order) for marker, of in {**table.get("markers", {}), **loaded(beam)}.items()},
        psi,
        cubic if order == 2 else None,
        preload,
    )


def loaded(beam: BeamKinematics) -> dict[str, Decimal]:
    """The positions at which distributed loads are evaluated, by the names of their points."""
    return {f"point {i}": xi for i, (xi, _) in enumerate(gauss_points(beam.shapes.nodes))}


def mass_points(table: Table, value: Numbers) -> list[tuple[Array, Decimal]]:
    """Points p and masses that have the mass, the centre and the tensor of inertia of a body on a section."""
    mass, centre = value(table["mass"]), value.vector(table.get("centre", (0, 0, 0)))
    xx, yy, zz, xy, xz, yz = value.vector(table.get("inertia", (0,) * 6))
    half = (xx + yy + zz) / 2
    second = {(0, 0): half - xx, (1, 1): half - yy, (2, 2): half - zz, (0, 1): -xy, (0, 2): -xz, (1, 2): -yz}
    e, result = identity(3), [(centre, mass)]
    for (i, j), moment in second.items():  # pairs of points at distance 1, and what they add to the mass at the centre
        for first in (ONE, -ONE):
            for sign in (ONE, -ONE) if i != j else (ONE,):
                offset = first * (e[i] + sign * e[j]) if i != j else first * e[i]
                share = sign * moment / 4 if i != j else moment / 2
                result += [(centre + offset, share), (centre, -share)]
    return result


def section_points(mass: Decimal, inertia: Decimal, centre: Array) -> list[tuple[Array, Decimal]]:
    """Points p and masses with a mass, its centre, and a moment of inertia about e1 alone."""
    e = np.array([ZERO, *centre], dtype=object)
    d = (inertia / mass).sqrt()
    own = inertia / (4 * d * d)
    result = [(e, mass - 2 * own)]
    for k, weight in enumerate((-own, own, own)):
        result += [(e + sign * d * identity(3)[k], weight) for sign in (ONE, -ONE)]
    return result


def elasticity(beam: BeamKinematics, table: Table, value: Numbers) -> tuple[Array, Array, Array]:
    """K (N, N); c (N, N, N) of the energy sum c_ijk a_i a_j a_k; the forces (N,) of an axial force at rest.

    They are parts of 1/2 int {EI_3 (v'' + theta w'')^2 + EI_2 (-w'' + theta v'')^2 + GJ theta'^2 + EA u'^2} + N u' dx.
    """
    n, axial = beam.n, table.get("axial", {})
    about_e3 = value(table["bending_stiffness"])
    about_e2 = value(table.get("lateral", {}).get("bending_stiffness", table["bending_stiffness"]))
    torsion = value(table.get("torsion", {}).get("stiffness", 0))
    stiffness = {"v": about_e3, "w": about_e2, "theta": torsion, "u": value(axial.get("stiffness", 0))}
    orders = {"v": 2, "w": 2, "theta": 1, "u": 1}
    K, cubic, preload = zeros(n, n), zeros(n, n, n), zeros(n)
    numbered, force = beam.shapes.numbered, value(axial.get("preload", 0))
    for xi, w in gauss_points(beam.shapes.nodes):
        dx = w * beam.length / 2
        strain = [s(xi, orders[d]) * (2 / beam.length) ** (2 if d != "u" else 1) for d, s in numbered]
        angle = [s(xi, 0) * 2 / beam.length if d == "theta" else ZERO for d, s in numbered]
        for i, (d, _) in enumerate(numbered):
            preload[i] += force * dx * strain[i] if d == "u" else ZERO
            for j, (other, _) in enumerate(numbered):
                K[i, j] += stiffness[d] * dx * strain[i] * strain[j] if d == other else ZERO
                if (d, other) == ("v", "w"):
                    for k in range(n):
                        cubic[i, j, k] += (about_e3 - about_e2) * dx * strain[i] * strain[j] * angle[k]
    return K, cubic, preload


def damping(beam: BeamKinematics, table: Table, value: Numbers, K: Array) -> Array:
    """B, that of nodes on the axis which have the mass of the beam; of torsion, of nodes with 4 J/l^2 in its place."""
    numbered, result = beam.shapes.numbered, zeros(beam.n, beam.n)
    nodes = gauss_points(beam.shapes.nodes)
    x = np.array([xi * beam.length / 2 * E1 for xi, _ in nodes], dtype=object)
    about = 4 * value(table["rotary_inertia"]) / beam.length**2
    for mass, directions in ((value(table["mass"]), "vwu"), (about, ("theta",))):
        own = [i for i, (d, _) in enumerate(numbered) if d in directions]
        if not own:
            continue
        fields = []
        for d, shape in (numbered[i] for i in own):
            axis = identity(3)[0 if d == "theta" else "uvw".index(d)]
            fields.append([shape(xi, 0) * axis for xi, _ in nodes])
        masses = np.diag([mass * w / 2 for _, w in nodes])
        of = NodalFields(x, masses, np.array(fields, dtype=object), K[np.ix_(own, own)])
        result[np.ix_(own, own)] = damping_matrix(table, value, of)
    return result


def beam_marker(of: Any, beam: BeamKinematics, order: int) -> MarkerFrame:
    """A marker: a point of the axis with a frame that turns with the section."""
    place, turned = (of["at"], of.get("rotation")) if isinstance(of, Mapping) else (of, None)
    xi = number(place)
    second = order == 2
    return MarkerFrame(
        xi * beam.length / 2 * E1,
        rotation(turned),
        np.array([beam.displacement(i, xi) for i in range(beam.n)], dtype=object),
        np.array([beam.turn(i, xi) for i in range(beam.n)], dtype=object),
        beam.second(lambda of: of.short(xi) * E1) if second else None,
        beam.second(lambda of: of.turn(xi)) if second else None,
    )
