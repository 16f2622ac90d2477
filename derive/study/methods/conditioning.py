"""The condition of M and of the KKT matrix, and the smallest singular value of G, along the motion of a scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from derive.runtime.native_call import Vector
from derive.simulation.compiled_scene import kkt_matrix, mass_matrix
from derive.simulation.constraints.redundancy import involved
from derive.simulation.constraints.scaling import spectrum
from derive.study.methods.scene_methods import MethodScene
from derive.study.states import State


@dataclass(frozen=True, eq=False)
class Conditioning:
    """The condition along the motion, t (n,) in s: the condition numbers of M and of the KKT matrix in SI units, and
    the smallest singular value of G, whose columns are in the metric of M and whose rows have a typical length of 1.

    weakest: the multipliers with a share in the smallest value of all.
    """

    t: Vector
    mass: Vector
    kkt: Vector
    singular: Vector
    weakest: tuple[str, ...]


def conditioning(of: MethodScene, states: Sequence[State]) -> Conditioning:
    """The conditioning in some states of the motion."""
    native, k = of.native, of.k
    spectra = [spectrum(native, k, t, q) for t, q, _ in states]
    smallest = np.array([s.smallest for s in spectra])
    weakest = involved(spectra[int(np.argmin(smallest))], native.multipliers) if native.nlambda else ()
    return Conditioning(
        np.array([t for t, _, _ in states]),
        np.array([np.linalg.cond(mass_matrix(native, q, k)) for _, q, _ in states]),
        np.array([np.linalg.cond(kkt_matrix(native, t, q, k)) for t, q, _ in states]),
        smallest,
        weakest,
    )
