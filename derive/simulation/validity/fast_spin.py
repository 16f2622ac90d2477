"""Bodies in space of first order that spin fast: what their missing geometric stiffness would change.

To first order in the amplitudes the centrifugal forces soften a body by spin^2 c8, and the stiffening that belongs to
them, of K0omega, K0t and the reactions of K0F, is missing. Both are of the size (spin / omega)^2 against the stiffness
of a mode with the natural frequency omega. That of a body is its lowest one, free or, where a joint fixes a set of its
nodes, held there. Centrifugal stresses grow with the distance from the axis, so that a shaft has few about its own one:
the spin that counts is sqrt(w . J w / J_max), with J_max the largest principal moment of inertia.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh, null_space

from derive.notes.body_notes import NOTICEABLE_SPIN
from derive.percentages import percent
from derive.runtime.native_call import Matrix, Vector
from derive.simulation.compiled_scene import ConstrainedSystem, mass_matrix, undeformed
from derive.simulation.configurations import skew
from derive.simulation.free_body import RIGID, FreeBody, flexible_body
from derive.simulation.space.marker_frames import modal_frames_of
from derive.simulation.validity.mode_content import modal_stiffness
from derive.spec.model.beam_pieces import CUT
from derive.spec.model.body import DisplacementOrder, NodalBody
from derive.spec.model.spatial_beam import SpatialBeam, SpatialBody
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene

KNOW_NONE = "displacements of first order know no centrifugal stiffening"


@dataclass(frozen=True)
class Spinning:
    """A body of first order: its specification, its places in the state, and the markers that joints fix."""

    spec: NodalBody | SpatialBeam
    places: FreeBody
    fixed: tuple[str, ...] = ()
    in_scene: FlexibleBody | SpatialBeam | None = None


def fast_spin_notes(
    scene: AnyScene,
    native: ConstrainedSystem,
    k: Vector,
    q: Matrix,
    v: Matrix,
    *,
    body: NodalBody | None = None,
    beams: bool = True,
) -> dict[str, str]:
    """A note on each flexible body of first order that spins fast, by its name; q (n, nq) and v (n, nv) of a motion.

    scene: its beams in pieces. body: the body alone that moves, in an empty scene. beams: whether beams have notes;
    where their axial force is monitored, or models of both orders are compared, they need none.
    """
    result = {}
    for of in _bodies(scene, body, native, beams):
        turning = of.places.rotation
        inertia = mass_matrix(native, undeformed(native, q[0]), k)[turning, turning]
        squares = np.einsum("nk,kl,nl->n", v[:, turning], inertia, v[:, turning]) / np.linalg.eigvalsh(inertia)[-1]
        spin = float(np.sqrt(squares.max(initial=0.0)))
        if spin == 0.0:
            continue
        where, lowest = min(_lowest_frequencies(of, native, k, q[0]), key=lambda pair: pair[1])
        if spin > NOTICEABLE_SPIN * lowest:
            result[of.spec.name] = (
                f"{of.spec.name}: it spins at up to {spin:.4g} rad/s about axes of large inertia, "
                f"{percent(spin / lowest)} of its lowest natural frequency of {lowest:.4g} rad/s ({where}), and its "
                f"{_lack(of.spec)}: {remedy_of(of.spec)}"
            )
    return result


def _lack(spec: NodalBody | SpatialBeam) -> str:
    second = not isinstance(spec, SpatialBeam) and spec.second_order
    return "files lack K0omega, its centrifugal stiffening" if second else KNOW_NONE


def _lacks_stiffening(spec: NodalBody) -> bool:
    """Whether a body is of first order, or of second order by files without the matrices of its spin."""
    return not spec.computes_geometric_stiffness and (not spec.second_order or spec.data.K0omega is None)


def remedy_of(spec: NodalBody | SpatialBeam) -> str:
    """The remedy: the key or the data by which a body of first order has its geometric stiffness."""
    if isinstance(spec, SpatialBeam):
        return "write order = 2, with which it shortens as it bends"
    if spec.second_order:
        return "add it, or elements with materials and a stiffness"
    if spec.uses_given_modes and spec.data.has_geometric_stiffness:
        return "write order = 2, which uses the geometric stiffness of its files"
    if spec.data.gives_geometric_stiffness:
        return "write order = 2, for which its geometric stiffness is computed from its elements"
    if spec.data.has_geometric_stiffness:
        return "use the modes of its files, whose geometric stiffness is there"
    return "add its elements and materials, or K0t, K0r, K0omega and K0F, to its files, or divide it into bodies"


def _bodies(scene: AnyScene, body: NodalBody | None, native: ConstrainedSystem, beams: bool) -> Iterator[Spinning]:
    """The bodies of first order with modes."""
    if body is not None:
        if _lacks_stiffening(body) and native.nv > RIGID:
            yield Spinning(body, FreeBody(native.nv - RIGID))
        return
    for own in scene.bodies if isinstance(scene, SpatialScene) else ():
        left_out = isinstance(own, SpatialBeam) and not beams
        if not left_out and (spec := _of_first_order(own)) and (places := flexible_body(own.name, native)):
            ends = (end for joint in scene.joints if joint.kind == "fixed" for end in (joint.first, joint.second))
            fixed = tuple(end.marker for end in ends if end.body == own.name)
            in_scene = own if isinstance(own, (FlexibleBody, SpatialBeam)) else None
            yield Spinning(spec, places, fixed, in_scene)


def _of_first_order(body: SpatialBody) -> NodalBody | SpatialBeam | None:
    """The flexible body if its displacements are of first order, else None."""
    if isinstance(body, FlexibleBody):
        return body.body if _lacks_stiffening(body.body) else None
    if isinstance(body, SpatialBeam):
        return body if body.order is DisplacementOrder.FIRST_ORDER else None
    return None


def _lowest_frequencies(of: Spinning, native: ConstrainedSystem, k: Vector, q: Vector) -> Iterator[tuple[str, float]]:
    """The lowest natural frequency (rad/s) of the undeformed body, free, and held at each marker that a joint fixes."""
    rest, places = undeformed(native, q), of.places
    modes, own = places.modes, slice(places.rigid.start, places.rates.stop)
    stiffness = np.zeros((RIGID + modes,) * 2)
    stiffness[RIGID:, RIGID:] = modal_stiffness(native, k, rest, places)
    mass = mass_matrix(native, rest, k)[own, own]
    eliminated = np.linalg.solve(mass[:RIGID, :RIGID], mass[:RIGID, RIGID:])
    yield "free", _lowest(np.vstack([-eliminated, np.eye(modes)]), stiffness, mass)
    for marker in of.fixed:
        assert of.in_scene is not None
        frame = modal_frames_of(of.in_scene)[marker]
        point = frame.point
        translation = np.hstack([places.axes(rest).T, -skew(point.position), point.shapes.T])
        rotation = np.hstack([np.zeros((3, 3)), np.eye(3), frame.twists.T])
        where = "where the beam is divided" if marker in CUT else f"at {marker}"
        yield f"held {where}", _lowest(null_space(np.vstack([translation, rotation])), stiffness, mass)


def _lowest(motions: Matrix, stiffness: Matrix, mass: Matrix) -> float:
    """The lowest natural frequency (rad/s) of motions (velocities, n)."""
    K, M = (motions.T @ matrix @ motions for matrix in (stiffness, mass))
    return float(np.sqrt(max(eigh(K, M, eigvals_only=True)[0], 0.0)))
