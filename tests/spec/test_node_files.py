"""The numbers of a body of nodes that are wrong."""

import numpy as np
import pytest
from bodies import (
    CONSISTENT,
    LUMPED,
    LUMPED_BODY,
    MODAL,
    MODES,
    POSITIONS,
    STIFFNESS,
    N,
    entries,
    without,
)
from scipy.sparse import csr_array

from derive.errors import SpecError
from derive.spec.construction.bodies import nodal_body
from derive.spec.files import node_files

START = "body.nodes"


def faults(nodes, **keywords):
    """The messages on the nodes, without the name of their key."""
    with pytest.raises(SpecError) as caught:
        nodal_body("b", nodes, **{"units": "SI", "modes": 1} | keywords)
    return [f"{problem.path}: {problem.message}".removeprefix(START) for problem in caught.value.problems]


def kron(m):
    return np.kron(m, np.eye(3))


def changed(array, index, value):
    array = array.copy()
    array[index] = value
    return array


MASS_FITS = "and that of `positions` (4, 3): (4,), (12,), (4, 4) or (12, 12) is needed"
ROTARY = changed(kron(CONSISTENT), ([0, 1], [1, 0]), 0.5)
UNEVEN = changed(kron(CONSISTENT), ([4, 7], [7, 4]), 0.75)


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        (
            {"positions": POSITIONS.T},
            ".positions: the shape is (3, 4), and (nodes, 3) is needed; transpose it",
        ),
        ({"positions": POSITIONS.ravel()}, ".positions: the shape is (12,), and (nodes, 3) is needed"),
        ({"positions": POSITIONS[:0]}, ".positions: the shape is (0, 3), and (nodes, 3) is needed"),
        (
            {"positions": changed(POSITIONS, (1, 2), np.nan)},
            ".positions: numbers that are NaN, infinite or beyond 1e+100: 1 of 12, the first at [1, 2]",
        ),
        ({"mass": LUMPED[:3]}, f".mass: the shape is (3,), {MASS_FITS}"),
        ({"mass": CONSISTENT[:3]}, f".mass: the shape is (3, 4), {MASS_FITS}"),
        ({"mass": np.ones((2, 2, 3))}, f".mass: the shape is (2, 2, 3), {MASS_FITS}"),
        ({"mass": np.array(3.0)}, f".mass: the shape is (), {MASS_FITS}"),
        (
            {"mass": np.array([1, -np.inf, np.nan, 1e101])},
            ".mass: numbers that are NaN, infinite or beyond 1e+100: 3 of 4, the first at [1]",
        ),
        (
            {"mass": csr_array(changed(CONSISTENT, (2, 1), np.inf))},
            ".mass: numbers that are NaN, infinite or beyond 1e+100: 1 of 10, the first at [2, 1]",
        ),
        (
            {"mass": np.array([1.0, -2, 3, -4])},
            ".mass: 2 of 4 nodes have a negative mass, the first of them node 1 with -2",
        ),
        (
            {"mass": changed(CONSISTENT, (3, 3), -0.5)},
            ".mass: 1 of 4 nodes have a negative mass, the first of them node 3 with -0.5",
        ),
        ({"mass": np.zeros(N)}, ".mass: the masses add up to 0; a body needs a positive mass"),
        (
            {"mass": np.diag([1.0, 1, 1, 1]) - 0.75 * np.eye(N)[::-1] - 0.75 * np.eye(N)[[1, 0, 3, 2]]},
            ".mass: the masses add up to -2; a body needs a positive mass",
        ),
        (
            {"mass": changed(np.repeat(LUMPED, 3), 4, 7)},
            ".mass: node 1 has the masses 2, 7, 2 in x, y and z; a node has one mass, the same in all directions",
        ),
        (
            {"mass": changed(CONSISTENT, (1, 2), 0.51)},
            ".mass: the matrix is not symmetric: the entries (1, 2) and (2, 1) differ by 2.0e-03 of the largest entry; "
            "a symmetric matrix is needed",
        ),
        (
            {"mass": np.tril(CONSISTENT)},
            ".mass: the matrix is not symmetric: the entries (0, 1) and (1, 0) differ by 2.0e-01 of the largest entry; "
            "only one triangle is filled: fill both, or write `symmetric` in the first line of a MatrixMarket file",
        ),
        (
            {"mass": ROTARY},
            ".mass: the entry (0, 1) couples two directions; a mass matrix of nodes couples x with x, y with y and z "
            "with z, all alike: leave out rotational inertia",
        ),
        (
            {"mass": UNEVEN + changed(np.zeros((12, 12)), (1, 1), 1e-15)},
            ".mass: of nodes 1 and 2, the mass in y is not that in x; a node has one mass, the same in all directions",
        ),
        (
            {"stiffness": STIFFNESS[:4, :4]},
            ".stiffness: the shape is (4, 4), and that of `positions` (4, 3): (12, 12) is needed",
        ),
        (
            {"stiffness": changed(STIFFNESS, (2, 5), 99)},
            ".stiffness: the matrix is not symmetric: the entries (2, 5) and (5, 2) differ by 1.0e+00 of the largest "
            "entry; a symmetric matrix is needed",
        ),
        (
            {"stiffness": STIFFNESS * (1 + 1e-9 * np.tril(np.ones((12, 12)), -1))},
            ".stiffness: the matrix is not symmetric: the entries (3, 11) and (11, 3) differ by 9.4e-10 of the largest "
            "entry; a symmetric matrix is needed",
        ),
        (
            {"modes": MODES.reshape(2, -1)},
            ".modes: the shape is (2, 12), and that of `positions` (4, 3): (modes, 4, 3) or (12, modes) is needed; "
            "transpose it",
        ),
        (
            {"modes": MODES[:, :3]},
            ".modes: the shape is (2, 3, 3), and that of `positions` (4, 3): (modes, 4, 3) or (12, modes) is needed",
        ),
        (
            {"modes": MODES[:0]},
            ".modes: the shape is (0, 4, 3), and that of `positions` (4, 3): (modes, 4, 3) or (12, modes) is needed",
        ),
        (
            {"modes": MODES, "modal_stiffness": np.ones((3, 3))},
            ".modal_stiffness: the shape is (3, 3), and there are 2 modes: (2, 2) or (2,) is needed",
        ),
        (
            {"modes": MODES, "modal_stiffness": changed(MODAL, (0, 1), 2)},
            ".modal_stiffness: the matrix is not symmetric: the entries (0, 1) and (1, 0) differ by 1.4e-01 of the "
            "largest entry; a symmetric matrix is needed",
        ),
        (
            {"modal_stiffness": MODAL},
            ".modal_stiffness: there are no modes that this could belong to; add them as `modes`",
        ),
        ({"modes": MODES + 1j}, ".modes: this holds complex numbers; real numbers are needed"),
        ({"mass": np.array(["1"] * 4)}, ".mass: this holds text; real numbers are needed"),
        ({"mass": LUMPED > 1}, ".mass: this holds true and false; real numbers are needed"),
        ({"mass": np.array([1, None])}, ".mass: this holds Python objects; real numbers are needed"),
        ({"mass": np.zeros(4, dtype=[("a", "f8")])}, ".mass: this holds no numbers; real numbers are needed"),
        ({"mass": ["1"] * 4}, ".mass: this holds text; real numbers are needed"),
        ({"mass": [[1, 2], [3]]}, '.mass: a file in quotation marks is needed, such as "mass.mtx", not a list'),
        ({"mass_row": "a.mtx"}, '.mass_row: unknown key; did you mean "mass"?'),
        ({3: "a.mtx"}, f".3: unknown key; the keys here are {', '.join(node_files.FILES)}"),
    ],
)
def test_a_fault_of_an_array(arrays, message):
    assert faults(LUMPED_BODY | arrays) == [message]


def test_both_shapes_and_all_arrays_are_looked_at_at_once():
    found = faults({"positions": POSITIONS, "mass": LUMPED[:2], "stiffness": MODAL, "modes": MODES[:, :1]})
    assert [line.split(": ")[0] for line in found] == [".mass", ".stiffness", ".modes"]


@pytest.mark.parametrize(
    ("key", "where"),
    [("positions", "positions of the nodes"), ("mass", "the mass of each node, or the consistent mass matrix")],
)
def test_positions_and_mass_are_needed(key, where):
    (line,) = faults(without(LUMPED_BODY, key))
    assert line.startswith(f".{key}: this is missing: {where}")


SPARSE = entries("mass", CONSISTENT)
SPARSE_K = entries("stiffness", STIFFNESS)


@pytest.mark.parametrize(
    ("arrays", "messages"),
    [
        (
            without(SPARSE, "mass_col"),
            [".mass_col: this is missing; a sparse matrix is mass_row, mass_col, mass_value"],
        ),
        (
            SPARSE | {"mass": LUMPED},
            [
                ".mass: this is there twice, as an array and as mass_row, mass_col, mass_value; keep one of them",
            ],
        ),
        (
            SPARSE | {"mass_value": np.ones(3)},
            [
                ".mass_row: mass_row, mass_col, mass_value have the shapes (10,), (10,), (3,); one shape (entries,) is "
                "needed"
            ],
        ),
        (
            SPARSE | {"mass_row": SPARSE["mass_row"].astype(float)},
            [".mass_row: these are decimals; whole numbers are needed, from 0: save them as integers"],
        ),
        (
            SPARSE | {"mass_row": SPARSE["mass_row"] + 1, "mass_col": SPARSE["mass_col"] + 1},
            [
                ".mass: the entries are in rows and columns 1 to 4, and those of 4 nodes are 0 to 11; these seem to be "
                "numbered from 1"
            ],
        ),
        (
            SPARSE | {"mass_col": SPARSE["mass_col"] - 1},
            [".mass: the entries are in rows and columns -1 to 3, and those of 4 nodes are 0 to 11"],
        ),
        (
            SPARSE | {"mass_col": SPARSE["mass_col"].astype(np.uint64) + np.uint64(2**63)},
            [
                f".mass: the entries are in rows and columns {-(2**63)} to 3, and those of 4 nodes are 0 to 11",
            ],
        ),
        (
            SPARSE | {"mass_value": changed(SPARSE["mass_value"], 2, np.nan)},
            [".mass_value: numbers that are NaN, infinite or beyond 1e+100: 1 of 10, the first at [2]"],
        ),
        (
            {key: array[:0] for key, array in SPARSE.items()},
            [".mass: the masses add up to 0; a body needs a positive mass"],
        ),
    ],
)
def test_a_fault_of_the_entries_of_a_mass(arrays, messages):
    assert faults(without(LUMPED_BODY, "mass") | arrays) == messages


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        (
            SPARSE_K | {"stiffness_row": SPARSE_K["stiffness_row"] + 1, "stiffness_col": SPARSE_K["stiffness_col"] + 1},
            "the entries are in rows and columns 1 to 12, and those of 4 nodes are 0 to 11; these seem to be numbered "
            "from 1",
        ),
        (
            SPARSE_K | {"stiffness_row": SPARSE_K["stiffness_row"] * 3},
            "the entries are in rows and columns 0 to 33, and those of 4 nodes are 0 to 11",
        ),
    ],
)
def test_a_fault_of_the_entries_of_a_stiffness(arrays, message):
    assert faults(without(LUMPED_BODY, "stiffness") | arrays) == [f".stiffness: {message}"]
