"""Finite-element bodies as material points: the nodes of a file, moved by its modes in the frame of a scene's body.

The matrices of a file are read on their own terms: modes lose the rigid motion that a frame excludes by least squares
or by the mass, the geometric stiffness is the work of unit loads on displacements of second order, and these are given
for all nodes, beside the file or as the response to unit forces at the nodes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
from decimal_vectors import (
    ONE,
    ZERO,
    Array,
    array,
    cholesky,
    cross,
    identity,
    number,
    of_quaternion,
    rotation_vector_of_set,
    solved,
    zeros,
)
from mass_points import MarkerFrame, PointBody, moved
from written_scene import Numbers, Table, rotation


@dataclass(frozen=True, eq=False)
class NodalFields:
    """Nodes X (P, 3), their mass matrix (P, P), modes (N, P, 3) and modal stiffness (N, N), as numbers."""

    x: Array
    mass: Array
    phi: Array
    stiffness: Array
    psi: Array | None = None


def nodal_fields(file: Path, table: Table) -> NodalFields:
    """The fields of a file in the frame of a body, whose modes are not made orthonormal."""
    assert table.get("orthonormal") is False or table.get("frame") == "given", "modes of the file are needed"
    data = np.load(file)
    count, modes = len(data["positions"]), int(table.get("modes", len(data["modes"])))
    mass = np.diag(data["mass"]) if "mass" in data else np.zeros((count, count))
    if "mass_row" in data:
        mass[data["mass_row"], data["mass_col"]] = data["mass_value"]
    psi = None
    if "K0F" in data and table.get("order", 2) == 2:  # of all nodes, in their order
        psi = array(-np.moveaxis(data["K0F"], (2, 3), (0, 1)))[:modes, :modes]
    given = (data["positions"], mass, data["modes"][:modes], data["modal_stiffness"][:modes, :modes])
    x, m, phi, stiffness = map(array, given)
    return in_frame(NodalFields(x, m, phi, stiffness, psi), table.get("frame", "mean"))


def in_frame(fields: NodalFields, frame: Any) -> NodalFields:
    """The fields in a frame: `given`, `mean` without momentum of the modes, or `point`, attached to a node."""
    kind, of = (frame["kind"], frame) if isinstance(frame, Mapping) else (frame, {})
    if kind == "given":
        return fields
    assert fields.psi is None, "displacements of second order are in the frame of the file"
    if kind == "mean":
        weights = fields.mass.sum(axis=0)
        x = fields.x - weights @ fields.x / weights.sum()
        basis = rigid_motions(x)
        matrix = np.array([[product(fields.mass, a, b) for b in basis] for a in basis], dtype=object)
        phi = []
        for mode in fields.phi:
            parts = solved(matrix, np.array([product(fields.mass, a, mode) for a in basis], dtype=object))
            phi.append(mode - sum(part * a for part, a in zip(parts, basis, strict=True)))
        return replace(fields, x=x, phi=np.array(phi, dtype=object))
    assert kind == "point", kind
    node, around = int(of["node"]), [int(k) for k in of["around"]]
    x = fields.x - fields.x[node]
    modes = []
    for mode in fields.phi:
        moved = mode - mode[node]
        turned = rotation_vector_of_set(array([1] * len(around)), x[around], moved[around])
        modes.append(np.array([u - cross(turned, r) for u, r in zip(moved, x, strict=True)], dtype=object))
    return replace(fields, x=x, phi=np.array(modes, dtype=object))


def rigid_motions(x: Array) -> list[Array]:
    """The displacements (P, 3) of three translations and of three small rotations of points x (P, 3)."""
    axes = identity(3)
    turns = [np.array([cross(axis, r) for r in x], dtype=object) for axis in axes]
    return [np.tile(axis, (len(x), 1)) for axis in axes] + turns


def product(mass: Array, a: Array, b: Array) -> Decimal:
    """int rho a . b of two fields (P, 3)."""
    return number(sum((a * (mass @ b)).ravel()))


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
    rigid = table.get("motion", "mean") == "rigid"
    of = rotation_of_rigid_set if rigid else lambda r, u: rotation_vector_of_set(weights, r, u)
    turns = [of(x - centre, phi[nodes]) for phi in fields.phi]
    second = second_turns = None
    if fields.psi is not None:
        second = np.einsum("a,ijak->ijk", weights, fields.psi[:, :, nodes])
        second_turns = turns_of_second_order(weights, x - centre, fields.phi[:, nodes], fields.psi[:, :, nodes])
    return MarkerFrame(centre, turned, shapes, np.array(turns, dtype=object).reshape(-1, 3), second, second_turns)


def turns_of_second_order(weights: Array, arms: Array, phi: Array, psi: Array) -> Array:
    """The second derivatives (N, N, 3) of the rotation vector that fits the moved nodes best, by differences.

    weights (P,); arms (P, 3); phi (N, P, 3); psi (N, N, P, 3).
    """
    h, n = Decimal("1e-14"), len(phi)
    result = zeros(n, n, 3)

    def fitted(*modes: int) -> Array:
        """The even part of the rotation vector of equal amplitudes h of some modes."""
        a = np.array([h if i in modes else ZERO for i in range(n)], dtype=object)
        return sum(best_rotation(weights, arms, moved(zeros(*arms.shape), phi, psi, sign * a)) for sign in (1, -1))

    own = [fitted(i) for i in range(n)]
    for i in range(n):
        result[i, i] = own[i] / h**2
        for j in range(i):
            result[i, j] = result[j, i] = (fitted(i, j) - own[i] - own[j]) / (2 * h**2)
    return result


def best_rotation(weights: Array, arms: Array, displacements: Array) -> Array:
    """The vector of the rotation R for which the sum of w |r + u - R r|^2 is least, of small displacements u (P, 3).

    R is that of the quaternion along (1, vector/2).
    """
    theta = zeros(3)
    for _ in range(8):  # each gains the digits by which u is smaller than the arms
        R = of_quaternion(np.array([ONE, *(theta / 2)], dtype=object))
        turned = arms @ R.T
        theta = theta + rotation_vector_of_set(weights, turned, arms + displacements - turned)
    return theta


def rotation_of_rigid_set(arms: Array, displacements: Array) -> Array:
    """The small rotation theta of nodes that move as a rigid body, from three of them: u_j - u_0 = theta x (r_j - r_0).

    arms (P, 3), of which the first three are not on a line; displacements (P, 3).
    """
    a, b = arms[1] - arms[0], arms[2] - arms[0]
    u, w = displacements[1] - displacements[0], displacements[2] - displacements[0]
    normal = cross(a, b)
    # theta along a, b and their normal n: u . n = theta . (a x n) and so on for w, and u . b = theta . n
    matrix = np.array([cross(a, normal), cross(b, normal), normal], dtype=object)
    return solved(matrix, np.array([u @ normal, w @ normal, u @ b], dtype=object))


def damping_matrix(table: Table, value: Numbers, fields: NodalFields) -> Array:
    """B of B alphadot: proportional to stiffness, and to the mass of the modes without their rigid motion.

    A fraction of critical damping is 2 ratio L (L^-1 K L^-T)^(1/2) L^T of this mass L L^T.
    """
    n = len(fields.phi)
    of = table.get("damping", {})
    result = value(of.get("stiffness", 0)) * fields.stiffness if n else zeros(0, 0)
    mass_factor, ratio = value(of.get("mass", 0)), value(of.get("ratio", 0))
    if not n or not (mass_factor or ratio):
        return result
    c8 = deforming_mass(fields)
    if ratio:
        lower = cholesky(c8)
        inverse = solved(lower, identity(n))
        result = result + 2 * ratio * lower @ square_root(inverse @ fields.stiffness @ inverse.T) @ lower.T
    return result + mass_factor * c8


def square_root(matrix: Array) -> Array:
    """The positive definite square root of a positive definite matrix, by the iteration of Denman and Beavers."""
    unit = identity(len(matrix))
    root, inverse = matrix, unit
    for _ in range(40):
        root, inverse = (root + solved(inverse, unit)) / 2, (inverse + solved(root, unit)) / 2
        if max(abs(root @ root - matrix).ravel()) < Decimal("1e-40") * max(abs(matrix).ravel()):
            return root
    raise ArithmeticError("the iteration does not converge")


def deforming_mass(fields: NodalFields) -> Array:
    """int rho Phi_i . Phi_j of the modes without their rigid motion."""
    basis: list[Array] = []
    for field in rigid_motions(fields.x):
        rest = field
        for known in basis:
            rest = rest - product(fields.mass, known, rest) * known
        size = product(fields.mass, rest, rest)
        if size > Decimal("1e-30") * product(fields.mass, field, field):
            basis.append(rest / size.sqrt())
    elastic = [
        phi - sum((product(fields.mass, known, phi) * known for known in basis), ZERO * phi) for phi in fields.phi
    ]
    return np.array([[product(fields.mass, a, b) for b in elastic] for a in elastic], dtype=object)
