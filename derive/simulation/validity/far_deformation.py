"""Finite-element bodies of second order that deform so far that what they leave out, of third order, is seen.

Against the nonlinear equilibrium of the same elements, their displacements have a relative error that grows with the
square of the deformation. In the mean frame it is about thirty times the square of the largest displacement of a node
over the diagonal of the body, for forces and for the loads of a spin, as far as the tip of a held bar moves by a
quarter of its length (`tests/solids/test_large_displacements.py`, `bench/bracket.py`).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from derive.percentages import percent
from derive.runtime.native_call import Matrix
from derive.runtime.native_scene import NativeScene
from derive.simulation.free_body import flexible_body
from derive.simulation.validity.missed_modes import MOST_ROWS
from derive.simulation.validity.monitors import ERROR_LIMIT
from derive.spec.model.body import BodyFrame, NodalBody
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene

THIRD_ORDER = 30.0
"""The relative error of displacements over the square of the largest one in the mean frame, over the diagonal."""


def far_deformation_notes(scene: AnyScene, native: NativeScene, q: Matrix) -> Iterator[str]:
    """Yield a note on each finite-element body of second order whose implied error is above the limit; q (n, nq)."""
    for body in scene.bodies if isinstance(scene, SpatialScene) else ():
        places = flexible_body(body.name, native)
        if places is None or not isinstance(body, FlexibleBody) or not body.body.second_order:
            continue
        some = np.unique(np.linspace(0, len(q) - 1, min(len(q), MOST_ROWS)).round().astype(int))
        largest, error = left_out(body.body, q[some][:, places.amplitudes])
        if error > ERROR_LIMIT:
            implied = f"{percent(error)} in its deformation (rms over the run, relative to the peak; the limit is "
            yield (
                f"{body.name}: it deforms by up to {percent(largest)} of its size, from its mean frame; what second "
                f"order leaves out, of third order, implies an error of about {implied}{percent(ERROR_LIMIT)}); divide "
                "it into several bodies"
            )


def left_out(body: NodalBody, amplitudes: Matrix) -> tuple[float, float]:
    """The largest displacement of a node in the mean frame over the diagonal of the body, and the implied error.

    amplitudes (n, modes), m: those of a run.
    """
    from derive.reduction.body import prepare  # only for finite-element bodies
    from derive.reduction.frames import modes_in_frame

    known = prepare(body)
    shapes = modes_in_frame(known.mass, known.shapes.x, known.shapes.phi, known.shapes.stiffness, BodyFrame("mean"))
    displacements = (np.tensordot(a, shapes.phi, 1) for a in amplitudes)
    diagonal = np.linalg.norm(np.ptp(shapes.x, axis=0))
    sizes = np.array([np.linalg.norm(u, axis=1).max() for u in displacements]) / diagonal
    peak = float(sizes.max())
    return peak, float(THIRD_ORDER * np.sqrt(np.mean(sizes**6)) / peak) if peak else 0.0
