"""The nodes of a SID as material points, and the first line of a text that `write` has produced."""

from __future__ import annotations

import re

import numpy as np

from derive.mechanics.bodies.modal_body import ModalPoint
from derive.sid.blocks import Block, SidProblem
from derive.sid.mapping import AGREEMENT, Array, Taylor
from derive.sid.matrices import read_matrix


def read_twists(modal: Block, names: tuple[str, ...], n: int, problems: list[SidProblem]) -> dict[str, Array]:
    """The rotations (N, 3) of the nodes by the modes, rad/m, by the names of the points; zero where there is no psi."""
    result = {}
    for name, node in zip(names, _nodes(modal), strict=True):
        block = node.find("psi")
        value = read_matrix(block, ((3, n),), n, problems) if block is not None else None
        result[name] = np.zeros((n, 3)) if value is None else np.ascontiguousarray(value.m0.T)
    return result


def _nodes(modal: Block) -> list[Block]:
    frame = modal.find("frame")
    return [block for block in frame.blocks if block.name == "node"] if frame else []


def read_points(first: str, modal: Block, n: int, problems: list[SidProblem]) -> tuple[ModalPoint, ...]:
    """The nodes of the body as points, with the names in the first line of the text if they fit.

    `second` of a point is None if phi has no first order.
    """
    nodes = _nodes(modal)
    names = header_names(first, "points")
    if len(names) != len(nodes) or len(set(names)) < len(names):
        names = [f"node_{re.sub(r'[^0-9A-Za-z_]', '_', node.label) or at}" for at, node in enumerate(nodes, 1)]
    points = []
    for name, node in zip(names, nodes, strict=True):
        parts: dict[str, Taylor] = {}
        for key, shape in (("origin", (3, 1)), ("phi", (3, n)), ("AP", (3, 3))):
            block = node.find(key)
            if block is not None and (value := read_matrix(block, (shape,), n, problems)) is not None:
                parts[key] = value
            elif block is None and key != "AP":
                problems.append(SidProblem(node.line, f"node {node.label} has no {key}"))
        if "AP" in parts and np.abs(parts["AP"].m0 - np.eye(3)).max() > AGREEMENT:
            problems.append(
                SidProblem(node.line, f"the frame of node {node.label} is rotated (AP), which is not supported")
            )
        if "origin" in parts and "phi" in parts:
            points.append(_point(name, node, parts["origin"], parts["phi"], problems))
    return tuple(points)


def _point(name: str, node: Block, origin: Taylor, phi: Taylor, problems: list[SidProblem]) -> ModalPoint:
    """A node with its shapes and, from the first order of phi, its second-order displacement."""
    shapes = np.ascontiguousarray(phi.m0.T)
    size = float(np.abs(shapes).max(initial=0.0))
    if origin.m1 is not None and np.abs(origin.m1[:, :, 0].T - shapes).max(initial=0.0) > AGREEMENT * size:
        problems.append(SidProblem(node.line, f"the origin of node {node.label} has another first order than phi"))
    second: Array | None = None
    if phi.m1 is not None:
        second = phi.m1.transpose(2, 1, 0)
        if not symmetric_in_modes(second):
            message = f"the first order of phi of node {node.label}, -K0F, is not symmetric in the modes"
            problems.append(SidProblem(node.line, message))
        second = mean_of_both(second)
    return ModalPoint(name, f"node {node.label}", origin.m0[:, 0].copy(), shapes, second)


def symmetric_in_modes(table: Array) -> bool:
    """Whether a table (N, N, ...) is symmetric in the modes, as far as programs round their output."""
    return bool(np.abs(table - np.swapaxes(table, 0, 1)).max(initial=0.0) <= AGREEMENT * np.abs(table).max(initial=0.0))


def mean_of_both(table: Array) -> Array:
    """The symmetric part in the modes of a table (N, N, ...); a symmetric table is reproduced to the last bit."""
    return np.ascontiguousarray((table + np.swapaxes(table, 0, 1)) / 2) + 0.0


def header_names(first: str, key: str) -> list[str]:
    """The names after `key=` in the first line of a text that `write` has produced; none if it has no such key."""
    match = re.search(rf"\b{key}= *([A-Za-z_]\w*(?: +[A-Za-z_]\w*)*)", first, re.ASCII)
    return match[1].split() if match else []
