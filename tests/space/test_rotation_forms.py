"""The notations of a rotation: they give the rotation that they say, and refuse what is none."""

from __future__ import annotations

from itertools import pairwise
from math import cos, sin

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

from derive.mechanics.motion.rotations import matrix_of
from derive.simulation.configurations import quaternion_of, rotation_matrix, turned
from derive.spec.tables.rotation import SEQUENCES, Rotation

ADAPTER: TypeAdapter[tuple[float, ...]] = TypeAdapter(Rotation)


def matrix(form: object) -> np.ndarray:
    return rotation_matrix(np.array(ADAPTER.validate_python(form)))


def about(axis: str, angle: float) -> np.ndarray:
    k = "xyz".index(axis)
    i, j = (k + 1) % 3, (k + 2) % 3
    result = np.eye(3)
    result[np.ix_([i, j], [i, j])] = [[cos(angle), -sin(angle)], [sin(angle), cos(angle)]]
    return result


@pytest.mark.parametrize("sequence", SEQUENCES)
def test_angles_are_rotations_about_axes_of_the_turning_frame(sequence: str) -> None:
    angles = (0.4, -1.1, 2.3)
    expected = np.linalg.multi_dot([about(axis, angle) for axis, angle in zip(sequence, angles, strict=True)])
    assert matrix({"angles": list(angles), "sequence": sequence}) == pytest.approx(expected, abs=1e-15)


def test_sequences_do_not_repeat_an_axis_at_once() -> None:
    assert len(SEQUENCES) == 12
    assert all(a != b for sequence in SEQUENCES for a, b in pairwise(sequence))


@pytest.mark.parametrize("pair", ["xy", "yz", "xz"])
def test_two_axes_are_columns_of_the_rotation(pair: str) -> None:
    Q = matrix({"angles": [0.4, -1.1, 2.3], "sequence": "zyx"})
    form = {name: (3 * Q[:, "xyz".index(name)]).tolist() for name in pair}
    assert matrix(form) == pytest.approx(Q, abs=1e-15)


def test_axis_and_angle_turn_about_the_axis() -> None:
    assert matrix({"axis": [0, 0, 2], "angle": 0.3}) == pytest.approx(about("z", 0.3), abs=1e-15)


@pytest.mark.parametrize(
    ("form", "text"),
    [
        ([0, 0, 0, 0], "length 0"),
        ([1, 1, 0, 0], "1.41421"),
        ({"x": [1, 0, 0]}, "two axes"),
        ({"x": [1, 0, 0], "y": [0, 0, 0]}, "no direction"),
        ({"x": [1, 0, 0], "y": [1, 1, 0]}, "at 45 degrees"),
        ({"x": [1, 0, 0], "y": [0, 1, 0], "z": [0, 0, -1]}, "left-handed"),
        ({"angles": [0, 0, 0], "sequence": "xxy"}, "sequence"),
    ],
)
def test_what_is_no_rotation_is_refused(form: object, text: str) -> None:
    with pytest.raises(ValidationError, match=text):
        ADAPTER.validate_python(form)


def test_exact_matrices_are_those_of_the_doubles() -> None:
    p = np.array(ADAPTER.validate_python({"angles": [0.4, -1.1, 2.3], "sequence": "zxz"}))
    assert np.array(matrix_of(p), dtype=float) == pytest.approx(rotation_matrix(p), abs=1e-15)
    quarter = ADAPTER.validate_python({"axis": [1, 0, 0], "angle": np.pi / 2})
    assert matrix_of(quarter).tolist() == [[1, 0, 0], [0, 0, -1], [0, 1, 0]]


def test_quaternions_of_matrices_and_turned_ones() -> None:
    p = np.array(ADAPTER.validate_python({"angles": [0.4, -1.1, 2.3], "sequence": "zxz"}))
    assert np.abs(quaternion_of(rotation_matrix(p)) @ p) == pytest.approx(1.0, abs=1e-14)
    vector = np.array([0.2, -0.1, 0.4])
    small = rotation_matrix(turned(p, 1e-7 * vector)) - rotation_matrix(p)
    w = rotation_matrix(p).T @ small / 1e-7
    assert np.array([w[2, 1], w[0, 2], w[1, 0]]) == pytest.approx(vector, abs=1e-6)
