"""Marker frames on finite-element bodies: a node, or the weighted mean motion of a set of nodes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from derive.errors import Problem, SpecError
from derive.mechanics.bodies.modal_body import ModalFrame, ModalPoint
from derive.mechanics.multibody.space.nodal_loads import nodal_resultants
from derive.reduction.arithmetic import Array
from derive.reduction.body import Prepared, prepare, second_order_fields
from derive.reduction.marker_motion import MarkerMotion, equal_motion, marker_motion
from derive.spec.model.spatial_bodies import FlexibleBody, NodeFrame

ON_A_LINE = 1e-8
"""Sets of nodes whose least moment of inertia is below this part of the largest lie on a line."""


RIGID_TOLERANCE = 1e-5
"""The largest deformation of a rigid set of nodes in a mode, relative to the largest displacement of the mode.

Finite-element programs print modes with six or seven digits.
"""


def modal_frames(body: FlexibleBody) -> tuple[ModalFrame, ...]:
    """The markers of a body in its floating frame. Raises SpecError with faults of sets of nodes.

    The mean displacement of a set of nodes is that of its weighted centre. Its rotation fits the displacements of the
    nodes best: it minimises the weighted sum of squares of u_i - u - theta x (X_i - X), as an RBE3 element does, or the
    integral of that square over the faces of elements that have these nodes, see `marker_motion`. Where the set is
    rigid (RBE2), computed modes have that constraint, and a mode of a file that deforms it is an error.
    """
    problems = list(_sets_on_a_line(body))
    if problems:
        raise SpecError(tuple(problems))
    prepared = prepare(body.body)
    problems += _sets_that_deform(body, prepared)
    problems += _nodes_of_first_order(body)
    if problems:
        raise SpecError(tuple(problems))
    mean = _MeanPoints(body, prepared)
    frames = []
    for marker in body.markers:
        motion = marker_motion(body.body, marker, mean.x)
        point = mean(marker.name, _doc(marker, motion), marker.nodes, motion.weights)
        if not marker.has_rotation:
            frames.append(ModalFrame(point, np.zeros_like(point.shapes)))
            continue
        fields, second = mean.phi[:, motion.nodes], None
        if mean.second is not None:
            second = motion.second_rotation(fields, (mean.second[node] for node in motion.nodes))
        frames.append(ModalFrame(point, np.ascontiguousarray(motion.rotation(fields)), second))
    return tuple(frames)


def load_frames(body: FlexibleBody) -> tuple[ModalFrame, ...]:
    """The points at which the resultants of the loads of a body act, once `modal_frames` has checked it."""
    if not body.loads:
        return ()
    mean = _MeanPoints(body, prepare(body.body))
    points = []
    for r in nodal_resultants(body):
        forces = np.array([float(force) for force in r.forces])
        points.append(mean(r.point, f"point of load {r.load.name}", r.nodes, forces / forces.sum()))
    return tuple(ModalFrame(point, np.zeros_like(point.shapes)) for point in points)


class _MeanPoints:
    """Points of a body that move as the weighted means of nodes."""

    def __init__(self, body: FlexibleBody, prepared: Prepared) -> None:
        fields = second_order_fields(body.body, prepared)
        self.x, self.phi = prepared.shapes.x, prepared.shapes.phi
        self.second = None if fields is None else fields.points

    def __call__(self, name: str, doc: str, nodes: tuple[int, ...], weights: Array) -> ModalPoint:
        """The point of some nodes, whose weights sum to 1."""
        own = list(nodes)
        shapes = np.ascontiguousarray(np.einsum("a,nak->nk", weights, self.phi[:, own]))
        second = None
        if self.second is not None:
            second = np.einsum("a,aijk->ijk", weights, np.array([self.second[a] for a in nodes]))
        return ModalPoint(name, doc, weights @ self.x[own], shapes, second)


def _nodes_of_first_order(body: FlexibleBody) -> Iterator[Problem]:
    """Nodes of a body of second order whose displacements of second order are unknown."""
    known = set() if body.body.data.K0F_nodes is None else {int(node) for node in body.body.data.K0F_nodes}
    if not body.body.second_order or body.body.computes_geometric_stiffness:
        return
    own = [(f"markers.{marker.name}", marker.nodes) for marker in body.markers]
    for key, nodes in (*own, *((f"loads.{load.name}", load.nodes) for load in body.loads)):
        missing = [node for node in nodes if node not in known]
        if missing:
            text = f"K0F of node {missing[0]} is missing, and with it the displacement of second order there"
            text += "; add it with the node to K0F and K0F_nodes, or write order = 1"
            yield Problem(f"bodies.{body.name}.{key}", text)


def _sets_on_a_line(body: FlexibleBody) -> Iterator[Problem]:
    positions = np.asarray(body.body.data.positions)
    for marker in body.markers:
        if not marker.has_rotation:
            continue
        values = np.linalg.eigvalsh(marker_motion(body.body, marker, positions).inertia)
        if not values[0] > ON_A_LINE * values[-1]:
            text = "these nodes lie on a line, and a rotation about it moves none; add a node beside it"
            yield Problem(f"bodies.{body.name}.markers.{marker.name}.nodes", text)


def _sets_that_deform(body: FlexibleBody, prepared: Prepared) -> Iterator[Problem]:
    """The rigid sets of nodes that some mode deforms, which are modes of a file, since computed ones do not."""
    x, phi = prepared.raw.x, prepared.raw.phi
    sizes = np.abs(prepared.framed.phi).max(axis=(1, 2), initial=0.0)
    for marker in body.markers:
        if marker.motion != "rigid" or not len(phi):
            continue
        motion, own = equal_motion(marker.nodes, x), phi[:, list(marker.nodes)]
        rigid = motion.displacement(own)[:, None] + np.cross(motion.rotation(own)[:, None], motion.levers[None])
        parts = np.abs(own - rigid).max(axis=(1, 2)) / sizes
        worst = int(np.argmax(parts))
        if parts[worst] > RIGID_TOLERANCE:
            text = (
                f"mode {worst + 1} deforms this rigid set of nodes by {parts[worst]:.2g} of its largest displacement; "
                'write motion = "mean", or give modes of a model in which an RBE2 element connects these nodes, or '
                "the stiffness instead of modes"
            )
            yield Problem(f"bodies.{body.name}.markers.{marker.name}.motion", text)


def _doc(marker: NodeFrame, motion: MarkerMotion) -> str:
    if not marker.has_rotation:
        return f"node {marker.nodes[0]}"
    of = " over the area" if motion.by_area else ""
    return f"{'rigid set' if marker.motion == 'rigid' else f'mean{of}'} of {len(marker.nodes)} nodes"
