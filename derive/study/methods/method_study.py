"""The study of methods on one scene, and on small scenes in which a failure can be seen by itself."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from derive.errors import TisserandError, first_line
from derive.simulation.errors import SimulationError
from derive.spec.model.scene import Scene
from derive.study.methods.attitude import Tumble, tumble
from derive.study.methods.conditioning import Conditioning, conditioning
from derive.study.methods.dead_centre import DeadCentre, dead_centres
from derive.study.methods.drift import FEWEST, DriftOrder, DriftRun, conserves, drift_order, drift_runs
from derive.study.methods.formulations import FormRun, form_runs
from derive.study.methods.free_flight import MomentumDrift, momentum_drifts
from derive.study.methods.ringing import Ringing, ringing
from derive.study.methods.scene_methods import IMPLICIT, Method, MethodScene, method_scene
from derive.study.methods.shape_bases import BasisCondition, RigidMotionLeft, basis_conditions, rigid_motion_left
from derive.study.methods.stability_functions import classical, step_limit
from derive.study.methods.step_control import StepControl, step_controls
from derive.study.methods.step_limits import HighestFrequency, StepLimit, highest_frequency, step_limits

HALF = 0.5
"""The step of long runs, divided by the limit of RK4."""


@dataclass(frozen=True, eq=False)
class MethodStudy:
    """The results of a study of methods; `along` names the motion of `period` (s) from which the states are taken; `h`
    (s) is the step of long runs.

    conserved: whether the work of drives alone changes the energy. order: None for a scene without constraints, and
    where it cannot be measured. notes: the parts that could not be done, and why.
    """

    name: str
    along: str
    period: float
    h: float
    steps: int
    frequency: HighestFrequency
    limits: tuple[StepLimit, ...]
    controls: tuple[StepControl, ...]
    conserved: bool
    drifts: tuple[DriftRun, ...]
    order: DriftOrder | None
    forms: tuple[FormRun, ...]
    conditioning: Conditioning
    ringing: tuple[Ringing, ...]
    dead_centres: tuple[DeadCentre, ...]
    momentum: tuple[MomentumDrift, ...]
    tumble: Tumble
    bases: tuple[BasisCondition, ...]
    rigid: RigidMotionLeft
    notes: tuple[str, ...]

    @property
    def missing_energies(self) -> str:
        """The text on why runs have no energies; empty if all have."""
        if self.drifts and not self.conserved:
            return "no energies: damping or loads change the energy of this scene as well"
        if any(len(run.t) and not len(run.energy) for run in self.drifts):
            return f"no energies of runs of fewer than {FEWEST} steps"
        return ""


MEMORY = 2e9
"""The largest memory of the rows of a run, in bytes."""


def check_memory(of: MethodScene, steps: int) -> None:
    """Raise SimulationError if the rows of a run of `steps` steps do not fit into `MEMORY`."""
    needed = 8.0 * steps * (of.native.nq + of.native.nv + of.native.nlambda)
    if needed > MEMORY:
        most = int(steps * MEMORY / needed)
        raise SimulationError(
            f"{of.scene.name}: the rows of {steps} steps need {needed / 1e9:.3g} GB; give at most {most} --steps"
        )


def method_study(
    scene: Scene, methods: Sequence[Method], steps: int, states: int, progress: Callable[[str], None]
) -> MethodStudy:
    """The study of a scene: long runs of `steps` steps, and `states` states along its motion.

    Raises SpecError, CompilerError, SimulationError.
    """
    progress(f"{scene.name}: deriving and compiling")
    of = method_scene(scene)
    check_memory(of, steps)
    notes: tuple[str, ...] = () if of.alpha else (f"{', '.join(m.value for m in IMPLICIT)}: left out; {of.missing}",)
    methods = [m for m in methods if of.alpha or m not in IMPLICIT]
    along = of.states(states)
    frequency = highest_frequency(of, along)
    if not frequency.largest > 0:
        raise TisserandError(
            f"{scene.name}: nothing vibrates, so that no step is unstable; choose a scene with a beam that bends"
        )
    h = HALF * step_limit(classical()) / frequency.largest
    limits = step_limits(of, frequency, methods, progress)
    conserved = conserves(of, of.states(9))
    drifts = drift_runs(of, h, steps, methods, conserved, progress)
    forms, order = [], None
    if of.native.nlambda:
        forms = form_runs(of, h, progress)
        try:
            order = drift_order(of, h)
        except TisserandError as error:
            notes += (f"index 3 drift: not measured; {first_line(error)}",)
    else:
        notes += ("index 3 drift, formulations: left out; this scene has no constraints",)
    progress("small cases: estimates of errors, dead centres, free flight, tumbling, shapes")
    return MethodStudy(
        scene.name,
        of.along,
        of.period,
        h,
        steps,
        frequency,
        tuple(limits),
        step_controls(),
        conserved,
        tuple(drifts),
        order,
        tuple(forms),
        conditioning(of, along),
        ringing() if of.alpha else (),
        dead_centres(),
        momentum_drifts(),
        tumble(),
        basis_conditions(),
        rigid_motion_left(),
        notes,
    )
