"""Finite-element bodies whose fastest mode takes part in their deformation: further modes would, too.

The amplitudes of the modes of a body fall with their frequencies where the body has enough of them. What is left out is
about as large as the last one that is kept: the deformation in the fastest mode, root mean square over the run, over
the peak of the whole deformation, both in the norm of the mass, is an estimate of the error of the deformation.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

from derive.mechanics.symbols import amplitude_of
from derive.percentages import percent
from derive.roles import Role
from derive.runtime.native_call import Matrix, Vector
from derive.simulation.compiled_scene import ConstrainedSystem, coordinates_with, mass_matrix
from derive.simulation.validity.monitors import ERROR_LIMIT
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene

FEWEST = 3
"""A body with fewer modes has none whose part tells that of the others."""
STILL = 1e-12
"""Deformations are none that are smaller than this in the norm of the mass, m kg^(1/2)."""


@dataclass(frozen=True)
class FastestMode:
    """The fastest mode of a body: its frequency, rad/s, the number of modes, and its part of the deformation."""

    body: str
    modes: int
    frequency: float
    part: float


def fastest_modes(scene: AnyScene, native: ConstrainedSystem, k: Vector, q: Matrix) -> Iterator[FastestMode]:
    """The fastest modes of the finite-element bodies of a scene in its states q (n, nq)."""
    for body in scene.bodies if isinstance(scene, SpatialScene) else ():
        if not isinstance(body, FlexibleBody):
            continue
        columns, rows = _own(body.name, native)
        if len(columns) < FEWEST:
            continue
        frequencies, amplitudes = _vibrations(native, k, q, columns, rows)
        peak = float(np.linalg.norm(amplitudes, axis=1).max())
        part = float(np.sqrt(np.mean(amplitudes[:, -1] ** 2)) / peak) if peak > STILL else 0.0
        yield FastestMode(body.name, len(columns), float(frequencies[-1]), part)


def mode_notes(scene: AnyScene, native: ConstrainedSystem, k: Vector, q: Matrix) -> Iterator[str]:
    """Yield a note on each finite-element body whose fastest mode is more than 5 % of its deformation; q (n, nq)."""
    for of in fastest_modes(scene, native, k, q):
        if of.part > ERROR_LIMIT:
            yield (
                f"{of.body}: the fastest of its {of.modes} modes, {of.frequency:.4g} rad/s, has {percent(of.part)} of "
                f"its deformation (rms over the run, relative to the peak; the limit is {percent(ERROR_LIMIT)}), so "
                "that modes that are left out would deform it about as much; choose more modes, or component modes "
                "with `interface` at its joints"
            )


def _own(name: str, native: ConstrainedSystem) -> tuple[list[int], list[int]]:
    """The numbers of the amplitudes of a body among the coordinates and the velocities."""
    columns, rows = list[int](), list[int]()
    while (own := amplitude_of(name, len(columns) + 1).shown) in native.coordinates:
        columns.append(native.coordinates.index(own))
        rows.append(native.velocities.index(amplitude_of(name, len(rows) + 1, 1).shown))
    return columns, rows


def _vibrations(
    native: ConstrainedSystem, k: Vector, q: Matrix, columns: list[int], rows: list[int]
) -> tuple[Vector, Matrix]:
    """The frequencies (rad/s) of the modes with the frame held, and their amplitudes (n, modes) in the mass norm."""
    rest, still = np.where(coordinates_with(native, Role.AMPLITUDE), 0.0, q[0]), np.zeros(native.nv)
    unloaded = native.force(0.0, rest, still, k)[rows]
    stiffness = np.empty((len(rows),) * 2)
    for i, column in enumerate(columns):
        bent = rest.copy()
        bent[column] = 1.0
        stiffness[:, i] = native.force(0.0, bent, still, k)[rows] - unloaded
    mass = mass_matrix(native, rest, k)[np.ix_(rows, rows)]
    squares, shapes = eigh((stiffness + stiffness.T) / 2, mass)
    return np.sqrt(np.maximum(squares, 0.0)), q[:, columns] @ mass @ shapes
