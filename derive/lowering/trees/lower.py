"""The lowering of trees of rigid bodies in relative coordinates to kernels with loops over their links."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from fractions import Fraction

from derive.algebra import sp
from derive.errors import Problem, SpecError
from derive.ir.expressions import Number
from derive.ir.kernel import Argument, Kernel
from derive.ir.model import Model, Variable, Zero
from derive.ir.patterns import pattern
from derive.ir.statements import Clear, Statement, Work
from derive.lowering.attitude import with_attitude_check
from derive.lowering.flat.casadi_symbols import table_name
from derive.lowering.flat.context import Context
from derive.lowering.flat.lower import OF_BODIES, OF_MECHANISMS
from derive.lowering.flat.motion_quantities import with_mass_reciprocal
from derive.lowering.flat.setup import setup_kernel
from derive.lowering.flat.setup_constants import Constants
from derive.lowering.instances.classes.known_motion import KnownMotion
from derive.lowering.instances.loop_code.context import Part, Result, kernel, whole
from derive.lowering.instances.lower import rows_for_people, with_constants
from derive.lowering.instances.places import Places
from derive.lowering.model_functions import FunctionKind, ModelFunction, functions_of
from derive.lowering.requested_functions import requested_functions
from derive.lowering.symbol_variables import symbol_variable
from derive.lowering.trees import invariants, joint_outputs, loads, marker_loads
from derive.lowering.trees.articulated import articulated
from derive.lowering.trees.composite import composite, mass_pattern
from derive.lowering.trees.joint_outputs import LOOPED, MOST_UNROLLED
from derive.lowering.trees.link_loop import LinkArrays
from derive.lowering.trees.links import BodyPlace, Tree, marker_in_body, tree_of
from derive.lowering.trees.motion import TreeMotion
from derive.lowering.trees.newton_euler import newton_euler
from derive.lowering.trees.row_loads import row_loads
from derive.mechanics import quantity
from derive.mechanics.equations import Equations
from derive.mechanics.multibody.bodies.rigid import BODY_FRAME
from derive.mechanics.multibody.space.mechanism import SpatialMechanism
from derive.mechanics.terms import SpatialPose


class TreeContext:
    """The data that the functions of a tree share.

    known: the values of loads that depend on the time; motion: the loops over the links; gravity: its components.
    """

    def __init__(self, mechanism: SpatialMechanism, tree: Tree | None = None) -> None:
        """tree: that of the mechanism, unless a benchmark has another one."""
        self.mechanism, self.tree = mechanism, tree or tree_of(mechanism)
        self.known, self.loads = KnownMotion(mechanism), row_loads(mechanism)
        self.at_markers = marker_loads.marker_loads(mechanism, self.tree)
        inputs = self.known.context.u.symbols
        self.known = KnownMotion(mechanism)
        given = (*loads.definitions(self.loads, inputs), *self.at_markers.definitions)
        self.known.definitions = (*self.known.definitions, *given)
        self.constants = Constants(frozenset())
        self.constants.coefficients |= self.known.context.constants.coefficients
        self.known.context.constants = self.constants
        self.places = Places()
        self.coordinates = len(mechanism.coordinates)
        self.rows = tuple(row.name for row in mechanism.rows)
        self.motion = TreeMotion(self.tree, LinkArrays(self.tree.links, self.places, self.constants))
        self.outputs = joint_outputs.joint_outputs(mechanism)
        gravity, _ = quantity.gravity(mechanism.scene.gravity)
        self.has_gravity = bool(mechanism.scene.gravity)
        values = [Fraction(int(g.value.p), int(g.value.q)) for g in gravity] or [Fraction(0)] * 3
        self.gravity = [Number(value) for value in values]

    @property
    def applied(self) -> list[Part]:
        """The section of the loads."""
        return self.applied_at(self.motion)

    def applied_at(self, motion: TreeMotion) -> list[Part]:
        """The section of the loads for a state in other arrays."""
        body = loads.applied(motion, self.loads, self.known.context.u.symbols, len(self.rows))
        acting = marker_loads.acting(motion, self.at_markers)
        return [("loads", "(10)", "generalised forces of loads and springs", [*body, *acting])]

    @property
    def applied_array(self) -> str:
        """The array of the generalised forces, if there are any."""
        return loads.APPLIED if self.loads.any else ""

    def has(self, kind: FunctionKind) -> bool:
        """Whether a function is in loops."""
        is_output = kind in (FunctionKind.OUTPUTS, FunctionKind.OUTPUTS_JACOBIAN)
        return kind in FUNCTIONS and (self.outputs is not None or not is_output)

    def counted(self, *names: str) -> dict[str, Result]:
        """Outputs with an element for each row."""
        return {name: Result(("row by row",), count=len(self.rows)) for name in names}


def _mass_parts(context: TreeContext) -> list[Part]:
    motion = context.motion
    return [
        motion.frames(moving=False, placed=True, in_tree=True),
        motion.inertias(moving=False),
        *composite(motion, mass_pattern(motion, len(context.rows))),
    ]


def _force_parts(context: TreeContext) -> list[Part]:
    return [*context.applied, *newton_euler(context.motion, context.gravity, ("h", 0), context.applied_array)]


def mass(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the mass matrix M(q)."""
    results = {"M": Result(pattern=mass_pattern(context.motion, len(context.rows)))}
    return kernel(context, function, results, *_mass_parts(context))


def force(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the forces h(t, q, v)."""
    motion = context.motion
    parts = [motion.frames(moving=True), motion.inertias(moving=True), *_force_parts(context)]
    return kernel(context, function, context.counted("h"), *parts)


def mass_force(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of M and h together."""
    motion = context.motion
    shape = mass_pattern(motion, len(context.rows))
    parts = [
        motion.frames(moving=True, placed=True, in_tree=True),
        motion.inertias(moving=True),
        *composite(motion, shape),
        *_force_parts(context),
    ]
    return kernel(context, function, {"M": Result(pattern=shape), **context.counted("h")}, *parts)


def accel(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of vdot, and of no multipliers."""
    motion = context.motion
    results = context.counted("vdot") | {"lam": Result((), count=0)}
    parts = [
        motion.frames(moving=True),
        motion.inertias(moving=True),
        *context.applied,
        *articulated(motion, context.gravity, bool(context.applied_array)),
    ]
    return kernel(context, function, results, *parts)


def energy(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the kinetic energy, the energy of springs, and the potential of gravity if there is any."""
    motion = context.motion
    labels = ("kinetic", "strain", *(("gravity",) if context.has_gravity else ()))
    body = invariants.energy(motion, context.gravity if context.has_gravity else None)
    parts = [motion.frames(moving=True, placed=True), motion.inertias(moving=False)]
    parts.append(("energy", "(22)", "1/2 int rho xdot . xdot", [*body, *loads.stored(motion, context.loads)]))
    return kernel(context, function, {"energy": Result(labels)}, *parts)


def momentum(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the linear momentum, and of the angular momentum about the inertial origin."""
    motion = context.motion
    labels = tuple(f"{of}_{k}" for of in ("linear", "angular") for k in (1, 2, 3))
    parts = [motion.frames(moving=True, placed=True), motion.inertias(moving=False)]
    parts.append(("momentum", "(1)", "int rho xdot and int rho x x xdot", invariants.momentum(motion)))
    return kernel(context, function, {"momentum": Result(labels)}, *parts)


def rates(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of qdot."""
    results = {"qdot": Result(("coordinate by coordinate",), count=context.coordinates)}
    section = "rates", "(1)", "velocities, and time derivatives of quaternions", invariants.rates(context.motion)
    return kernel(context, function, results, section)


def poses(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the positions and rotation tensors of all body frames."""
    motion, instances = context.motion, context.mechanism.instances
    bodies = [context.tree.bodies[of.name].at(*marker_in_body(of, BODY_FRAME)) for of in instances]
    attitudes = [context.tree.bodies[of.name].attitude for of in instances]
    places = [BodyPlace(of.link, attitude, of.origin) for of, attitude in zip(bodies, attitudes, strict=True)]
    results = {"pose": Result(("body by body",), count=invariants.POSE * len(instances))}
    section = "poses", "(1)", "bodies in the order of the specification", invariants.poses(motion, places)
    return kernel(context, function, results, motion.frames(moving=False, placed=True), section)


def nothing(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of a function of constraints, of which there are none."""
    results = {name: Result((), count=0) for name in function.outputs}
    if "G" in results:
        results["G"] = Result(pattern=pattern(0, len(context.rows), set()))
    return kernel(context, function, results, inputs=_nothing)


def project_velocity(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the change of velocities that no constraint asks for."""
    body: list[Statement] = [Clear("dv", len(context.rows))]
    return kernel(context, function, context.counted("dv"), ("dv", "(5)", "no constraints", body), inputs=_nothing)


_nothing = {"r": whole("r", 0, "prescribed change of gdot")}


def residual(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of [qdot - v; M vdot + h]: all forms are one without constraints."""
    count, size = context.coordinates, context.coordinates + len(context.rows)
    motion = replace(context.motion, q=("y", 0), v=("y", count))
    parts = [
        ("rates", "(1)", "qdot - v", invariants.rates(motion, "F", "ydot")),
        motion.frames(moving=True),
        motion.inertias(moving=True),
        *context.applied_at(motion),
        *newton_euler(motion, context.gravity, ("F", count), context.applied_array, ("ydot", count)),
    ]
    results = {"F": Result(("coordinates and rows",), count=size)}
    inputs = {"y": whole("y", size, "state [q; v]"), "ydot": whole("ydot", size, "time derivative of y")}
    return kernel(context, function, results, *parts, inputs=inputs)


def inverse_dynamics(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the generalised forces f = M vdot + h of a motion."""
    motion, target = context.motion, ("f", 0)
    parts = [
        motion.frames(moving=True),
        motion.inertias(moving=True),
        *context.applied,
        *newton_euler(motion, context.gravity, target, context.applied_array, ("vdot", 0)),
    ]
    return kernel(context, function, context.counted("f"), *parts, inputs=_reactions(context))


def gravity_compensation(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the generalised forces h that hold a tree without velocities."""
    motion = replace(context.motion, v=(STILL, 0))
    still: list[Statement] = [Work(STILL, len(context.rows), cleared=True)]
    parts = [
        ("still", "", "no velocities", still),
        motion.frames(moving=True),
        motion.inertias(moving=True),
        *context.applied_at(motion),
        *newton_euler(motion, context.gravity, ("f", 0), context.applied_array),
    ]
    return kernel(context, function, context.counted("f"), *parts)


STILL = "still"
"""The local array of velocities that are all zero."""


def outputs(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the outputs."""
    body = [*joint_outputs.values(context.motion, context.outputs or ())]
    results = {"out": Result(("output by output",), count=len(context.outputs or ()))}
    section = "outputs", "", "motions of joints and their rates", body
    return kernel(context, function, results, section, inputs=_reactions(context))


def outputs_jacobian(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the derivatives of the outputs with respect to q, v, vdot, lambda and u."""
    rows = len(context.rows)
    sizes = (context.coordinates, rows, rows, 0, len(context.known.context.u.symbols))
    shape = joint_outputs.jacobian_pattern(context.outputs or (), sizes)
    body = joint_outputs.derivatives(context.motion, context.outputs or (), shape)
    section = "jacobian", "", "derivatives of the outputs", body
    return kernel(context, function, {"jac": Result(pattern=shape)}, section, inputs=_reactions(context))


def _reactions(context: TreeContext) -> dict[str, Argument]:
    return {
        "vdot": whole("vdot", len(context.rows), "accelerations, as from solve"),
        "lam": whole("lam", 0, "constraint reactions, as from solve"),
    }


FUNCTIONS: Mapping[FunctionKind, Callable[[TreeContext, ModelFunction], Kernel]] = {
    FunctionKind.MASS: mass,
    FunctionKind.FORCE: force,
    FunctionKind.MASS_FORCE: mass_force,
    FunctionKind.ACCEL: accel,
    FunctionKind.SOLVE: accel,
    FunctionKind.ENERGY: energy,
    FunctionKind.MOMENTUM: momentum,
    FunctionKind.RATES: rates,
    FunctionKind.POSES: poses,
    FunctionKind.CONSTRAINTS: nothing,
    FunctionKind.CONSTRAINT_RATES: nothing,
    FunctionKind.CONSTRAINT_JACOBIAN: nothing,
    FunctionKind.CONSTRAINT_BIAS: nothing,
    FunctionKind.PROJECT_VELOCITY: project_velocity,
    FunctionKind.OUTPUTS: outputs,
    FunctionKind.OUTPUTS_JACOBIAN: outputs_jacobian,
    FunctionKind.RESIDUAL: residual,
    FunctionKind.INVERSE_DYNAMICS: inverse_dynamics,
    FunctionKind.GRAVITY_COMPENSATION: gravity_compensation,
}
"""The functions of a tree, by their kinds."""


WITHOUT = f"trees of more than {MOST_UNROLLED} velocities in loops have no derivatives and no functions of markers"


def _equations(context: TreeContext, requested: Collection[str]) -> tuple[Equations, Context | None]:
    """What the table of functions asks for, and the context of straight-line code for functions without loops.

    Raises SpecError for outputs that neither has.
    """
    mechanism = context.mechanism
    if len(context.rows) <= MOST_UNROLLED:
        equations = mechanism.expanded()
        return equations, Context(with_mass_reciprocal(equations) if requested else equations)
    if context.outputs is None:
        text = f"loops in relative coordinates of more than {MOST_UNROLLED} velocities have motions of joints alone"
        others = [output.name for output in mechanism.scene.outputs if output.kind not in joint_outputs.KINDS]
        raise SpecError(tuple(Problem(f"outputs.{name}", f'{text}: write lowering = "flat"') for name in others))
    return replace(
        context.known.context.equations,
        poses=(SpatialPose("", (), ()),),
        weight_energy=sp.S.Zero if context.has_gravity else None,
        outputs=tuple(of.equation for of in context.outputs or ()),
    ), None


def lower_trees(
    mechanism: SpatialMechanism,
    choice: str = "",
    explicit: bool = False,
    sensitivities: bool = False,
    balanced: bool = False,
    requested: Collection[str] = (),
) -> Model:
    """The model of trees of rigid bodies in loops over links. Raises SpecError with all that these do not have."""
    context = TreeContext(mechanism)
    equations, others = _equations(context, requested)
    kernels: list[Kernel] = []
    if others is None:
        choice, explicit = f"{choice}; {WITHOUT}", True
        if sensitivities or balanced or not {*requested} <= LOOPED:
            raise SpecError((Problem("scene.lowering", f'{WITHOUT}, which are needed here: write lowering = "flat"'),))
    every = functions_of(equations, sensitivities, explicit)
    for function in (*every, *requested_functions(equations, requested, sensitivities)):
        if context.has(function.kind):
            kernels.append(FUNCTIONS[function.kind](context, function))
        elif others is not None:
            kernels.append(
                with_attitude_check({**OF_BODIES, **OF_MECHANISMS}[function.kind](others, function), equations)
            )
    setup, constants = setup_kernel(others or context.known.context, kernels)
    scene = mechanism.scene
    inputs = context.known.context.equations.inputs
    return Model(
        name=scene.name,
        doc=mechanism.doc(()),
        frame_doc=mechanism.frame_doc(by_table=True),
        coordinates=tuple(symbol_variable(c.q, c.doc, c.unit, c.role) for c in mechanism.coordinates),
        velocities=tuple(symbol_variable(row.v, row.doc, row.unit) for row in mechanism.rows),
        equations=rows_for_people(mechanism),
        parameters=(),
        constants=constants,
        kernels=(setup, *(with_constants(kernel, constants, context.places.arrays) for kernel in kernels)),
        markers=tuple(Variable(m.name, m.doc, "m", shown=m.shown) for m in equations.markers),
        zeros=(),
        vanished=(),
        lowering="instances",
        choice=choice,
        multipliers=(),
        splines=tuple(replace(s, name=table_name(scene.name, s.name)) for s in equations.splines),
        bodies=tuple(instance.name for instance in mechanism.instances),
        inputs=tuple(Variable(given.name, given.doc, given.unit, shown=given.shown) for given in inputs),
        outputs=tuple(Variable(o.name, o.doc, o.unit, shown=o.shown) for o in equations.outputs),
        eliminated=tuple(Zero(out.what, out.reason) for out in mechanism.eliminated),
        requested=tuple(requested),
        in_space=True,
    )
