"""The axial forces in a body that joints hold at one end alone: those of loads, of its weight and of its acceleration.

A force T along a uniform cantilever at its free end and a force B that is spread evenly over its length change the
square of the lowest frequency omega by (5.010 T + 1.577 B)/(m l), for it buckles under T = -pi^2/4 EI/l^2 and under
B = -7.837 EI/l^2, and m l omega^2 is 12.362 EI/l^2. B is the weight less the inertia force of the acceleration of the
held end: that of a spin has a note of its own. Loads are counted as if they acted at the free end.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS
from derive.runtime.native_call import Matrix, Vector
from derive.simulation.compiled_scene import mass_matrix, undeformed
from derive.simulation.space.marker_frames import modal_frames_of

if TYPE_CHECKING:
    from derive.simulation.validity.missed_modes import MissedModes

FREE_END, SPREAD = 5.010, 1.577
"""The changes of the squared frequency, in 1/(m l), of unit forces at the free end and spread over the length."""
TURNS = {"rx", "ry", "rz"}
HELD_TURNS = 2
"""The rotations that joints remove, from which on a body that they hold bends as a cantilever."""
FAR = 0.25
"""The least distance of the middle of the nodes over the length of the body along the line to it."""
ROUNDING = 1e-9
"""The part of the forces on a body below which one is rounding."""


@dataclass(frozen=True, eq=False)
class HeldEnd:
    """The held end of a body: the marker of its joints, the direction to the free end, and its distance (m)."""

    loads: MissedModes
    marker: str
    axis: Vector
    length: float

    def change(self, t: float, q: Vector, v: Vector) -> tuple[float, float, float]:
        """The forces T and B (N) along the body in a state, and m l times the change of the squared frequency."""
        loads, native, k, places = self.loads, self.loads.native, self.loads.k, self.loads.places
        m, Q = loads.total_mass(q), places.axes(q)
        inertia = mass_matrix(native, undeformed(native, q), k)[places.translation, places.rotation]
        applied = Q.T @ -native.force(t, q, np.zeros(native.nv), k)[places.translation] - m * (Q.T @ self._gravity(q))
        at_end = float(applied @ self.axis)
        lever = -(Q.T @ inertia) / m  # of the centre of mass, as a vector product
        centre = np.array([lever[2, 1], lever[0, 2], lever[1, 0]])
        root = np.asarray(modal_frames_of(loads.body)[self.marker].point.position, float)
        across = np.cross(self.axis, v[places.rotation])
        of_spin = m * float(across @ across) * float((centre - root) @ self.axis)
        held = sum(loads.forces(t, q, v).values(), np.zeros(3))
        spread = -float(held @ self.axis) - at_end - of_spin
        rounding = ROUNDING * float(np.linalg.norm(held) + np.linalg.norm(applied) + m * np.linalg.norm(across) ** 2)
        at_end, spread = (0.0 if abs(force) < rounding else force for force in (at_end, spread))
        return at_end, spread, FREE_END * at_end + SPREAD * spread

    def _gravity(self, q: Vector) -> Vector:
        """The acceleration of gravity (3,), m/s^2, by the potential of the body in a state (nq,)."""
        native, k, still = self.loads.native, self.loads.k, np.zeros(self.loads.native.nv)
        result = np.zeros(3)
        for axis in range(3):
            moved = q.copy()
            moved[self.loads.places.position.start + axis] += 1.0
            potentials = [native.energy(at, still, k)[2:] for at in (moved, q)]
            result[axis] = -float(np.sum(potentials[0] - potentials[1]))
        return result / self.loads.total_mass(q)


def held_end(loads: MissedModes, positions: Matrix | None) -> HeldEnd | None:
    """The held end of a body with the positions (nodes, 3) of its nodes; None if it is no cantilever."""
    held = dict[str, set[str]]()
    for joint in loads.scene.joints:
        for end in (joint.first, joint.second):
            if end.body == loads.name:
                held.setdefault(end.marker, set()).update(TURNS & {*SPATIAL_JOINTS[joint.kind].removed(joint)})
    if len(held) != 1 or positions is None or not loads.has_reactions:
        return None
    ((marker, turns),) = held.items()
    nodes = next(own.nodes for own in loads.body.markers if own.name == marker)
    levers = positions - positions[list(nodes)].mean(axis=0)  # positions are those of the files, not of the frame
    to_middle = levers.mean(axis=0)
    size = float(np.linalg.norm(to_middle))
    if len(turns) < HELD_TURNS or size == 0.0 or size < FAR * float(np.ptp(levers @ to_middle)) / size:
        return None
    axis = to_middle / size
    return HeldEnd(loads, marker, axis, float((levers @ axis).max()))
