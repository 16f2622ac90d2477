"""The error of the deformation of a finite-element body that the modes which are left out imply.

Joints, forces, torques and springs load a body at their markers, its spin loads it everywhere, and its modes with their
inertia. What the modes miss of the static response to these loads, root mean square over the run, is the first part of
the error. The vibrations of the body, as its joints hold it, are too fast by half the share of the strain energy that
is missed in them, and late by that: this is the second part, as that of a beam is (`implied_errors.py`). Gravity
deforms no body by itself. Without a stiffness matrix nothing is known.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS
from derive.mechanics.symbols import Family, Identity
from derive.runtime.native_call import Matrix, ModelError, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import constraint_matrix, mass_matrix, undeformed
from derive.simulation.free_body import FreeBody
from derive.simulation.space.marker_frames import modal_frames_of
from derive.simulation.validity.held_beam import SMALL, HeldMode, admitted_modes
from derive.simulation.validity.monitoring_outputs import acting_loads
from derive.spec.model.instances import joined
from derive.spec.model.node_markers import InterfaceMarker
from derive.spec.model.spatial_bodies import FlexibleBody, NodeFrame
from derive.spec.model.spatial_scene import SpatialScene

if TYPE_CHECKING:
    from derive.reduction.missed_responses import MissedResponses

MOST_ROWS = 300
"""The states of a run that are looked at, evenly spaced."""


@dataclass(frozen=True, eq=False)
class MissedModes:
    """A finite-element body with its places in the state of its compiled scene, whose constants are k (nk,)."""

    scene: SpatialScene
    body: FlexibleBody
    native: NativeScene
    k: Vector
    places: FreeBody

    def error(self, t: Vector, q: Matrix, v: Matrix) -> float:
        """The implied error of the deformation in the states q (n, nq), v (n, nv) at t (n,), over its peak."""
        some = rows_of_run(len(t))
        t, q, v = t[some], q[some], v[some]
        try:
            loads = np.array([self._loads(*state) for state in zip(t, q, v, strict=True)])
        except ModelError:
            return 0.0
        missed = _sizes(loads, self.missed.mass)
        sizes = _sizes(q[:, self.places.amplitudes], self._mass(q[0]))
        peak = float(np.hypot(sizes, missed).max())
        vibrations = self.vibrations(float(t[0]), q[0], self.missed.stiffness)
        late = sorted(self._late(mode, t, q[0], v) for mode in vibrations)
        together = np.hypot(late[-1], np.linalg.norm(late[:-1]) / np.sqrt(2)) if late else 0.0
        return float(np.hypot(_rms(missed), together) / peak) if peak else 0.0

    @cached_property
    def missed(self) -> MissedResponses:
        """The responses to unit loads that the modes miss."""
        from derive.reduction.missed_responses import missed_responses  # only for finite-element bodies

        markers = [self._marker(name) for name in (*(name for name, _ in self._held), *self._acting)]
        return missed_responses(self.body.body, [InterfaceMarker(m.name, m.nodes, m.weights) for m in markers])

    def _marker(self, name: str) -> NodeFrame:
        return next(m for m in self.body.markers if m.name == name)

    @cached_property
    def _acting(self) -> dict[str, list[int]]:
        """The markers on which actions act, with the numbers of the outputs of their loads."""
        numbers = {name: number for number, name in enumerate(self.native.outputs)}
        return {
            marker.marker: [numbers[output.name] for output in outputs]
            for marker, outputs in acting_loads(self.scene).items()
            if marker.body == self.name and outputs[0].name in numbers
        }

    @cached_property
    def _held(self) -> list[tuple[str, list[int]]]:
        """The markers at which joints hold the body, with the numbers of their constraints.

        Other joints have none where they give the coordinates of bodies.
        """
        numbers = {name: number for number, name in enumerate(self.native.multipliers)}
        result = list[tuple[str, list[int]]]()
        for joint in self.scene.joints:
            names = [joined(joint.name, row.label) for row in SPATIAL_JOINTS[joint.kind].rows(joint)]
            names += [drive.name for drive in self.scene.drives if drive.joint == joint.name]
            rows = [numbers[name] for name in names if name in numbers]
            result += [(end.marker, rows) for end in (joint.first, joint.second) if end.body == self.name]
        return result

    @property
    def name(self) -> str:
        """The name of the body."""
        return self.body.name

    @property
    def markers(self) -> set[str]:
        """The markers at which joints hold the body."""
        return {name for name, _ in self._held}

    @property
    def has_reactions(self) -> bool:
        """Whether all joints that hold the body have reactions: those that give coordinates of bodies have none."""
        return all(rows for _, rows in self._held)

    def forces(self, t: float, q: Vector, v: Vector) -> dict[str, Vector]:
        """The forces (3,), N, of the joints at each of these markers, in the axes of the body."""
        result = {name: np.zeros(3) for name in self.markers}
        for name, wrench, Q in self._wrenches(t, q, self.native.solve(t, q, v, self.k)[1]):
            result[name] += Q.T @ wrench[:3]
        return result

    def total_mass(self, q: Vector) -> float:
        """The mass of the body, kg."""
        first = self.places.velocity
        return float(mass_matrix(self.native, q, self.k)[first, first])

    def vibrations(self, t: float, q: Vector, stiffness: Matrix) -> tuple[HeldMode, ...]:
        """The vibrations of the body as its joints hold it; stiffness (N, N): of its modes."""
        rates, K = self.places.rates, np.zeros((self.native.nv,) * 2)
        K[rates, rates] = stiffness
        own = range(rates.start, rates.stop)
        return admitted_modes(K, self.native, self.k, t, undeformed(self.native, q), own)

    def _loads(self, t: float, q: Vector, v: Vector) -> Vector:
        """The forces and moments at markers, in the axes of the body, and the accelerations by modes and by spin."""
        vdot, multipliers = self.native.solve(t, q, v, self.k)
        result = list[Vector]()
        for name, wrench, Q in self._wrenches(t, q, multipliers):
            force, frame = Q.T @ wrench[:3], modal_frames_of(self.body)[name]
            result.append(np.append(force, wrench[3:] - np.cross(frame.point.position, force)))
        if self._acting:
            outputs = self.native.evaluate_outputs(t, q, v, vdot, multipliers, self.k)
            result += [np.asarray(outputs)[numbers] for numbers in self._acting.values()]
        names = (*(name for name, _ in self._held), *self._acting)
        single = [len(self._marker(name).nodes) == 1 for name in names]  # a node has no rotation of its own
        at_markers = [load[:3] if lone else load for load, lone in zip(result, single, strict=True)]
        return np.concatenate([*at_markers, vdot[self.places.rates], self.missed.of_spin(self._spin(v))])

    def _spin(self, v: Vector) -> Vector:
        """The angular velocity in the axes of the body; zero where its rates are not velocities of the scene."""
        names = [Identity(Family.ANGULAR_VELOCITY, components=(i,), owner=self.name).shown for i in (1, 2, 3)]
        if names[0] not in self.native.velocities:
            return np.zeros(3)
        return np.asarray(v[[self.native.velocities.index(name) for name in names]])

    def _wrenches(self, t: float, q: Vector, multipliers: Vector) -> Iterator[tuple[str, Vector, Matrix]]:
        """The force in the inertial axes and the moment in those of the body (6,) of each joint, and these axes."""
        G = constraint_matrix(self.native, t, q, self.k)[:, self.places.rigid] if len(multipliers) else None
        Q = self.places.axes(q)
        for name, rows in self._held:
            assert G is not None
            yield name, G[rows].T @ multipliers[rows], Q

    def _mass(self, q: Vector) -> Matrix:
        rates = self.places.rates
        result: Matrix = mass_matrix(self.native, undeformed(self.native, q), self.k)[rates, rates]
        return result

    def _late(self, mode: HeldMode, t: Vector, q: Vector, v: Matrix) -> float:
        """The lateness of a vibration, root mean square, in the norm of the mass."""
        shape, stiffness = mode.motion[self.places.amplitudes], self.missed.stiffness
        kept = float(shape @ stiffness @ shape)
        load = self._response(mode.motion, float(t[0]), q)
        missed = float(load @ self.missed.energy @ load)
        rate = _sizes(shape[None], self._mass(q))[0] * (v[:, self.places.rates] @ stiffness @ shape) / kept
        late = missed / (missed + kept) / 2 * _rms(rate * (t - t[0]))
        return float(min(late, np.sqrt(2) * _rms(rate) / mode.frequency))

    def _response(self, motion: Vector, t: float, q: Vector) -> Vector:
        """The change of the loads with a small motion from the undeformed state at rest."""
        straight = undeformed(self.native, q)
        step = SMALL * max(1.0, float(np.abs(straight).max())) / float(np.abs(motion).max())
        still = np.zeros(self.native.nv)
        ahead, behind = (self._loads(t, straight + sign * step * motion, still) for sign in (1, -1))
        return (ahead - behind) / (2 * step)


def rows_of_run(count: int) -> Vector:
    """The numbers of the states of a run that are looked at."""
    result: Vector = np.unique(np.linspace(0, count - 1, min(count, MOST_ROWS)).round().astype(int))
    return result


def _sizes(values: Matrix, products: Matrix) -> Vector:
    """(n,): the norms of combinations (n, fields) with these inner products."""
    result: Vector = np.sqrt(np.maximum(np.einsum("ni,ij,nj->n", values, products, values), 0.0))
    return result


def _rms(values: Vector) -> float:
    return float(np.sqrt(np.mean(values**2)))
