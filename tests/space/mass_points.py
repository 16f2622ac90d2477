"""Bodies as material points with masses: a rigid body has six, a flexible one its nodes.

The six points of a rigid body lie on three lines through its centre of mass, in pairs, such that their second moments
are those of the inertia tensor. The nodes of a flexible body move by its modes; their mass matrix may couple them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
from decimal_vectors import ONE, ZERO, Array, array, cholesky, cross, identity, number, rotation_vector_of_set, zeros
from written_scene import Numbers, Table, rotation


@dataclass(frozen=True, eq=False)
class MarkerFrame:
    """A marker in the frame of its body: x + sum shapes alpha, rotated by sum turns alpha and then by `rotation`.

    position (3,); shapes (N, 3); turns (N, 3), None where a marker has no rotation; rotation (3, 3); second (N, N, 3).
    """

    position: Array
    rotation: Array
    shapes: Array
    turns: Array | None
    second: Array | None = None

    def at(self, amplitudes: Array) -> Array:
        """The position of the marker in the frame of its body."""
        return moved(self.position, self.shapes, self.second, amplitudes)


@dataclass(frozen=True, eq=False)
class PointBody:
    """Material points X (P, 3) with modes (N, P, 3), of which `masses` (P, P) is the mass matrix; linear elasticity.

    origin (3,): the point of the body whose inertial position is among its coordinates.
    """

    name: str
    masses: Array
    points: Array
    modes: Array
    stiffness: Array
    damping: Array
    markers: Mapping[str, MarkerFrame]
    second: Array | None = None

    @property
    def n(self) -> int:
        """The number of modes."""
        return len(self.modes)

    def deformed(self, amplitudes: Array) -> Array:
        """X + sum Phi_i alpha_i + 1/2 sum Psi_ij alpha_i alpha_j (P, 3)."""
        return moved(self.points, self.modes, self.second, amplitudes)


def moved(points: Array, modes: Array, second: Array | None, amplitudes: Array) -> Array:
    """Points displaced by modes, and to second order by `second` (N, N, ...), the second derivatives."""
    result = points
    for i, alpha in enumerate(amplitudes):
        result = result + alpha * modes[i]
        for j, beta in enumerate(amplitudes) if second is not None else ():
            result = result + alpha * beta * second[i, j] / 2
    return result


def rigid_points(mass: Decimal, centre: Array, inertia: Array) -> tuple[Array, Array]:
    """Masses (6,) and positions (6, 3) with this mass, centre of mass and inertia tensor (3, 3) about it."""
    moments = (inertia[0, 0] + inertia[1, 1] + inertia[2, 2]) / 2 * identity(3) - inertia  # int r r dm
    arms = cholesky(moments) * (Decimal(3) / mass).sqrt()
    points = [centre + sign * arms[:, k] for k in range(3) for sign in (ONE, -ONE)]
    return np.array([mass / 6] * 6, dtype=object), np.array(points, dtype=object)


def inertia_tensor(six: Array) -> Array:
    """The symmetric tensor of Jxx, Jyy, Jzz, Jxy, Jxz, Jyz."""
    xx, yy, zz, xy, xz, yz = six
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], dtype=object)


def rigid_body(name: str, table: Table, value: Numbers) -> PointBody:
    """A rigid body as the scene has it, its frame at its origin."""
    masses, points = zeros(0), zeros(0, 3)
    if "mass" in table:
        mass = value(table["mass"])
        centre = value.vector(table.get("centre", (0, 0, 0)))
        inertia = inertia_tensor(value.vector(table["inertia"])) if "inertia" in table else zeros(3, 3)
        masses, points = rigid_points(mass, centre, inertia)
    none = zeros(0, len(points), 3)
    markers = {marker: rigid_marker(of, value) for marker, of in table.get("markers", {}).items()}
    return PointBody(
        name, np.diag(masses) if len(masses) else zeros(0, 0), points, none, zeros(0, 0), zeros(0, 0), markers
    )


def rigid_marker(of: Any, value: Numbers) -> MarkerFrame:
    """A marker of a rigid body or of the ground: a position, or a table with a position and a rotation."""
    position, turned = (of["at"], of.get("rotation")) if isinstance(of, Mapping) else (of, None)
    return MarkerFrame(value.vector(position), rotation(turned), zeros(0, 3), zeros(0, 3))


@dataclass(frozen=True, eq=False)
class NodalFields:
    """Nodes X (P, 3), their mass matrix (P, P), modes (N, P, 3) and modal stiffness (N, N), as numbers."""

    x: Array
    mass: Array
    phi: Array
    stiffness: Array
    psi: Array | None = None


def nodal_fields(file: Path) -> NodalFields:
    """The fields of a file whose modes are used as they are."""
    data = np.load(file)
    count = len(data["positions"])
    mass = np.diag(data["mass"]) if "mass" in data else np.zeros((count, count))
    if "mass_row" in data:
        mass[data["mass_row"], data["mass_col"]] = data["mass_value"]
    psi = None
    if "K0F" in data:  # of all nodes, in their order
        psi = array(-np.moveaxis(data["K0F"], (2, 3), (0, 1)))
    return NodalFields(array(data["positions"]), array(mass), array(data["modes"]), array(data["modal_stiffness"]), psi)


def nodal_body(name: str, table: Table, value: Numbers, fields: NodalFields) -> PointBody:
    """A flexible body of a scene, with its nodes in the floating frame."""
    markers = {marker: nodal_marker(of, fields) for marker, of in table.get("markers", {}).items()}
    return PointBody(
        name,
        fields.mass,
        fields.x,
        fields.phi,
        fields.stiffness,
        damping_matrix(table, value, fields),
        markers,
        fields.psi,
    )


def nodal_marker(of: Any, fields: NodalFields) -> MarkerFrame:
    """A marker at a node, or on the weighted mean motion of a set of nodes."""
    table = of if isinstance(of, Mapping) else {"node": of}
    turned = rotation(table.get("rotation"))
    if "node" in table:
        node = int(table["node"])
        return MarkerFrame(
            fields.x[node], turned, fields.phi[:, node], None, None if fields.psi is None else fields.psi[:, :, node]
        )
    nodes = [int(node) for node in table["nodes"]]
    weights = array(table.get("weights", [1] * len(nodes)))
    weights = weights / sum(weights)
    x = fields.x[nodes]
    centre = weights @ x
    shapes = np.array([weights @ phi[nodes] for phi in fields.phi], dtype=object).reshape(-1, 3)
    turns = [rotation_vector_of_set(weights, x - centre, phi[nodes]) for phi in fields.phi]
    second = None if fields.psi is None else np.einsum("a,ijak->ijk", weights, fields.psi[:, :, nodes])
    return MarkerFrame(centre, turned, shapes, np.array(turns, dtype=object).reshape(-1, 3), second)


def damping_matrix(table: Table, value: Numbers, fields: NodalFields) -> Array:
    """B of B alphadot: proportional to stiffness, and to the mass of the modes without their rigid motion."""
    n = len(fields.phi)
    of = table.get("damping", {})
    result = value(of.get("stiffness", 0)) * fields.stiffness if n else zeros(0, 0)
    mass_factor, ratio = value(of.get("mass", 0)), value(of.get("ratio", 0))
    if not n or not (mass_factor or ratio):
        return result
    c8 = deforming_mass(fields)
    result = result + mass_factor * c8
    if ratio:  # a fraction of critical damping of each mode: here the modes have to be uncoupled
        off = [abs(m[i, j]) for m in (c8, fields.stiffness) for i in range(n) for j in range(n) if i != j]
        assert max([*off, ZERO]) < Decimal("1e-9"), "modes are coupled"
        for i in range(n):
            result[i, i] += 2 * ratio * (c8[i, i] * fields.stiffness[i, i]).sqrt()
    return result


def deforming_mass(fields: NodalFields) -> Array:
    """int rho Phi_i . Phi_j of the modes without their rigid motion."""
    axes = identity(3)
    rigid = [np.tile(axis, (len(fields.x), 1)) for axis in axes]
    rigid += [np.array([cross(axis, x) for x in fields.x], dtype=object) for axis in axes]

    def product(a: Array, b: Array) -> Decimal:
        return number(sum((a * (fields.mass @ b)).ravel()))

    basis: list[Array] = []
    for field in rigid:
        rest = field
        for known in basis:
            rest = rest - product(known, rest) * known
        size = product(rest, rest)
        if size > Decimal("1e-30") * product(field, field):
            basis.append(rest / size.sqrt())
    elastic = [phi - sum((product(known, phi) * known for known in basis), ZERO * phi) for phi in fields.phi]
    return np.array([[product(a, b) for b in elastic] for a in elastic], dtype=object)
