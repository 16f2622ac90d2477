"""The measurements on all small cases in which a failure of methods can be seen by itself."""

from __future__ import annotations

from dataclasses import dataclass

from bench.method_failures.attitude import Tumble, tumble
from bench.method_failures.dead_centre import DeadCentre, dead_centres
from bench.method_failures.free_flight import MomentumDrift, momentum_drifts
from bench.method_failures.ringing import Ringing, ringing
from bench.method_failures.shape_bases import BasisCondition, RigidMotionLeft, basis_conditions, rigid_motion_left
from bench.method_failures.step_control import StepControl, step_controls


@dataclass(frozen=True, eq=False)
class SmallCases:
    """The results of all small cases."""

    controls: tuple[StepControl, ...]
    ringing: tuple[Ringing, ...]
    dead_centres: tuple[DeadCentre, ...]
    momentum: tuple[MomentumDrift, ...]
    tumble: Tumble
    bases: tuple[BasisCondition, ...]
    rigid: RigidMotionLeft


def small_cases() -> SmallCases:
    """The measurements, which take some ten seconds. Raises CompilerError, LibraryMissing without KLU."""
    return SmallCases(
        step_controls(), ringing(), dead_centres(), momentum_drifts(), tumble(), basis_conditions(), rigid_motion_left()
    )
