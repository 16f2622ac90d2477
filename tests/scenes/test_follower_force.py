"""Beck's column: a clamped beam flutters under a follower force, and buckles much earlier under a dead load."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import scipy.linalg
from made import make

from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import constraint_matrix
from derive.spec.toml.read import parse

COLUMN = """
name = "column"
ground.markers = {{ base = [0, 0] }}
parameters = {{ follower = {{ default = 0 }}, dead = {{ default = 0 }} }}
[bodies.rod]
mass = 1
length = 1
bending_stiffness = 1
pieces = {pieces}
markers = {{ root = -1, tip = 1 }}
start = {{ position = [0.5, 0] }}
[joints.clamp]
kind = "fixed"
between = ["ground.base", "rod.root"]
[forces.follower_force]
at = "rod.tip"
components = ["-follower", 0]
frame = "body"
[forces.dead_load]
at = "rod.tip"
components = ["-dead", 0]
"""


@cache
def column(pieces: int) -> tuple[NativeScene, np.ndarray]:
    """The compiled column, and its straight state."""
    made = make(parse(COLUMN.format(pieces=pieces)), complete=True)
    return made.native, made.start()[1].q


def growth(pieces: int, load: float, frame: str) -> float:
    """The largest real part of the eigenvalues about the straight column, in sqrt(EI/(m l^3)).

    The motion is linearised with the generated Jacobian dF/dy + cj dF/dydot, on the displacements with G dq = 0.
    """
    native, q = column(pieces)
    k = native.setup([load, 0.0] if frame == "body" else [0.0, load])
    _, multipliers = native.solve(0.0, q, np.zeros(native.nv), k)
    y, n = np.concatenate([q, np.zeros(native.nv), multipliers]), native.nq
    dae = native.dae["index3"]
    still, moving = (dae.pattern.dense(dae.jacobian(0.0, y, 0 * y, cj, k)) for cj in (0.0, 1.0))
    free = scipy.linalg.null_space(constraint_matrix(native, 0.0, q, k))
    M = free.T @ (moving - still)[n : 2 * n, n : 2 * n] @ free
    K = free.T @ still[n : 2 * n, :n] @ free
    return float(np.sqrt(np.linalg.eigvals(-np.linalg.solve(M, K)).astype(complex)).real.max())


def critical(pieces: int, frame: str) -> float:
    """The load at which the straight column becomes unstable, in EI/l^2, by bisection."""
    low, high = 1.0, 30.0
    while high - low > 1e-4 * high:
        middle = (low + high) / 2
        low, high = (low, middle) if growth(pieces, middle, frame) > 1e-3 else (middle, high)
    return high


@pytest.mark.parametrize(
    ("frame", "load", "limit"),
    [pytest.param("body", 20.0509, 1e-2, marks=pytest.mark.long), ("inertial", np.pi**2 / 4, 5e-4)],
)
def test_the_column_becomes_unstable_at_the_load_of_beck_and_of_euler(frame: str, load: float, limit: float) -> None:
    """First-order beams know the axial force through their number alone: the error falls with its square."""
    coarse, fine = critical(3, frame), critical(5, frame)
    assert (25 * fine - 9 * coarse) / 16 == pytest.approx(load, rel=limit)
