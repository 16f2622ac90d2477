"""Finite-element bodies of first order that their joints pull or press along the line between them.

An axial force P changes the bending stiffness of a body, which first order does not know: the geometric stiffness of
K0F and K0t is missing. It adds the integral of P w'^2 between the joints to twice the strain energy of a vibration with
the deflection w in the floating frame; of a uniform body between two joints, a half sine wave, that is P over the load
of Euler. The masses that move with the body make the vibration slow, and are in neither. P is the mean of the axial
forces at both ends, which differ by the inertia of the body. Where the joints are closer to each other than half of its
length, the force acts on a part of it alone, and is left out. A body that joints hold at one end alone has loads,
weight and acceleration along it, `end_loads`.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations

import numpy as np
from numpy.polynomial.legendre import legder, leggauss, legval, legvander

from derive.percentages import percent
from derive.runtime.native_call import Matrix, ModelError, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import undeformed
from derive.simulation.free_body import flexible_body
from derive.simulation.space.marker_frames import modal_frames_of
from derive.simulation.validity.end_loads import held_end
from derive.simulation.validity.fast_spin import fast_spin_notes, remedy_of
from derive.simulation.validity.held_beam import HeldMode
from derive.simulation.validity.missed_modes import MissedModes, rows_of_run
from derive.simulation.validity.mode_content import modal_stiffness
from derive.simulation.validity.monitoring_outputs import MOST_LOADED
from derive.simulation.validity.monitors import ERROR_LIMIT
from derive.spec.model.body import NodalBody
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene

APART = 0.5
"""The least distance of the joints over the length of the body along the line between them."""
HIGHEST = 6
"""The degree of the polynomial along the line that is the deflection of a vibration."""


def missing_stiffness_notes(
    scene: AnyScene,
    native: NativeScene,
    k: Vector,
    t: Vector,
    q: Matrix,
    v: Matrix,
    *,
    body: NodalBody | None = None,
    beams: bool = True,
) -> dict[str, str]:
    """The notes on geometric stiffness that a motion would need, of spin and of axial forces; see `fast_spin_notes`."""
    return {
        **fast_spin_notes(scene, native, k, q, v, body=body, beams=beams),
        **{f"{name}, axial": note for name, note in axial_load_notes(scene, native, k, t, q, v).items()},
    }


def axial_load_notes(
    scene: AnyScene, native: NativeScene, k: Vector, t: Vector, q: Matrix, v: Matrix
) -> Mapping[str, str]:
    """A note on each finite-element body whose axial force changes its stiffness by more than the limit, by its name.

    The change is the root mean square over the states q (n, nq), v (n, nv) at t (n,), s.
    """
    if not isinstance(scene, SpatialScene):
        return {}
    bodies = [body for body in scene.bodies if isinstance(body, FlexibleBody)]
    if len(bodies) > MOST_LOADED:
        return {}
    notes = {body.name: _note(scene, body, native, k, t, q, v) for body in bodies}
    return {name: note for name, note in notes.items() if note}


def _note(
    scene: SpatialScene, body: FlexibleBody, native: NativeScene, k: Vector, t: Vector, q: Matrix, v: Matrix
) -> str:
    """The note on a body; empty where there is nothing to note."""
    places = flexible_body(body.name, native)
    if places is None or _knows_axial_forces(body):
        return ""
    loads = MissedModes(scene, body, native, k, places)
    ends = _ends(body, loads.markers)
    if ends is None:
        return _note_of_cantilever(loads, t, q, v)
    (left, right), axis = ends
    some = rows_of_run(len(t))
    try:
        forces = [loads.forces(*state) for state in zip(t[some], q[some], v[some], strict=True)]
    except ModelError:
        return ""
    tension = np.array([(at[right] - at[left]) @ axis / 2 for at in forces])
    modes = _vibrations(loads, float(t[0]), q[0])
    change = tension * (_of_unit_tension(loads, modes[0], (left, right), axis) if modes else 0.0)
    rms = float(np.sqrt(np.mean(change**2)))
    if not rms > ERROR_LIMIT:
        return ""
    worst = int(np.abs(change).argmax())
    largest, usual = percent(abs(float(change[worst]))), percent(rms)
    return (
        f"{body.name}: joints {'pull' if tension[worst] > 0 else 'press'} it along the line between {left} and {right} "
        f"with {abs(tension[worst]):.3g} N at t = {t[some][worst]:.6g} s, which changes its bending stiffness by about "
        f"{largest} (rms over the run {usual}; the limit is {percent(ERROR_LIMIT)}), and displacements of first order "
        f"know nothing of it: {remedy_of(body.body)}"
    )


def _note_of_cantilever(loads: MissedModes, t: Vector, q: Matrix, v: Matrix) -> str:
    """The note on a body that joints hold at one end alone; see `end_loads`."""
    spec = loads.body.body
    end = held_end(loads, spec.data.positions)
    if end is None:
        return ""
    some = rows_of_run(len(t))
    try:
        rows = np.array([end.change(*state) for state in zip(t[some], q[some], v[some], strict=True)])
    except ModelError:
        return ""
    squared = _squared_frequency(loads, float(t[0]), q[0])
    change = rows[:, 2] / (loads.total_mass(q[0]) * end.length * squared) if squared else np.zeros(len(rows))
    rms = float(np.sqrt(np.mean(change**2)))
    if not rms > ERROR_LIMIT:
        return ""
    worst = int(np.abs(change).argmax())
    at_end, spread, _ = rows[worst]
    return (
        f"{loads.name}: it is held at {end.marker} alone, and along it act {at_end:.3g} N of loads and {spread:.3g} N "
        f"of its weight and acceleration at t = {t[some][worst]:.6g} s (positive ones pull), which change its bending "
        f"stiffness by about {percent(float(change[worst]))} (rms over the run {percent(rms)}; the limit is "
        f"{percent(ERROR_LIMIT)}), and displacements of first order know nothing of it: {remedy_of(spec)}"
    )


def _knows_axial_forces(body: FlexibleBody) -> bool:
    """Whether a body has the geometric stiffness of forces at its markers, or of its translation."""
    spec = body.body
    own = spec.second_order and (spec.data.K0F is not None or spec.data.K0t is not None)
    return spec.computes_geometric_stiffness or own


def _ends(body: FlexibleBody, markers: set[str]) -> tuple[tuple[str, str], Vector] | None:
    """The two markers of joints that are farthest apart, and the line between them, or None."""
    frames = modal_frames_of(body)
    places = {name: np.asarray(frames[name].point.position, float) for name in sorted(markers)}
    pairs = {pair: places[pair[1]] - places[pair[0]] for pair in combinations(places, 2)}
    if not pairs:
        return None
    pair = max(pairs, key=lambda of: float(np.linalg.norm(pairs[of])))
    length = float(np.linalg.norm(pairs[pair]))
    if length == 0.0:
        return None
    axis = pairs[pair] / length
    extent = float(np.ptp(body.body.data.positions @ axis)) if body.body.data.positions is not None else length
    return (pair, axis) if length >= APART * extent else None


def _of_unit_tension(loads: MissedModes, mode: HeldMode, ends: tuple[str, str], axis: Vector) -> float:
    """The part of the stiffness of a vibration that a tension of 1 N between two markers adds to it."""
    from derive.reduction.body import prepare  # only for finite-element bodies

    shapes = prepare(loads.body.body).shapes
    amplitudes = mode.motion[loads.places.amplitudes]
    field = np.tensordot(amplitudes, shapes.phi, 1)
    along = shapes.x @ axis
    middle, half = (along.max() + along.min()) / 2, float(np.ptp(along)) / 2
    z = (along - middle) / half
    degree = min(HIGHEST, len(np.unique(z.round(6))) - 1)
    w = np.linalg.lstsq(legvander(z, degree), field - np.outer(field @ axis, axis))[0]
    nodes = {marker.name: list(marker.nodes) for marker in loads.body.markers}
    first, last = (float(z[nodes[name]].mean()) for name in ends)
    points, weights = leggauss(degree + 1)
    slopes = legval((first + last + (last - first) * points) / 2, legder(w)) / half
    squared = float(np.sum(slopes**2, axis=0) @ weights) * (last - first) / 2 * half
    return squared / mode.frequency**2  # twice its strain energy, J


def _squared_frequency(loads: MissedModes, t: float, q: Vector) -> float:
    """The square of the lowest frequency of a body as its joints hold it, (rad/s)^2; 0 where they admit none."""
    modes = _vibrations(loads, t, q)
    return modes[0].frequency ** 2 if modes else 0.0


def _vibrations(loads: MissedModes, t: float, q: Vector) -> tuple[HeldMode, ...]:
    """The vibrations of a body as its joints hold it in a state q (nq,) at t (s)."""
    stiffness = modal_stiffness(loads.native, loads.k, undeformed(loads.native, q), loads.places)
    return loads.vibrations(t, q, stiffness)
