"""Marker frames on finite-element bodies: a node, or the weighted mean motion of a set of nodes."""

from __future__ import annotations

import numpy as np

from derive.errors import Problem, SpecError
from derive.mechanics.bodies.modal_body import ModalFrame, ModalPoint
from derive.reduction.arithmetic import Array
from derive.reduction.body import prepare, second_order_fields
from derive.spec.model.spatial_scene import FlexibleBody, NodeFrame

ON_A_LINE = 1e-8
"""Sets of nodes whose least moment of inertia is below this part of the largest lie on a line."""


def modal_frames(body: FlexibleBody) -> tuple[ModalFrame, ...]:
    """The markers of a body in its floating frame. Raises SpecError with sets of nodes that have no rotation.

    The mean displacement of a set of nodes is that of its weighted centre. Its rotation fits the displacements of the
    nodes best: it minimises the weighted sum of squares of u_i - u - theta x (X_i - X), as an RBE3 element does.
    """
    prepared = prepare(body.body)
    fields = second_order_fields(body.body, prepared)
    x, phi = prepared.shapes.x, prepared.shapes.phi
    second = None if fields is None else fields.points
    problems: list[Problem] = []
    frames = []
    for marker in body.markers:
        nodes, weights = np.array(marker.nodes), _weights(marker)
        centre = weights @ x[nodes]
        shapes = np.einsum("a,nak->nk", weights, phi[:, nodes])
        of_second = None if second is None else np.einsum("a,aijk->ijk", weights, np.array([second[a] for a in nodes]))
        twists = np.zeros_like(shapes)
        if marker.has_rotation:
            levers = x[nodes] - centre
            inertia = np.einsum("a,akl->kl", weights, _moments(levers))
            values = np.linalg.eigvalsh(inertia)
            if not values[0] > ON_A_LINE * values[-1]:
                text = "these nodes lie on a line, and a rotation about it moves none; add a node beside it"
                problems.append(Problem(f"bodies.{body.name}.markers.{marker.name}.nodes", text))
                continue
            moments = np.einsum("a,nak->nk", weights, np.cross(levers[None], phi[:, nodes]))
            twists = np.linalg.solve(inertia, moments.T).T
        point = ModalPoint(marker.name, _doc(marker), centre, np.ascontiguousarray(shapes), of_second)
        frames.append(ModalFrame(point, np.ascontiguousarray(twists)))
    if problems:
        raise SpecError(tuple(problems))
    return tuple(frames)


def _weights(marker: NodeFrame) -> Array:
    given = np.array([float(w) for w in marker.weights] or [1.0] * len(marker.nodes))
    return np.asarray(given / given.sum())


def _moments(levers: Array) -> Array:
    """The tensors (r . r) I - r r of some vectors (n, 3)."""
    squares = np.einsum("ak,ak->a", levers, levers)
    return np.asarray(squares[:, None, None] * np.eye(3) - np.einsum("ak,al->akl", levers, levers))


def _doc(marker: NodeFrame) -> str:
    return f"node {marker.nodes[0]}" if len(marker.nodes) == 1 else f"mean of {len(marker.nodes)} nodes"
