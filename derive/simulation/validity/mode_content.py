"""Finite-element bodies whose modes do not suffice for their deformation in a run.

Of a body with a stiffness matrix, equilibrium tells what its modes miss (`missed_modes.py`). Of others the fastest mode
takes part in the deformation about as much as the modes that are left out, where there are enough: its part, root mean
square over the run, over the peak of the whole deformation, both in the norm of the mass, is an estimate of the error
of the deformation.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.linalg import eigh

from derive.percentages import implied_percent, percent
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import ConstrainedSystem, mass_matrix, undeformed
from derive.simulation.free_body import FreeBody, flexible_body
from derive.simulation.validity.missed_modes import MissedModes
from derive.simulation.validity.monitoring_outputs import acting_loads, loaded_bodies
from derive.simulation.validity.monitors import ERROR_LIMIT
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene

FEWEST = 3
"""A body with fewer modes has none whose part tells that of the others."""
STILL = 1e-12
"""Deformations are none that are smaller than this in the norm of the mass, m kg^(1/2)."""


@dataclass(frozen=True)
class ModeError:
    """The error of the deformation of a body that its modes imply, over its peak.

    of_loads: whether it is that under its loads; else the part of the fastest mode. frequency: of that, rad/s.
    """

    body: str
    modes: int
    frequency: float
    error: float
    of_loads: bool

    @property
    def note(self) -> str:
        """The error, the limit and the remedy, in one line."""
        of = f"(rms over the run, relative to the peak; the limit is {percent(ERROR_LIMIT)})"
        remedy = "choose more modes, or component modes with `interface` at its joints"
        if self.of_loads:
            return (
                f"{self.body}: under its loads its {self.modes} modes imply an error of "
                f"{implied_percent(self.error)} in its deformation {of}; {remedy}"
            )
        return (
            f"{self.body}: the fastest of its {self.modes} modes, {self.frequency:.4g} rad/s, has "
            f"{percent(self.error)} of its deformation {of}, so that modes that are left out would deform it about as "
            f"much; {remedy}"
        )


def mode_errors(
    scene: AnyScene, native: NativeScene, k: Vector, t: Vector, q: Matrix, v: Matrix
) -> Iterator[ModeError]:
    """The implied errors of the finite-element bodies of a scene in its states q (n, nq), v (n, nv) at t (n,), s."""
    if not isinstance(scene, SpatialScene):
        return
    bodies = [body for body in scene.bodies if isinstance(body, FlexibleBody)]
    equilibrium = loaded_bodies(scene)
    for body in bodies:
        places = flexible_body(body.name, native)
        if places is None:
            continue
        frequencies, amplitudes = _vibrations(native, k, q, places)
        of = partial(ModeError, body.name, places.modes, float(frequencies[-1]))
        if body in equilibrium and _acting(scene, body.name) <= {*native.outputs}:
            yield of(MissedModes(scene, body, native, k, places).error(t, q, v), of_loads=True)
        elif places.modes >= FEWEST:
            peak = float(np.linalg.norm(amplitudes, axis=1).max())
            part = float(np.sqrt(np.mean(amplitudes[:, -1] ** 2)) / peak) if peak > STILL else 0.0
            yield of(part, of_loads=False)


def mode_notes(scene: AnyScene, native: NativeScene, k: Vector, t: Vector, q: Matrix, v: Matrix) -> Iterator[str]:
    """Yield a note on each finite-element body of which the implied error is above the limit; see `mode_errors`."""
    return (of.note for of in mode_errors(scene, native, k, t, q, v) if of.error > ERROR_LIMIT)


def _acting(scene: SpatialScene, body: str) -> set[str]:
    """The names of the outputs of the loads of actions on a body: a run without them does not know its loads."""
    return {output.name for marker, outputs in acting_loads(scene).items() if marker.body == body for output in outputs}


def modal_stiffness(native: ConstrainedSystem, k: Vector, rest: Vector, places: FreeBody) -> Matrix:
    """The stiffness of the amplitudes of a body, from its forces in the undeformed configuration `rest` (nq,).

    Forces at rest depend linearly on the amplitudes.
    """
    still, rates = np.zeros(native.nv), places.rates
    unloaded = native.force(0.0, rest, still, k)[rates]
    stiffness = np.empty((places.modes,) * 2)
    for i in range(places.modes):
        bent = rest.copy()
        bent[places.amplitudes.start + i] = 1.0
        stiffness[:, i] = native.force(0.0, bent, still, k)[rates] - unloaded
    return (stiffness + stiffness.T) / 2


def _vibrations(native: ConstrainedSystem, k: Vector, q: Matrix, places: FreeBody) -> tuple[Vector, Matrix]:
    """The frequencies (rad/s) of the modes with the frame held, and their amplitudes (n, modes) in the mass norm."""
    rest = undeformed(native, q[0])
    mass = mass_matrix(native, rest, k)[places.rates, places.rates]
    squares, shapes = eigh(modal_stiffness(native, k, rest, places), mass)
    return np.sqrt(np.maximum(squares, 0.0)), q[:, places.amplitudes] @ mass @ shapes
