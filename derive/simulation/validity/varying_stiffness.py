"""The response of vibrations whose stiffness varies along the rows of a run, and which may lose all of it."""

from __future__ import annotations

import numpy as np

from derive.runtime.native_call import Matrix, Vector


def responses(t: Vector, stiffness: Matrix, load: Matrix) -> Matrix:
    """(rows, n): y from rest under y'' + K y = f in rows at t (rows,), s; K and f are constant between two of them.

    stiffness (rows, n, n), 1/s^2, symmetric; load (rows, n). What is fast against the rows follows its load at once.
    """
    steps = np.diff(t)[:, None]
    squares, modes = np.linalg.eigh((stiffness[1:] + stiffness[:-1]) / 2)
    loads = np.einsum("tij,ti->tj", modes, (load[1:] + load[:-1]) / 2)
    rates = np.sqrt(np.abs(squares))
    stiff, turns, free = squares > 0, rates * steps, rates == 0
    some = np.where(free, 1.0, rates)
    grown = np.where(stiff, 0.0, turns)
    cosine = np.where(stiff, np.cos(turns), np.cosh(grown))
    sine = np.where(free, steps, np.where(stiff, np.sin(turns), np.sinh(grown)) / some)
    half = np.where(stiff, np.sin(turns / 2), np.sinh(grown / 2)) / some
    ramp = np.where(free, steps**2 / 2, 2 * half**2)
    y, rate, result = np.zeros(load.shape[1]), np.zeros(load.shape[1]), [np.zeros(load.shape[1])]
    for X, c, s, r, k, f in zip(modes, cosine, sine, ramp, squares, loads, strict=True):
        own, of_rate = y @ X, rate @ X
        y, rate = X @ (c * own + s * of_rate + r * f), X @ (s * (f - k * own) + c * of_rate)
        result.append(y)
    return np.array(result)
