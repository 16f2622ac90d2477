"""Bodies for the tests of the reduction: clouds of masses, and boxes whose sums can be done by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.sparse import csr_array, diags_array

from derive.spec.model.body import BodyFrame, Damping, NodalBody
from derive.spec.model.node_data import NodeData
from derive.spec.model.node_markers import NodeMarker

MEAN, GIVEN = BodyFrame("mean"), BodyFrame("given")


def nodal(data: NodeData, frame: BodyFrame = MEAN, **changes) -> NodalBody:
    body = NodalBody("test", data, None, frame, True, Damping(), None, (NodeMarker("first", 0),), "auto")
    return replace(body, **changes)


def lumped(masses: np.ndarray, x: np.ndarray, modes: np.ndarray, k: np.ndarray) -> NodeData:
    return NodeData(x, csr_array(diags_array(masses)), None, modes, k, "")


def cloud(n: int, points: int = 10) -> NodeData:
    rng = np.random.default_rng(n)
    root = rng.uniform(-1, 1, (n, n))
    masses, x = rng.uniform(0.1, 2, points), rng.uniform(-1, 1, (points, 3))
    return lumped(masses, x, rng.uniform(-1, 1, (n, points, 3)), root @ root.T * 50)


def consistent(data: NodeData, seed: int = 1) -> NodeData:
    """The body with the same nodes and a full mass matrix."""
    n = len(data.positions)
    root = np.random.default_rng(seed).uniform(-1, 1, (n, n)) / (2 * np.sqrt(n)) + np.eye(n)
    return replace(data, mass=csr_array(root @ root.T))


def truss(counts=(4, 3, 2), sides=(1.0, 0.5, 0.3), seed: int | None = None) -> NodeData:
    """A box of masses joined by springs to all near neighbours: a free body with three planes of symmetry."""
    axes = [np.linspace(-s / 2, s / 2, c) for s, c in zip(sides, counts, strict=True)]
    x = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    masses = np.ones(len(x))
    if seed is not None:
        rng = np.random.default_rng(seed)
        x, masses = x + rng.uniform(-0.03, 0.03, x.shape), rng.uniform(0.5, 1.5, len(x))
    return replace(lumped(masses, x, np.zeros((0, len(x), 3)), np.zeros((0, 0))), **springs(x, counts))


def springs(x: np.ndarray, counts: tuple[int, ...]) -> dict:
    grid = np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1).reshape(-1, 3)
    k = np.zeros((3 * len(x), 3 * len(x)))
    for a in range(len(x)):
        for b in range(a):
            if np.abs(grid[a] - grid[b]).max() == 1:
                join(k, x, a, b)
    return {"stiffness": csr_array(k), "modes": None, "modal_stiffness": None}


def join(k: np.ndarray, x: np.ndarray, a: int, b: int) -> None:
    """Add a spring between two nodes."""
    arm = x[a] - x[b]
    block = np.outer(arm, arm) / (arm @ arm) * 1e4
    at, to = slice(3 * a, 3 * a + 3), slice(3 * b, 3 * b + 3)
    k[at, at] += block
    k[to, to] += block
    k[at, to] -= block
    k[to, at] -= block


def hinge() -> NodeData:
    """Two boxes of masses and springs that share the nodes of one edge: free to fold about it."""
    data = truss((3, 2, 2), (1.0, 0.5, 0.3), seed=5)
    x = data.positions.copy()
    edge = [i for i in range(len(x)) if i % 4 in (0, 1) and 4 <= i < 8]  # x1 in the middle, x2 least
    x[edge] = [[0, -0.25, -0.15], [0, -0.25, 0.15]]
    counts = (3, 2, 2)
    grid = np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1).reshape(-1, 3)
    left = [i for i in range(len(x)) if grid[i, 0] == 0 or i in edge]
    right = [i for i in range(len(x)) if grid[i, 0] == 2 or i in edge]
    keep = sorted({*left, *right})
    k = np.zeros((3 * len(x), 3 * len(x)))
    for part in (left, right):
        for a in part:
            for b in part:
                if b < a:
                    join(k, x, a, b)
    rows = (3 * np.array(keep)[:, None] + np.arange(3)).ravel()
    nothing = np.zeros((0, len(keep), 3))
    free = lumped(np.ones(len(keep)), x[keep], nothing, np.zeros((0, 0)))
    return replace(free, stiffness=csr_array(k[np.ix_(rows, rows)]), modes=None, modal_stiffness=None)
