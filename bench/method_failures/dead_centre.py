"""Dead centres of a rigid crank-slider: the smallest singular value of G over the crank angle, and runs up to them.

The determinant of G is proportional to cos(phi2), the angle of the rod, if the crank is driven, so that it vanishes
where sin(phi1) = l2 / l1, which needs a crank that is as long as the rod. If the slider is driven it vanishes with
sin(phi1 - phi2): where crank and rod are in line, at phi1 = 0 and pi.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import asin, cos, pi, sin

import numpy as np

from bench.method_failures.small_scenes import ANGLE, Driven, crank_slider
from derive.generated_models import generated
from derive.runtime.compiler import RUN_FLAGS
from derive.runtime.loading import load_scene
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.constraints.scaling import spectrum
from derive.simulation.errors import SingularConfiguration
from derive.simulation.simulate import simulate

ANGLES = np.linspace(0.0, 2 * pi, 361)
"""The crank angles, rad: dead centres are among them."""
REVOLUTION = 2 * pi
"""The duration of a run, s: a revolution of a driven crank; a driven slider reaches its dead centre within it."""


@dataclass(frozen=True, eq=False)
class DeadCentre:
    """A crank-slider with a rod of `rod` times the length of the crank.

    angles (n,), singular (n,): the smallest singular value of the scaled G over the crank angle, rad. failure: of a run
    over `REVOLUTION` from a crank angle of 0.5 rad; empty if it passes. reported: the smallest singular value in it.
    """

    driven: Driven
    rod: float
    angles: Vector
    singular: Vector
    failure: str = ""
    reported: float = float("nan")

    @property
    def dead(self) -> tuple[float, ...]:
        """The crank angles, rad, at which a singular value has vanished."""
        return tuple(float(x) for x in self.angles[self.singular < 1e-7])


def dead_centres() -> tuple[DeadCentre, ...]:
    """The cases of a driven crank with a long rod and with one as long as the crank, and of a driven slider.

    Raises CompilerError.
    """
    return tuple(_dead_centre(*case) for case in ((Driven.CRANK, 2.0), (Driven.CRANK, 1.0), (Driven.SLIDER, 2.0)))


def _dead_centre(driven: Driven, rod: float) -> DeadCentre:
    scene = crank_slider(rod, driven)
    native = load_scene(generated(scene)[1], RUN_FLAGS)
    singular = np.array([_smallest(native, driven, rod, float(angle)) for angle in ANGLES])
    try:
        simulate(scene, duration=REVOLUTION, output=REVOLUTION / 100)
    except SingularConfiguration as error:
        return DeadCentre(driven, rod, ANGLES, singular, str(error), error.smallest)
    return DeadCentre(driven, rod, ANGLES, singular)


def _smallest(native: NativeScene, driven: Driven, rod: float, angle: float) -> float:
    """The smallest singular value with this crank angle, whose rod is on the side of the slider."""
    tilt = -asin(min(1.0, max(-1.0, sin(angle) / rod)))
    position = cos(angle) + rod * cos(tilt)
    start = cos(ANGLE) + rod * cos(asin(sin(ANGLE) / rod))
    known = {"crank_phi": angle, "rod_phi": tilt, "slider_s": position}
    q = np.array([known[name] for name in native.coordinates])
    t = angle - ANGLE if driven is Driven.CRANK else start - position
    return spectrum(native, native.setup(), t, q).smallest
