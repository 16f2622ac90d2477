"""Notes on a body given by its nodes: its properties, in which errors of units show, and its modes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from derive.notes.component_mode_notes import component_mode_notes
from derive.spec.model.body import NodalBody
from derive.spec.model.node_markers import InterfaceMarker
from derive.spec.model.spatial_bodies import FlexibleBody, NodeFrame
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.parsing.faults import names_text

if TYPE_CHECKING:
    from derive.reduction import BodyProperties
    from derive.reduction.arithmetic import Array


def body_notes(spec: NodalBody) -> tuple[str, ...]:
    """Return the properties of a finite-element body, in which errors of units show; how far its modes were from their
    frame, and which of them have no stiffness."""
    from derive.reduction import body_properties, residuals, zero_stiffness_modes

    properties = body_properties(spec)
    notes = [*_of_properties(properties), *component_mode_notes(spec), *_of_geometric_stiffness(spec)]
    notes += _of_weights(spec, spec.interface_markers)
    notes += _of_first_order(spec, properties)
    notes += _of_stresses(spec)
    frame = residuals(spec)
    before, after = frame.before, frame.after
    if spec.frame.kind != "point" and spec.modes != 0:
        asked = "" if spec.frame.kind == "mean" else " (no condition of the frame as given)"
        notes.append(
            f"mean displacement of the modes (17): {before.displacement:.1e} of their size as given, "
            f"{after.displacement:.1e} as used; mean rotation (19): {before.rotation:.1e}, {after.rotation:.1e}{asked}"
        )
    if modes := zero_stiffness_modes(spec):
        numbers = ", ".join(map(str, modes))
        notes.append(f"warning: mode {numbers} has no stiffness; check for loose parts and missing elements")
    return tuple(notes)


def notes_on_flexible_bodies(scene: SpatialScene) -> tuple[str, ...]:
    """Return the notes of `body_notes` on each finite-element body of a scene, once for bodies that are alike."""
    alike = tuple(
        f"{names_text(own)}: {note}" for body, own in alike_bodies(scene).items() for note in body_notes(body)
    )
    flexible = [body for body in scene.bodies if isinstance(body, FlexibleBody)]
    markers = ((b, [m for m in b.markers if m.name not in b.body.interface]) for b in flexible)
    return (*alike, *(f"{b.name}: {note}" for b, own in markers for note in _of_weights(b.body, own)))


def alike_bodies(scene: SpatialScene) -> dict[NodalBody, list[str]]:
    """The finite-element bodies of a scene without their names, each with the names of those that are like it."""
    names: dict[NodalBody, list[str]] = {}
    for body in scene.bodies:
        if isinstance(body, FlexibleBody):
            names.setdefault(replace(body.body, name=""), []).append(body.name)
    return names


def _of_weights(spec: NodalBody, markers: Iterable[InterfaceMarker | NodeFrame]) -> Iterator[str]:
    """Yield which weights the mean motions of sets of nodes have."""
    from derive.reduction.marker_motion import marker_motion

    names: dict[str, list[str]] = {}
    for marker in markers:
        if len(marker.nodes) > 1 and tuple(marker.nodes) not in spec.rigid_sets:
            by_area = marker_motion(spec, marker, spec.data.positions).by_area
            weights = "weights as given" if marker.weights else "equal weights of the nodes"
            names.setdefault("the area of faces of elements" if by_area else weights, []).append(marker.name)
    if names:
        yield f"mean motions of sets: {'; '.join(f'{names_text(own)} by {what}' for what, own in names.items())}"


def _of_geometric_stiffness(spec: NodalBody) -> Iterator[str]:
    """Yield which geometric stiffness matrices a body has, whether they are used, and which are taken as zero."""
    data = spec.data
    if spec.computes_geometric_stiffness:
        yield "displacements of second order in the amplitudes, from geometric stiffness by stresses of the elements"
        return
    if not (data.has_geometric_stiffness and spec.uses_given_modes):
        return
    arrays = {"K0t": data.K0t, "K0r": data.K0r, "K0omega": data.K0omega, "K0F": data.K0F}
    given = ", ".join(name for name, array in arrays.items() if array is not None)
    if not spec.second_order:
        yield f"warning: geometric stiffness {given} is left out, since order = 1"
        return
    missing = ", ".join(name for name, array in arrays.items() if array is None)
    zero = f"; {missing}: not given, and taken as zero" if missing else ""
    yield f"displacements of second order in the amplitudes, from geometric stiffness {given}{zero}"


DIFFERENT_ENERGY = 0.01
"""The part of the strain energy of a mode that elements and stiffness may differ by without a warning."""


def _of_stresses(spec: NodalBody) -> Iterator[str]:
    """Yield the mode whose strain energy by the elements differs most from that by the stiffness, if it does."""
    mesh = spec.data.mesh
    if mesh is None or not mesh.is_elastic or not (spec.stress or spec.computes_geometric_stiffness):
        return
    from derive.reduction.body import prepare
    from derive.reduction.mesh_stiffening import integrated_mesh, strain_energy_ratios

    shapes = prepare(spec).shapes
    ratios = strain_energy_ratios(integrated_mesh(mesh, shapes), shapes)
    worst = int(np.argmax(np.abs(ratios - 1))) if len(ratios) else 0
    if len(ratios) and abs(ratios[worst] - 1) > DIFFERENT_ENERGY:
        yield (
            f"warning: mode {worst + 1} has {ratios[worst]:.3g} times the strain energy by its elements that it has by "
            "the stiffness, so that stresses of the elements are not those of this stiffness; check materials, units, "
            "and whether all of the stiffness is that of these elements"
        )


NOTICEABLE_SPIN = 0.1
"""The part of a natural frequency from which a spin changes the stiffness of a body by 1 % and more."""

FIRST = 6
"""The natural frequencies that `build` prints."""


def _of_properties(body: BodyProperties) -> Iterator[str]:
    """Yield the mass, centre of mass, inertia and first natural frequencies in words."""
    centre = ", ".join(f"{x:.4g}" for x in _rounded(body.centre, float(np.sqrt(np.trace(body.inertia) / body.mass))))
    inertia = _rounded(body.inertia, float(np.trace(body.inertia)))
    moments = ", ".join(f"{inertia[a, a]:.4g}" for a in range(3))
    products = ", ".join(f"{inertia[a, b]:.4g}" for a, b in ((0, 1), (0, 2), (1, 2)))
    yield f"mass {body.mass:.6g} kg; centre of mass at ({centre}) m"
    yield f"inertia about the centre of mass: J11, J22, J33 = {moments} kg m^2; J12, J13, J23 = {products} kg m^2"
    if len(body.frequencies):
        first = ", ".join(f"{f:.5g}" for f in body.frequencies[:FIRST])
        more = f" and {len(body.frequencies) - FIRST} more" if len(body.frequencies) > FIRST else ""
        yield f"natural frequencies of the free body by its modes: {first} Hz{more}"


def _of_first_order(spec: NodalBody, body: BodyProperties) -> Iterator[str]:
    """Yield the spin from which a body of first order lacks geometric stiffness; a simulation notes that it is
    reached, also where joints hold the body."""
    if len(body.frequencies) and not spec.second_order and not spec.data.has_geometric_stiffness:
        spin = NOTICEABLE_SPIN * 2 * np.pi * body.frequencies[0]
        yield (
            "displacements of first order in the amplitudes: there is no geometric stiffness (K0t, K0r, K0omega, K0F), "
            f"which changes the stiffness by 1 % and more from a spin of {spin:.3g} rad/s, a tenth of the first "
            "natural frequency, and earlier where a joint holds the body"
        )


def _rounded(values: Array, size: float) -> Array:
    """Values without those that are rounding errors of numbers of that size."""
    return np.where(np.abs(values) > 1e-12 * size, values, 0.0)
