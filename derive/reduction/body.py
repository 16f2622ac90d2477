"""`reduce`: the steps from finite-element data to a modal body, its damping matrix among them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from scipy.sparse import csr_array

from derive.mechanics.bodies.modal_body import ModalBody, ModalPoint
from derive.reduction.arithmetic import Array, cholesky, eigh, forward_substitution, matrix_product, symmetric_part
from derive.reduction.checks import check_body, check_modes
from derive.reduction.component_modes import component_modes, independent_modes
from derive.reduction.eigen import elastic_modes, modal_stiffness
from derive.reduction.frames import (
    ModeShapes,
    from_centre_of_mass,
    modes_in_frame,
    orthonormal_modes,
    projected_out,
    rigid_basis,
    with_fixed_signs,
)
from derive.reduction.integrals import antisymmetric, canonical_csr, mass_products, shape_integrals
from derive.reduction.mesh_stiffening import free_response, geometric_stiffness_tables, integrated_mesh
from derive.reduction.mode_selection import with_selected_modes
from derive.reduction.point_masses import integrals_of_moments, with_point_masses
from derive.reduction.reasons import Parities, with_exact_zeros
from derive.reduction.second_order import (
    SecondOrderFields,
    combined,
    fields_of,
    in_frame,
    weights_of,
    with_second_order,
    without_rounding,
)
from derive.reduction.symmetry import Mirror, made_symmetric, mirror_planes, separated_by_parity
from derive.spec.model.body import Damping, NodalBody
from derive.spec.model.node_data import NodeData


@dataclass(frozen=True, eq=False)
class Prepared:
    """The result of `prepare`: everything from which `reduce` computes integrals.

    mass: the canonical mass matrix (nodes, nodes). raw: the modes as given or computed. framed: the modes in the
    body frame. shapes: the modes made orthonormal and symmetric. parities: the parities of `shapes`. orthonormal:
    whether c8 of `shapes` is the unit matrix.
    """

    mass: csr_array
    raw: ModeShapes
    framed: ModeShapes
    shapes: ModeShapes
    parities: Parities
    orthonormal: bool


def reduce(body: NodalBody) -> ModalBody:
    """The modal body (shape integrals, stiffness, damping) of a body given by finite-element nodes.

    Raises SpecError with a list of all faults of the data.

    Modes that are given are processed by +, -, *, / and square roots of doubles in a fixed order, so that the results
    are the same to the bit on every machine. Modes that are computed come from LAPACK or ARPACK: their last digits
    depend on the machine and the libraries, and so do the directions of modes of equal frequency, unless a mirror
    symmetry distinguishes them. Keep computed modes in a file where bytes matter.
    """
    prepared = prepare(body)
    shapes = prepared.shapes
    fields = second_order_fields(body, prepared)
    if body.data.moments is not None and body.frame.kind == "given" and not prepared.orthonormal:
        integrals = integrals_of_moments(body.data.moments, len(shapes.phi))  # which keeps zeros of the file exact
    else:
        integrals = shape_integrals(prepared.mass, shapes.x, shapes.phi)
    result, stiffness, damping, zeros = with_exact_zeros(
        with_second_order(integrals, fields),
        shapes.stiffness,
        damping_of(body),
        mean=body.frame.kind == "mean",
        orthonormal=prepared.orthonormal,
        parities=prepared.parities,
    )
    return ModalBody(
        name=body.name,
        doc=_doc(body, prepared),
        origin=shapes.origin,
        mass=result.mass,
        c1=result.c1,
        c2=result.c2,
        C3=result.C3,
        C4=result.S4 + antisymmetric(result.c6),
        C5=result.S5 - antisymmetric(result.c7),
        c6=result.c6,
        c7=result.c7,
        c8=result.c8,
        stiffness=stiffness,
        damping=damping,
        points=tuple(
            ModalPoint(
                m.name,
                f"node {m.node}",
                shapes.x[m.node],
                np.ascontiguousarray(shapes.phi[:, m.node]),
                None if fields is None else fields.points[m.node],
            )
            for m in body.markers
        ),
        zeros=zeros,
        c9=result.c9,
        c10=result.c10,
    )


ZERO_STIFFNESS = 1e-9
"""A mode has zero stiffness if its stiffness is at most this fraction of the largest."""


def zero_stiffness_modes(body: NodalBody) -> tuple[int, ...]:
    """The numbers, from 1, of the modes with zero stiffness. Raises SpecError as `reduce` does."""
    values = np.diag(prepare(body).shapes.stiffness)
    return tuple(i for i, value in enumerate(values, 1) if value <= ZERO_STIFFNESS * values.max())


def damping_of(body: NodalBody) -> Array:
    """The viscous damping matrix (N, N) of the modes of a body. Raises SpecError as `reduce` does."""
    prepared = prepare(body)
    return damping_matrix(body.damping, _deforming_mass(body, prepared), prepared.shapes.stiffness)


def _deforming_mass(body: NodalBody, prepared: Prepared) -> Array:
    """The matrix c8 (N, N) of the modes without their rigid motion; in the mean frame this is c8 itself."""
    mass, shapes = prepared.mass, prepared.shapes
    if prepared.orthonormal and body.frame.kind == "mean":
        return np.eye(len(shapes.phi))
    elastic = projected_out(mass, rigid_basis(mass, from_centre_of_mass(mass, shapes.x)), shapes.phi)
    return symmetric_part(mass_products(mass, elastic, elastic))


def prepare(body: NodalBody) -> Prepared:
    """The modes that `reduce` integrates: given or computed, in the body frame, orthonormalised, and symmetrised.

    Raises SpecError with a list of all faults of the data.
    """
    return _prepared(replace(body, name=""))


@lru_cache(2)
def _prepared(body: NodalBody) -> Prepared:
    body = _with_its_modes(body)
    body = replace(body, data=with_point_masses(body.data))
    check_body(body)
    body = with_selected_modes(body)
    mass = canonical_csr(body.data.mass)
    x = np.array(body.data.positions, dtype=np.float64)
    planes = mirror_planes(mass, x)
    raw = _modes(body, mass, x, planes)
    check_modes(body, mass, raw)
    framed = shapes = modes_in_frame(mass, raw.x, raw.phi, raw.stiffness, body.frame)
    if body.orthonormal and len(shapes.phi):
        phi, values = orthonormal_modes(mass, shapes.phi, shapes.stiffness)
        phi = with_fixed_signs(separated_by_parity(mass, phi, values, planes))
        shapes = replace(shapes, phi=phi, stiffness=np.diag(values))
    shapes, parities = made_symmetric(shapes, planes, body.data.stiffness)
    return Prepared(mass, raw, framed, shapes, parities, body.orthonormal)


def _with_its_modes(body: NodalBody) -> NodalBody:
    """A body whose data contain modes only if it uses them."""
    if body.uses_given_modes or body.data.modes is None:
        return body
    data = replace(body.data, modes=None, modal_stiffness=None, K0t=None, K0r=None, K0omega=None, K0F=None)
    return replace(body, data=replace(data, K0F_nodes=None))


def second_order_fields(body: NodalBody, prepared: Prepared) -> SecondOrderFields | None:
    """The second-order fields of the modes that `prepare` returns; None if the body is one of first order."""
    if not body.second_order:
        return None
    mass, raw, framed = prepared.mass, prepared.raw, prepared.framed
    data = stiffened_data(replace(body, name="")) if body.computes_geometric_stiffness else body.data
    result = in_frame(fields_of(data, len(raw.phi)), mass, raw, framed, body.frame)
    if body.orthonormal:
        result = combined(result, weights_of(mass, prepared.shapes.phi, framed.phi))
    return without_rounding(result)


@lru_cache(2)
def stiffened_data(body: NodalBody) -> NodeData:
    """The data of a body with the geometric stiffness matrices of the modes that it uses, from its elements.

    K0F is that of its markers, its loads and the nodes of its frame. Raises SpecError for elements that are distorted.
    """
    prepared, data = prepare(body), body.data
    assert data.stiffness is not None and data.mesh is not None, "a body of second order has matrices or elements"
    raw = prepared.raw
    if not len(raw.phi):
        return data
    solid = integrated_mesh(data.mesh, raw)
    respond = free_response(raw.x, prepared.mass, data.stiffness, () if body.uses_given_modes else body.rigid_sets)
    frame = () if body.frame.node is None else (body.frame.node, *prepared.framed.around)
    nodes = sorted({*body.loaded_nodes, *(marker.node for marker in body.markers), *frame})
    tables: dict[str, Any] = geometric_stiffness_tables(solid, prepared.mass, raw.phi, nodes, respond)
    return replace(data, **tables)


def _modes(body: NodalBody, mass: csr_array, x: Array, planes: tuple[Mirror, ...]) -> ModeShapes:
    """The modes and their stiffness, as given or computed."""
    data = body.data
    origin = "the origin of the node positions"
    if body.modes == 0:
        return ModeShapes(x, np.zeros((0, *x.shape)), np.zeros((0, 0)), origin)
    if data.modes is None:
        if body.interface_markers and data.stiffness is not None:
            computed = independent_modes(component_modes(body, mass, x), mass, data.stiffness)
        else:
            computed = elastic_modes(body, mass, x)
        phi, values = orthonormal_modes(mass, *computed)
        phi = with_fixed_signs(separated_by_parity(mass, phi, values, planes))[: body.modes]
        return ModeShapes(x, phi, np.diag(values[: body.modes]), origin)
    count = len(data.modes) if body.modes is None else body.modes
    phi = np.array(data.modes[:count], dtype=np.float64)
    if data.modal_stiffness is not None:
        return ModeShapes(
            x, phi, symmetric_part(np.array(data.modal_stiffness, dtype=np.float64)[:count, :count]), origin
        )
    return ModeShapes(x, phi, modal_stiffness(data.stiffness, phi), origin)


def _doc(body: NodalBody, prepared: Prepared) -> str:
    """The description of the body and its frame."""
    kind = {"mean": "mean frame", "point": "frame at a node", "given": "frame of the modes as given"}[body.frame.kind]
    parts = [f"body of {len(body.data.positions)} nodes with {len(prepared.shapes.phi)} modes, {kind}"]
    if body.component_modes and body.interface:
        noun = {"craig_bampton": "Craig-Bampton modes", "attachment": "attachment and free modes"}[body.component_modes]
        parts.append(f"{noun} of the interface {', '.join(body.interface)}")
    if prepared.shapes.around:
        parts.append(f"no mean rotation of nodes {', '.join(map(str, prepared.shapes.around))} about it")
    return "; ".join(parts)


def damping_matrix(damping: Damping, c8: Array, stiffness: Array) -> Array:
    """The viscous damping matrix B = c8 V diag(2 ratio omega) V^T c8 + mass c8 + stiffness K, as (N, N).

    The columns of V are the eigenvectors of K V = c8 V diag(omega^2), orthonormal in c8. `ratio` is the part of
    critical damping in each mode; `mass` (1/s) and `stiffness` (s) are the factors of proportional damping. c8 (N, N)
    is that of the modes without their rigid motion, because the deformation is damped, whatever the frame it is
    measured from: the same amplitudes then have the same damping in every frame.
    """
    result = float(damping.mass) * c8 + float(damping.stiffness) * stiffness
    if not damping.ratio:
        return np.asarray(result)
    lower = cholesky(c8)
    if lower is None:
        raise ValueError("modes are dependent")  # check_modes reports them first, with their combination
    values, vectors = eigh(symmetric_part(forward_substitution(lower, forward_substitution(lower, stiffness).T)))
    rates = 2 * float(damping.ratio) * np.sqrt(np.maximum(values, 0.0))
    modal = matrix_product(lower, vectors.T)  # c8 V, since V = L^-T vectors^T
    return np.asarray(result + symmetric_part(matrix_product(modal * rates, modal.T)))
