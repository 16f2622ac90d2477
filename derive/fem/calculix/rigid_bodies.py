"""*RIGID BODY of CalculiX: the reference node and its rotations as four nodes around it, which move as a rigid body.

The matrices hold the displacements of the reference node and, at the rotational node, its rotation vector. Nodes of a
body have displacements alone, so that four corners of a tetrahedron take the place of both. Their mass matrix has the
moments of the mass of the set, which the matrices contain; their stiffness is that of the set, and a large one against
any deformation of these nodes, which changes frequencies by about 1e-6 of each.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.sparse import block_diag, coo_array, csr_array, identity, kron

from derive.errors import Problem
from derive.fem.keyword_mesh import KeywordMesh, RigidNodes
from derive.fem.model import Array, Indices
from derive.fem.with_nodes import MatricesOfNodes

CORNERS = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) / 3**0.5

STIFF = 1e3
"""The stiffness against deformation of the four nodes, relative to the largest of the matrix; more costs digits."""


def without_rotations(
    mesh: KeywordMesh, matrices: MatricesOfNodes, problems: list[Problem]
) -> tuple[KeywordMesh, MatricesOfNodes]:
    """The mesh and the matrices of a part whose rigid bodies are four nodes each; `problems` takes faults of these."""
    unnamed = iter(np.setdiff1d(matrices.node, mesh.numbers).tolist())
    for body in mesh.rigid_bodies:
        rotation = body.rotation or next(unnamed, 0)
        members = mesh.sets.get(body.name, np.zeros(0, np.int64))
        rows = [np.flatnonzero(matrices.node == node) for node in (body.reference, rotation)]
        if any(len(of) != 3 for of in rows) or len(members) < 3:
            text = "the matrices do not hold three displacements and three rotations of its reference node"
            problems.append(
                Problem("*RIGID BODY", f"{text}; name a set of nodes and no supports, and run ccx again", body.line)
            )
            return mesh, matrices
        mesh, matrices = _four_nodes(
            mesh, matrices, body, members, [of[np.argsort(matrices.direction[of])] for of in rows]
        )
    return mesh, matrices


def _four_nodes(
    mesh: KeywordMesh, matrices: MatricesOfNodes, body: RigidNodes, members: Indices, rows: list[Indices]
) -> tuple[KeywordMesh, MatricesOfNodes]:
    """The mesh and the matrices with four nodes in place of the rows of a reference node and its rotations."""
    at = mesh.positions[mesh.numbers == body.reference][0]
    own = mesh.positions[np.isin(mesh.numbers, members)]
    levers = CORNERS * float(np.abs(own - own.mean(axis=0)).max())
    others = np.setdiff1d(np.arange(len(matrices.node)), np.concatenate(rows))
    # the rows as functions of the new ones: displacements are means, rotations the best fit, which is exact here
    inertia = sum((r @ r) * np.eye(3) - np.outer(r, r) for r in levers)
    fit = np.concatenate([np.linalg.solve(inertia, np.cross(r, np.eye(3)).T) for r in levers], axis=1)
    motion = np.concatenate([np.tile(np.eye(3) / 4, 4), fit])
    order = np.concatenate([others, *rows])
    transform = csr_array(block_diag([identity(len(others)), motion]))
    stiffness = transform.T @ matrices.stiffness[order][:, order] @ transform
    rigid = np.linalg.pinv(motion) @ motion
    guard = STIFF * float(np.abs(matrices.stiffness.diagonal()).max()) * (np.eye(12) - (rigid + rigid.T) / 2)
    stiffness = csr_array(stiffness + block_diag([csr_array((len(others), len(others))), guard]))
    numbers = mesh.numbers.max() + 1 + np.arange(4)
    result = MatricesOfNodes(
        np.concatenate([matrices.node[others], np.repeat(numbers, 3)]),
        np.concatenate([matrices.direction[others], np.tile(np.arange(3), 4)]),
        stiffness,
        _mass(matrices, others, rows, levers),
    )
    changed = replace(
        mesh,
        numbers=np.concatenate([mesh.numbers, numbers]),
        positions=np.concatenate([mesh.positions, at + levers]),
        sets={**mesh.sets, body.name: numbers},
    )
    return changed, result


def _mass(matrices: MatricesOfNodes, others: Indices, rows: list[Indices], levers: Array) -> csr_array:
    """The mass with the four nodes: u . (mu u_R + theta x s) of each other node, and the moments of the set itself."""
    mass = matrices.mass
    translation, rotation = rows
    fields = np.linalg.inv(np.concatenate([np.ones((4, 1)), levers], axis=1))
    first = mass[others][:, translation].toarray()
    turned = mass[others][:, rotation].toarray()
    nodes, place = np.unique(matrices.node[others], return_inverse=True)
    along = matrices.direction[others]
    moments = np.zeros((len(nodes), 4))  # mu and s of each node
    np.add.at(moments[:, 0], place, first[np.arange(len(others)), along] / 3)
    for a, b, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):  # the row of u_a has s_k at theta_b, and -s_b at theta_k
        np.add.at(moments[:, 1 + k], place[along == a], turned[along == a, b] / 2)
        np.add.at(moments[:, 1 + b], place[along == a], -turned[along == a, k] / 2)
    coupling = coo_array(moments @ fields)
    of_set = np.zeros((4, 4))
    of_set[0, 0] = np.trace(mass[translation][:, translation].toarray()) / 3
    mixed = mass[translation][:, rotation].toarray()
    second = mass[rotation][:, rotation].toarray()
    for a, b, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        of_set[0, 1 + k] = of_set[1 + k, 0] = (mixed[a, b] - mixed[b, a]) / 2
    of_set[1:, 1:] = np.trace(second) / 2 * np.eye(3) - second
    corner = kron(csr_array(fields.T @ of_set @ fields), identity(3)).tocsr()
    last = {(int(node), int(d)): i for i, (node, d) in enumerate(zip(place, along, strict=True))}
    entries = [
        (last[int(i), d], len(others) + 3 * int(k) + d, value)
        for i, k, value in zip(coupling.row, coupling.col, coupling.data, strict=True)
        for d in range(3)
        if (int(i), d) in last and value
    ]
    size = len(others) + 12
    row, column, value = (np.array(part) for part in zip(*entries, strict=True)) if entries else (np.zeros(0, int),) * 3
    side = coo_array((value, (row, column)), shape=(size, size))
    whole = block_diag([mass[others][:, others], corner])
    return csr_array(whole + side + side.T)
