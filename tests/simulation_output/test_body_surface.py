"""The surface of nodes whose finite elements are not known."""

from __future__ import annotations

from collections import Counter
from itertools import product

import numpy as np
import pytest

from derive.simulation.observables.body_surface import Surface, neighbours, surface


def grid(*counts: int) -> np.ndarray:
    """The nodes of a grid with these numbers of nodes along its axes, its cells 1, 2 and 3 m long."""
    return np.array(list(product(*map(range, counts))), dtype=float) * [1, 2, 3]


def euler(shown: Surface) -> int:
    """Nodes - sides + faces: 2 of a ball, 1 of a disc, 0 of a ring."""
    return len(shown.nodes) - len(sides(shown)) + len(shown.faces)


def sides(shown: Surface) -> Counter[tuple[int, ...]]:
    """The sides of faces, with the number of faces that each one has."""
    return Counter(tuple(sorted((face[i - 1], face[i]))) for face in shown.faces for i in range(len(face)))


def test_a_grid_has_the_faces_of_its_cells() -> None:
    shown = surface(grid(6, 4, 3))
    assert len(shown.faces) == 2 * (5 * 3 + 5 * 2 + 3 * 2)
    assert all(len(face) == 4 for face in shown.faces)
    assert len(shown.nodes) == 6 * 4 * 3 - 4 * 2 and euler(shown) == 2


def test_edges_are_those_of_the_cells_of_a_grid() -> None:
    """17 x 5 x 3 nodes have 16 5 3 + 17 4 3 + 17 5 2 edges along their axes, and no diagonals."""
    x = grid(17, 5, 3)
    edges = np.array(neighbours(x))
    assert len(edges) == 16 * 5 * 3 + 17 * 4 * 3 + 17 * 5 * 2
    assert (np.count_nonzero(np.abs(x[edges[:, 0]] - x[edges[:, 1]]) > 1e-9, axis=1) == 1).all()
    assert neighbours(np.zeros((1, 3))) == ()


def test_a_hole_stays_open() -> None:
    x = grid(7, 7, 2) / [1, 2, 3]
    shown = surface(x[np.abs(x[:, :2] - 3).max(axis=1) > 1])
    assert euler(shown) == 0  # a ring


@pytest.mark.parametrize(("counts", "faces"), [((4, 3, 1), 6), ((5, 1, 1), 0), ((1, 1, 1), 0)])
def test_flat_bodies_have_one_side_and_lines_have_none(counts: tuple[int, int, int], faces: int) -> None:
    shown = surface(grid(*counts))
    assert len(shown.faces) == faces
    if faces:
        assert euler(shown) == 1
    else:
        assert len(shown.edges) == counts[0] - 1


def test_nodes_without_order_have_a_closed_surface() -> None:
    """Each edge of the triangles around random nodes in a ball belongs to an even number of them."""
    random = np.random.default_rng(3)
    x = random.normal(size=(200, 3))
    x *= (random.uniform(size=200) ** (1 / 3) / np.linalg.norm(x, axis=1))[:, None]
    count = sides(surface(x))
    assert len(count) > 100 and all(number % 2 == 0 for number in count.values())
