"""`reduce`: the steps from finite-element data to a modal body."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_array

from derive.mechanics.bodies.modal_body import ModalBody, ModalPoint
from derive.reduction.arithmetic import Array, symmetric
from derive.reduction.checks import check_body, check_modes
from derive.reduction.damping import damping_matrix
from derive.reduction.eigen import elastic_modes, modal_stiffness
from derive.reduction.frames import Shapes, centred, in_frame, orthonormal, with_signs
from derive.reduction.integrals import antisymmetric, integrals
from derive.reduction.mass import canonical, products
from derive.reduction.reasons import Parities, structure
from derive.reduction.rigid import rigid_basis, without
from derive.reduction.symmetry import Mirror, apart, mirrors, with_parities
from derive.spec.model.body import NodalBody


@dataclass(frozen=True, eq=False)
class Prepared:
    """The mass matrix, the modes before and after their transformation to the frame, and their parities."""

    mass: csr_array
    raw: Shapes
    shapes: Shapes
    parities: Parities
    orthonormal: bool


def reduce(body: NodalBody) -> ModalBody:
    """The modal body (shape integrals, stiffness, damping) of a body given by finite-element nodes.

    Raises SpecError with a list of all faults of the data.

    Given modes take +, -, *, / and square roots of doubles in a fixed order alone, so that the numbers are the same on
    every machine. Modes that are computed come from LAPACK or ARPACK: the same bytes on the same machine with the same
    libraries, and the last digits differ between machines (and directions within modes of equal frequency, unless a
    mirror symmetry tells them apart). Keep computed modes in a file where bytes matter.
    """
    prepared = prepare(body)
    shapes = prepared.shapes
    result = integrals(prepared.mass, shapes.x, shapes.phi)
    result, stiffness, damping, zeros = structure(
        result,
        shapes.stiffness,
        damping_matrix(body.damping, _deforming_mass(body, prepared), shapes.stiffness),
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
            ModalPoint(m.name, f"node {m.node}", shapes.x[m.node], np.ascontiguousarray(shapes.phi[:, m.node]))
            for m in body.markers
        ),
        zeros=zeros,
    )


ZERO_STIFFNESS = 1e-9
"""A mode has zero stiffness if its stiffness is at most this fraction of the largest."""


def zero_stiffness_modes(body: NodalBody) -> tuple[int, ...]:
    """The numbers of the zero-stiffness modes, counted from 1."""
    values = np.diag(prepare(body).shapes.stiffness)
    return tuple(i for i, value in enumerate(values, 1) if value <= ZERO_STIFFNESS * values.max())


def _deforming_mass(body: NodalBody, prepared: Prepared) -> Array:
    """c8 of the shapes without their rigid motion: in the mean frame c8 itself."""
    mass, shapes = prepared.mass, prepared.shapes
    if prepared.orthonormal and body.frame.kind == "mean":
        return np.eye(len(shapes.phi))
    elastic = without(mass, rigid_basis(mass, centred(mass, shapes.x)), shapes.phi)
    return symmetric(products(mass, elastic, elastic))


def prepare(body: NodalBody) -> Prepared:
    """Modes computed or given, in their frame, orthonormalised and symmetrised: the modes that `reduce` integrates."""
    check_body(body)
    mass = canonical(body.data.mass)
    x = np.array(body.data.positions, dtype=np.float64)
    planes = mirrors(mass, x)
    raw = _modes(body, mass, x, planes)
    check_modes(body, mass, raw)
    shapes = in_frame(mass, raw.x, raw.phi, raw.stiffness, body.frame)
    if body.orthonormal and len(shapes.phi):
        phi, values = orthonormal(mass, shapes.phi, shapes.stiffness)
        phi = with_signs(apart(mass, phi, values, planes))
        shapes = replace(shapes, phi=phi, stiffness=np.diag(values))
    shapes, parities = with_parities(shapes, planes, body.data.stiffness)
    return Prepared(mass, raw, shapes, parities, body.orthonormal)


def _modes(body: NodalBody, mass: csr_array, x: Array, planes: tuple[Mirror, ...]) -> Shapes:
    """Modes and their stiffness as given, or as computed."""
    data = body.data
    origin = "the origin of the node positions"
    if body.modes == 0:
        return Shapes(x, np.zeros((0, *x.shape)), np.zeros((0, 0)), origin)
    if data.modes is None:
        phi, values = orthonormal(mass, *elastic_modes(body, mass, x))
        phi = with_signs(apart(mass, phi, values, planes))[: body.modes]
        return Shapes(x, phi, np.diag(values[: body.modes]), origin)
    count = len(data.modes) if body.modes is None else body.modes
    phi = np.array(data.modes[:count], dtype=np.float64)
    if data.modal_stiffness is not None:
        return Shapes(x, phi, symmetric(np.array(data.modal_stiffness, dtype=np.float64)[:count, :count]), origin)
    return Shapes(x, phi, modal_stiffness(data.stiffness, phi), origin)


def _doc(body: NodalBody, prepared: Prepared) -> str:
    kind = {"mean": "mean frame", "point": "frame at a node", "given": "frame of the modes as given"}[body.frame.kind]
    parts = [f"body of {len(prepared.raw.x)} nodes with {len(prepared.shapes.phi)} modes, {kind}"]
    if prepared.shapes.around:
        parts.append(f"no mean rotation of nodes {', '.join(map(str, prepared.shapes.around))} about it")
    return "; ".join(parts)
