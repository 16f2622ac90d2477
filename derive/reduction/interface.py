"""The interface of a body: the motions of its markers as functions of the displacements, and what is left if held.

The markers have c displacements and rotations, B u. The displacements of a body that is held there are u = Z y with
B Z = 0: as many displacements of nodes of each marker as it has motions follow from the others (multi-point
constraints), so that Z is sparse. Sets that move as rigid bodies have coordinates of their own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from scipy.sparse import csc_array, csr_array, identity

from derive.errors import Problem, SpecError
from derive.reduction.arithmetic import Array
from derive.reduction.eigen import rigid_set_motions
from derive.reduction.frames import rigid_fields
from derive.reduction.marker_motion import fitted_rotations, set_weights
from derive.spec.model.body import NodalBody
from derive.spec.model.node_markers import InterfaceMarker

ON_A_LINE = 1e-4
"""An interface is on a line if a rigid motion of the body moves its markers by less than this part of its size."""

DEPENDENT = 1e-8
"""Motions of markers depend on each other if a pivot of them is below this part of the largest."""

RIGID_MOTIONS = 6


@dataclass(frozen=True, eq=False)
class HeldInterface:
    """The interface of a body, with c motions of markers, of which rotations are multiplied by the size of the body.

    motions (c, displacements): B. rigid (c, 6): the motions of the markers due to the six rigid motions. coordinates
    (displacements, coordinates): T, the displacements that rigid sets leave. held (displacements, coordinates): those
    of the held body, T Z. unit (displacements, c): some displacements with unit motions of the markers, B unit = 1.
    """

    motions: csr_array
    rigid: Array
    coordinates: csr_array
    held: csr_array
    unit: Array


def interface_of(body: NodalBody, x: Array) -> HeldInterface:
    """The interface of a body with nodes at x (nodes, 3). Raises SpecError if its motions do not hold the body."""
    size = float(np.abs(x).max())
    motions = csr_array(np.concatenate([marker_motions(x, marker, size) for marker in body.interface_markers]))
    rigid = motions @ rigid_fields(x / size).reshape(RIGID_MOTIONS, -1).T
    values = np.linalg.svd(rigid, compute_uv=False)
    if len(values) < RIGID_MOTIONS or values[-1] < ON_A_LINE * values[0]:
        raise SpecError((_on_a_line(body),))
    coordinates = rigid_set_motions(x, body.rigid_sets) if body.rigid_sets else csr_array(identity(x.size))
    held, unit = _held_and_unit(body, csc_array(motions @ coordinates))
    return HeldInterface(motions, rigid, coordinates, csr_array(coordinates @ held), np.asarray(coordinates @ unit))


def marker_motions(x: Array, marker: InterfaceMarker, size: float) -> Array:
    """The displacement and, of a set of nodes, the rotation times `size` of a marker, (3 or 6, displacements)."""
    own, count, weights = list(marker.nodes), 3 * len(marker.nodes), set_weights(marker)
    fields = np.eye(count).reshape(count, -1, 3)
    rows = [np.einsum("a,nak->kn", weights, fields)]
    if len(own) > 1:
        rows.append(size * fitted_rotations(weights, x[own] - weights @ x[own], fields).T)
    result = np.zeros((3 * len(rows), *x.shape))
    result[:, own] = np.concatenate(rows).reshape(3 * len(rows), -1, 3)
    return result.reshape(len(result), -1)


def _held_and_unit(body: NodalBody, motions: csc_array) -> tuple[csr_array, Array]:
    """Z (coordinates, others) with motions @ Z = 0, and a matrix U (coordinates, c) with motions @ U = 1.

    The coordinates that follow from the others are the pivots of a QR decomposition, whose inverse is small.
    """
    count, size = motions.shape
    own = np.flatnonzero(np.diff(motions.indptr))
    block = motions[:, own].toarray()
    _, triangle, order = scipy.linalg.qr(block, mode="economic", pivoting=True)
    pivots = np.abs(np.diag(triangle))
    if len(pivots) < count or pivots[-1] <= DEPENDENT * pivots[0]:
        text = "the motions of these markers depend on each other, since they share nodes; name one marker for each set"
        raise SpecError((Problem("body.interface", text),))
    following, leading = np.sort(order[:count]), np.sort(order[count:])
    inverse = np.linalg.inv(block[:, following])
    ties = -inverse @ block[:, leading]
    ties[np.abs(ties) < np.finfo(float).eps * np.abs(ties).max(initial=0.0)] = 0.0  # markers without common nodes
    free = np.setdiff1d(np.arange(size), own[following])
    entries = csr_array(ties).tocoo()
    rows = np.concatenate([free, own[following][entries.row]])
    columns = np.concatenate([np.arange(len(free)), np.searchsorted(free, own[leading])[entries.col]])
    values = np.concatenate([np.ones(len(free)), entries.data])
    unit = np.zeros((size, count))
    unit[own[following]] = inverse
    return csr_array((values, (rows, columns)), shape=(size, len(free))), unit


def _on_a_line(body: NodalBody) -> Problem:
    names = ", ".join(marker.name for marker in body.interface_markers)
    what = "is a single node" if len(body.interface_markers) == 1 else "are nodes on a line"
    text = f"{names} {what}, about which the held body can rotate; add a marker beside it, or make one a set of nodes"
    return Problem("body.interface", text)
