"""The study of methods on a scene: limits of steps, drift, formulations and conditioning."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from derive.display import Tabulated
from derive.errors import TisserandError, first_line
from derive.runtime.native_call import Vector
from derive.short_text import counted, summary
from derive.simulation.compiled_scene import kkt_matrix, mass_matrix
from derive.simulation.constraints.redundancy import involved
from derive.simulation.constraints.scaling import spectrum
from derive.simulation.errors import SimulationError
from derive.simulation.inputs import with_functions
from derive.simulation.validity.fast_spin import fast_spin_notes
from derive.spec.model.specification import AnyScene
from derive.study.methods.drift import FEWEST, ORDER_STEPS, DriftOrder, DriftRun, conserves, drift_order, drift_runs
from derive.study.methods.formulations import FormRun, form_runs
from derive.study.methods.scene_methods import IMPLICIT, Method, MethodScene, method_scene
from derive.study.methods.stability_functions import classical, step_limit
from derive.study.methods.step_limits import LONGEST, HighestFrequency, StepLimit, highest_frequency, step_limits
from derive.study.states import State
from derive.study.studied_scene import studied_scene
from derive.study.study_options import METHODS, STATES, STEPS, STUDIED_METHODS, among, whole
from derive.terminal import Report, reports_of

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


@dataclass(frozen=True, eq=False, repr=False)
class MethodStudy(Tabulated):
    """The results of a study of methods: limits of steps, drift, formulations and conditioning.

    `to_pandas` returns a pandas.DataFrame with a row for each way in which methods fail: its criterion, and
    what was measured.

    Attributes:
        name: that of the scene.
        along: the motion from which the states are taken, in words.
        period: its duration, s.
        h: the step of long runs, s.
        steps: their number of steps.
        frequency: the highest frequency at rest and in motion.
        stiff: whether stability limits explicit steps; they resolve the motion otherwise, and there are no `limits`.
        limits: the largest stable step of each integrator, by theory and by experiment.
        conserved: whether the work of drives alone changes the energy.
        drifts: the long runs, with their errors of constraints and energy.
        order: that of the drift of index 3; None without constraints, and where it cannot be measured.
        forms: the runs of the formulations.
        conditioning: the condition numbers along the motion.
        notes: the parts that could not be done, and why.

    Examples:
        >>> import derive
        >>> pendulum = derive.scene(
        ...     "pendulum",
        ...     gravity=(0, -9.81),
        ...     ground={"hub": [0, 0]},
        ...     bodies={"rod": {"mass": 1, "inertia": 0.1, "markers": {"top": [0, 0.5]}, "start": {"angle": 1.5}}},
        ...     joints={"hub": {"kind": "revolute", "between": ["ground.hub", "rod.top"]}},
        ...     simulation={"duration": 1, "output": 0.01},
        ... )
        >>> study = derive.study_methods(pendulum, integrators=["rk4"], steps=500, states=3)
        >>> study.along, study.steps
        ('1 s', 500)
        >>> list(study.to_pandas().columns)
        ['failure', 'criterion', 'measured', 'agrees']
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


def study_methods(
    scene: AnyScene,
    *,
    integrators: Sequence[str] = STUDIED_METHODS,
    steps: int = STEPS,
    states: int = STATES,
    progress: Report | bool | None = None,
) -> MethodStudy:
    """Study integrators and formulations on a scene: limits of steps, drift, ringing and conditioning.

    The command `tisserand study methods` calls this function.

    Arguments:
        scene: a scene, in the plane or in space, with a simulation, which may be rigid.
        integrators: among "rk4", "adaptive", "rk45", "generalised-alpha" and "trapezoidal", which is generalised-alpha
            with rho = 1; by default all but rk45.
        steps: the number of steps of the runs that show drift.
        states: the number of states along the motion, at least 2.
        progress: called with a line of text on each step; True shows a line, False shows none; by default notebooks
            show one.

    Raises:
        SpecError: if the scene has no simulation.
        UnknownNameError: for an integrator that there is not.
        ValueError: for a number out of its range.
        TypeError: for what is no scene.
        SimulationError: if the scene cannot be simulated, or its runs need too much memory.
        CompilerError: if there is no compiler.

    Examples:
        >>> import derive
        >>> pendulum = derive.scene(
        ...     "pendulum",
        ...     gravity=(0, -9.81),
        ...     ground={"hub": [0, 0]},
        ...     bodies={"rod": {"mass": 1, "inertia": 0.1, "markers": {"top": [0, 0.5]}, "start": {"angle": 1.5}}},
        ...     joints={"hub": {"kind": "revolute", "between": ["ground.hub", "rod.top"]}},
        ...     simulation={"duration": 1, "output": 0.01},
        ... )
        >>> study = derive.study_methods(pendulum, integrators=["rk4"], steps=500, states=3)
        >>> study.stiff, [run.label for run in study.drifts]
        (False, ['rk4, not projected', 'rk4, projected'])
    """
    chosen = [Method(name) for name in among("integrator of a study", integrators, METHODS)]
    counts = whole("steps", steps), whole("states", states, least=2)
    given = with_functions(studied_scene(scene), {})
    with reports_of(progress, given.name) as (task, _):
        return method_study(given, chosen, *counts, task)


def method_study(
    scene: AnyScene, methods: Sequence[Method], steps: int, states: int, progress: Callable[[str], None]
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
    notes += (*fast_spin_notes(of.scene, of.native, of.k, motion.q, motion.v).values(),)
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
