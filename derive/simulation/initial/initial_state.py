"""The state that a scene starts from: the consistent one next to what the specification guesses."""

from __future__ import annotations

import numpy as np

from derive.runtime.native import NativeScene, Vector
from derive.simulation.errors import BentStart
from derive.simulation.initial.consistent_state import Start, consistent
from derive.simulation.initial.initial_guess import guess
from derive.simulation.observables import rods
from derive.simulation.observables.observables import Motion
from derive.spec.model.scene import BeamBody, Scene

MOST = 0.3
"""Of the length of a beam: what bends further to meet the joints is no start of this mechanism."""


def begin(scene: Scene, native: NativeScene, k: Vector) -> Start:
    """The consistent start of a scene. Raises SimulationError with what cannot be met, and BentStart where joints are
    met only by beams that bend beyond all that linear displacements describe."""
    start = consistent(native, k, *guess(scene, native))
    if start.deformed:
        motion = Motion(scene, native, k, np.array([start.t]), start.q[None], start.v[None])
        bent = {b.name: rods.bending(motion, b) for b in scene.bodies if isinstance(b, BeamBody)}
        if far := {name: most for name, most in bent.items() if most > MOST}:
            raise BentStart(far)
    return start
