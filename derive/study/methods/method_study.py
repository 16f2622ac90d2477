"""The study of methods on a scene: limits of steps, drift, formulations and conditioning."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from derive.display import html
from derive.errors import TisserandError, first_line
from derive.runtime.native_call import Vector
from derive.short_text import counted, summary
from derive.simulation.compiled_scene import kkt_matrix, mass_matrix
from derive.simulation.constraints.redundancy import involved
from derive.simulation.constraints.scaling import spectrum
from derive.simulation.errors import SimulationError
from derive.spec.model.scene import Scene
from derive.study.methods.drift import FEWEST, ORDER_STEPS, DriftOrder, DriftRun, conserves, drift_order, drift_runs
from derive.study.methods.formulations import FormRun, form_runs
from derive.study.methods.scene_methods import IMPLICIT, Method, MethodScene, method_scene
from derive.study.methods.stability_functions import classical, step_limit
from derive.study.methods.step_limits import LONGEST, HighestFrequency, StepLimit, highest_frequency, step_limits
from derive.study.states import State

HALF = 0.5
"""The step of long runs, divided by the limit of RK4, where stability limits explicit steps."""
RESOLVED = 4.0
"""The steps of RK4 in a mean step of the adaptive method, by which they resolve the motion as well."""
RESOLVED_ORDER_STEPS = 1000
"""The number of such steps that show the order of the drift; those that stability limits are shorter, and more."""
ELASTIC = 0.1
"""The highest frequency at rest over that in motion below which the latter is one of rigid bodies, as of a pendulum."""


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


@dataclass(frozen=True, eq=False)
class MethodStudy:
    """The results of a study of methods; `along` names the motion of `period` (s) from which the states are taken; `h`
    (s) is the step of long runs.

    stiff: whether stability limits explicit steps; they resolve the motion otherwise, and there are no `limits`.
    conserved: whether the work of drives alone changes the energy. order: None for a scene without constraints, and
    where it cannot be measured. notes: the parts that could not be done, and why.
    """

    name: str
    along: str
    period: float
    h: float
    steps: int
    frequency: HighestFrequency
    stiff: bool
    limits: tuple[StepLimit, ...]
    conserved: bool
    drifts: tuple[DriftRun, ...]
    order: DriftOrder | None
    forms: tuple[FormRun, ...]
    conditioning: Conditioning
    notes: tuple[str, ...]

    @property
    def step_text(self) -> str:
        """The text on how the step of long runs is chosen."""
        return "half the limit of rk4" if self.stiff else "which resolve the motion"

    @property
    def missing_energies(self) -> str:
        """The text on why runs have no energies; empty if all have."""
        if self.drifts and not self.conserved:
            text = "no energies: damping or loads change the energy of this scene as well"
            return f"{text}, or a drive moves the support of a body, whose energy the model leaves out"
        if any(len(run.t) and not len(run.energy) for run in self.drifts):
            return f"no energies of runs of fewer than {FEWEST} steps"
        return ""

    def __repr__(self) -> str:
        runs = counted(len(self.drifts) + len(self.forms), "run")
        return summary(f"MethodStudy of {self.name}: {runs} along {self.along}", {"notes": "; ".join(self.notes)})

    _repr_html_ = html


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
    progress(f"{scene.name}: deriving and compiling ...")
    of = method_scene(scene)
    check_memory(of, steps)
    notes: tuple[str, ...] = () if of.alpha else (f"{', '.join(m.value for m in IMPLICIT)}: left out; {of.missing}",)
    methods = [m for m in methods if of.alpha or m not in IMPLICIT]
    motion = of.motion(states)
    frequency, mean_step, stable = (
        highest_frequency(of, motion.states),
        of.period / motion.steps,
        step_limit(classical()),
    )
    limits: list[StepLimit] = []
    if stiff := is_stiff(frequency, stable, mean_step, of.period):
        h = HALF * stable / frequency.largest
        limits = step_limits(of, frequency, methods, progress)
    else:
        h = mean_step / RESOLVED
        notes += (_without_limits(frequency, stable, mean_step),)
    conserved = conserves(of, of.motion(9).states)
    drifts = drift_runs(of, h, steps, methods, conserved, progress)
    forms, order = [], None
    if of.native.nlambda:
        forms = form_runs(of, h, progress)
        try:
            order = drift_order(of, h, ORDER_STEPS if stiff else RESOLVED_ORDER_STEPS)
        except TisserandError as error:
            notes += (f"index 3 drift: not measured; {first_line(error)}",)
    else:
        notes += ("index 3 drift, formulations: left out; this scene has no constraints",)
    return MethodStudy(
        scene.name,
        of.along,
        of.period,
        h,
        steps,
        frequency,
        stiff,
        tuple(limits),
        conserved,
        tuple(drifts),
        order,
        tuple(forms),
        conditioning(of, motion.states),
        notes,
    )


def is_stiff(frequency: HighestFrequency, stable: float, mean_step: float, period: float) -> bool:
    """Whether stability limits the explicit steps of a scene, and not the accuracy of its motion, as of rigid bodies.

    stable: omega h up to which RK4 is stable. mean_step: that of the adaptive method, s. period: of the motion, s.
    """
    elastic = frequency.unloaded > ELASTIC * frequency.largest > 0
    return elastic and HALF * stable / frequency.largest <= min(RESOLVED * mean_step, period / LONGEST)


def _without_limits(frequency: HighestFrequency, stable: float, mean_step: float) -> str:
    """The note on a motion that asks for shorter steps than stability; mean_step: of the adaptive method, s."""
    if not frequency.largest > 0:
        return "largest stable step: left out; nothing vibrates, so that no step is unstable"
    return (
        f"largest stable step: left out; at {frequency.largest:.3g} rad/s rk4 is stable with steps up to "
        f"{stable / frequency.largest:.2g} s, which do not resolve the motion: those of adaptive have {mean_step:.2g} s"
    )


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
