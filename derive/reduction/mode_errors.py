"""How well modes represent a body: its natural frequencies, and its static deflections under unit loads at markers.

Both are compared with those of the full matrices. By the principle of Rayleigh and Ritz no frequency of the modes is
lower, no deflection at a load is larger, and more modes never increase an error.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import scipy.linalg
from scipy.sparse import csr_array, identity

from derive.reduction.arithmetic import Array, symmetric_part
from derive.reduction.component_modes import inertia_relief
from derive.reduction.eigen import (
    elastic_modes,
    mass_of_displacements,
    max_elastic_modes,
    modal_stiffness,
    rigid_set_motions,
    symmetric_matrix,
)
from derive.reduction.frames import from_centre_of_mass, orthonormal_modes, rigid_basis
from derive.reduction.integrals import canonical_csr, mass_products
from derive.reduction.interface import RIGID_MOTIONS, marker_motions
from derive.spec.model.body import NodalBody

FIRST_FREQUENCIES = 8
"""The number of frequencies that are computed first; then twice as many, until the limit is passed."""


@dataclass(frozen=True, eq=False)
class UnitLoads:
    """Unit forces and moments at the markers of an interface, and the deflections at each by the full matrices.

    names: of the loads. rows (loads, displacements): the displacement or rotation at each. deflections (loads,): m/N
    or rad/(N m), of the free body whose rigid acceleration balances the load.
    """

    names: tuple[str, ...]
    rows: Array
    deflections: Array


@dataclass(frozen=True, eq=False)
class ModeErrors:
    """The frequencies (Hz) and deflections of modes, and their errors relative to those of the full matrices.

    frequency_errors: of the frequencies of the full matrices that were asked for, infinite where modes are missing.
    deflection_errors: of the deflections, as a part of the exact ones.
    """

    frequencies: Array
    frequency_errors: Array
    deflections: Array
    deflection_errors: Array

    @property
    def largest(self) -> float:
        """The largest error."""
        return float(np.concatenate([self.frequency_errors, self.deflection_errors]).max(initial=0.0))


def unit_loads(body: NodalBody) -> UnitLoads:
    """The unit loads at the interface of a body with a stiffness matrix. Raises SpecError as `reduce` does."""
    return _unit_loads(replace(body, name="", modes=None))


@lru_cache(8)
def _unit_loads(body: NodalBody) -> UnitLoads:
    assert body.data.stiffness is not None  # by check_body
    mass = canonical_csr(body.data.mass)
    x = from_centre_of_mass(mass, np.array(body.data.positions, dtype=np.float64))
    if not body.interface_markers:
        return UnitLoads((), np.zeros((0, x.size)), np.zeros(0))
    rows = np.concatenate([marker_motions(body, x, marker, 1.0) for marker in body.interface_markers])
    coordinates = rigid_set_motions(x, body.rigid_sets) if body.rigid_sets else csr_array(identity(x.size))
    k, basis = symmetric_matrix(body.data.stiffness), rigid_basis(mass, x)
    responses = inertia_relief(k, mass_of_displacements(mass), coordinates, basis.reshape(len(basis), -1))(rows)
    names = tuple(
        f"{kind} e{axis} at {marker.name}"
        for marker in body.interface_markers
        for kind in ("force along", "moment about")[: marker.motions // 3]
        for axis in (1, 2, 3)
    )
    return UnitLoads(names, rows, np.einsum("ln,ln->l", responses, (k @ responses.T).T))


def full_frequencies(body: NodalBody, up_to: float, most: int) -> Array:
    """The natural frequencies (Hz) of the free body up to a limit (Hz), and the next one if there is one.

    At most `most` + 1 of them are computed, so that a longer list means more. Raises SpecError as `reduce` does.
    """
    mass = canonical_csr(body.data.mass)
    x = from_centre_of_mass(mass, np.array(body.data.positions, dtype=np.float64))
    there_are = min(max_elastic_modes(mass, RIGID_MOTIONS, body.rigid_sets), most + 1)
    count = min(FIRST_FREQUENCIES, there_are)
    while True:
        values = orthonormal_modes(mass, *elastic_modes(replace(body, modes=count), mass, x))[1][:count]
        result = np.sqrt(np.maximum(values, 0.0)) / (2 * np.pi)
        passed = np.flatnonzero(result > up_to)
        if passed.size or count == there_are:
            return result[: passed[0] + 1] if passed.size else result
        count = min(2 * count, there_are)


def mode_errors(body: NodalBody, phi: Array, full: Array) -> ModeErrors:
    """The errors of modes phi (N, nodes, 3) in the mean frame, for frequencies `full` (Hz) and the loads of a body."""
    assert body.data.stiffness is not None  # by check_body
    mass, k, loads = canonical_csr(body.data.mass), symmetric_matrix(body.data.stiffness), unit_loads(body)
    c8, stiffness = symmetric_part(mass_products(mass, phi, phi)), modal_stiffness(k, phi)
    own = np.sqrt(np.maximum(scipy.linalg.eigvalsh(stiffness, c8), 0.0)) / (2 * np.pi) if len(phi) else np.zeros(0)
    known = min(len(own), len(full))
    frequency_errors = np.full(len(full), np.inf)
    frequency_errors[:known] = own[:known] / full[:known] - 1
    forces = phi.reshape(len(phi), k.shape[0]) @ loads.rows.T
    deflections = (
        np.einsum("nl,nl->l", forces, np.linalg.solve(stiffness, forces)) if len(phi) else 0 * loads.deflections
    )
    return ModeErrors(own, np.abs(frequency_errors), deflections, np.abs(1 - deflections / loads.deflections))
