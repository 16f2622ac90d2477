"""The motion of the frames of the pieces of a beam, across their axes, for small motions of a scene.

It is that of their poses, so that it does not matter by which coordinates the bodies of a scene move.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.validity.held_beam import SMALL
from derive.simulation.validity.piece_shapes import IN_PLANE, PieceShapes

POSE = 3
"""The numbers of a pose in the plane: the position and the angle."""


@dataclass(frozen=True, eq=False)
class PieceFrames:
    """The frames of the pieces of beams in the state q (nq,), at t (s), of a scene compiled with k (nk,)."""

    native: NativeScene
    k: Vector
    t: float
    q: Vector

    def motion(self, shapes: PieceShapes, piece: str, motions: Matrix) -> Matrix:
        """(n, 2): how far the origin of a piece moves along its axis of deflection, and by which slope it turns.

        motions (n, nq): those of the coordinates.
        """
        axis = 1 if shapes.axis == IN_PLANE else shapes.axis - 1
        across = self._pose(piece, self.q)[1][axis]
        result = np.zeros((len(motions), 2))
        for row, motion in zip(result, motions, strict=True):
            if not motion.any():
                continue
            step = SMALL * max(1.0, float(np.abs(self.q).max())) / float(np.abs(motion).max())
            (ahead, turned), (behind, before) = (self._pose(piece, self.q + s * step * motion) for s in (1, -1))
            row[:] = np.array([(ahead - behind) @ across, (turned[0] - before[0]) @ across]) / (2 * step)
        return result

    def _pose(self, piece: str, q: Vector) -> tuple[Vector, Matrix]:
        """The origin of a piece, and its axes as rows, in the inertial frame."""
        pose = np.asarray(self.native.poses(self.t, q, self.k))[self.native.bodies.index(piece)]
        if len(pose) == POSE:
            c, s = np.cos(pose[2]), np.sin(pose[2])
            return pose[:2], np.array([[c, s], [-s, c]])
        return pose[:3], pose[3:].reshape(3, 3).T
