"""Mass matrix, forces, energies, momentum, rates and poses: each a loop over the bodies of every class."""

from __future__ import annotations

import casadi as ca

from derive.algebra import sp
from derive.ir.expressions import Element, Operator
from derive.ir.indices import constant, variable
from derive.ir.kernel import Kernel
from derive.ir.patterns import Pattern, pattern
from derive.ir.statements import ForEach, Statement, StoreElement
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.context import stores
from derive.lowering.flat.schedule import Step, StepItem
from derive.lowering.instances.loop_code.class_code import INSTANCE, ClassCode, LoopTarget
from derive.lowering.instances.loop_code.context import InstanceContext, force_loops, given_inputs, loops_of
from derive.lowering.instances.loop_code.kernels import ZERO, Result, kernel
from derive.lowering.model_functions import ModelFunction


def mass(context: InstanceContext, function: ModelFunction) -> Kernel:
    """The kernel of the mass matrix M(q)."""
    shape = mass_pattern(context)
    loops = loops_of(context, lambda of, symbols: _mass_items(of, symbols, shape), "q")
    return kernel(context, function, {"M": Result(pattern=shape)}, ("M", "(15)", "factors of the accelerations", loops))


def _mass_items(of: ClassCode, symbols: Symbols, shape: Pattern) -> tuple[list[StepItem], dict[str, LoopTarget]]:
    entries = of.context.mass_pattern().entries
    items = [*stores("M", [symbols(of.context.equations.mass[entry]) for entry in entries])]
    place = of.place("mass", [shape.colptr[m.row] for m in of.of.members])
    return items, {"M": of.target("M", place)}


def mass_pattern(context: InstanceContext) -> Pattern:
    """The pattern of M, which is block-diagonal."""
    n = len(context.rows)
    entries = {
        (m.row + i, m.row + j)
        for of in context.classes
        for i, j in of.context.mass_pattern().entries
        for m in of.of.members
    }
    return pattern(n, n, entries, symmetric=True)


def _force_items(of: ClassCode, symbols: Symbols) -> tuple[list[StepItem], dict[str, LoopTarget]]:
    items = [*stores("h", [symbols(h) for h in of.context.equations.force])]
    return items, {"h": of.target("h", of.row)}


def _force_result(context: InstanceContext) -> Result:
    return Result(("body by body",), count=len(context.rows))


def force(context: InstanceContext, function: ModelFunction) -> Kernel:
    """The kernel of the forces h(t, q, v)."""
    loops = [*loops_of(context, _force_items, "t", "q", "v"), *force_loops(context, "h")]
    return kernel(
        context,
        function,
        {"h": _force_result(context)},
        ("h", "(15)", "centrifugal, Coriolis and elastic terms", loops),
    )


def mass_force(context: InstanceContext, function: ModelFunction) -> Kernel:
    """The kernel of M and h together."""
    shape = mass_pattern(context)

    def both(of: ClassCode, symbols: Symbols) -> tuple[list[StepItem], dict[str, LoopTarget]]:
        (mass, to_mass), (force, to_force) = _mass_items(of, symbols, shape), _force_items(of, symbols)
        return [*mass, *force], {**to_mass, **to_force}

    results = {"M": Result(pattern=shape), "h": _force_result(context)}
    loops = [*loops_of(context, both, "t", "q", "v"), *force_loops(context, "h")]
    return kernel(context, function, results, ("M and h", "(15)", "factors of the accelerations, and the rest", loops))


def _sums(name: str, count: int) -> list[Statement]:
    return [StoreElement(Element(name, constant(k)), ZERO) for k in range(count)]


def energy(context: InstanceContext, function: ModelFunction) -> Kernel:
    """The kernel of the kinetic and strain energies, and of the potential of gravity if there is gravity."""
    labels = ("kinetic", "strain", *(("gravity",) if context.mechanism.scene.gravity else ()))

    def items(of: ClassCode, symbols: Symbols) -> tuple[list[StepItem], dict[str, LoopTarget]]:
        eq = of.context.equations
        every = (eq.kinetic_energy, eq.strain_energy, eq.weight_energy)
        values = [(k, symbols(e)) for k, e in enumerate(every) if e is not None and e != 0]
        return _added("energy", values)

    known = context.known.potentials
    stored = (StoreElement(Element("energy", constant(1)), potential, Operator.ADD) for potential in known)
    return kernel(
        context,
        function,
        {"energy": Result(labels)},
        (
            "energy",
            "(22)",
            "1/2 int rho xdot . xdot and the strain energy",
            [*_sums("energy", len(labels)), *stored, *loops_of(context, items, "q", "v"), *_potentials(context)],
        ),
    )


def _potentials(context: InstanceContext) -> list[ForEach]:
    """The loops that add the energies of springs between bodies to the strain energy."""
    result = []
    for group in context.forces:
        of, ctx = group.code, group.code.context
        potential = ctx.equations.strain_energy
        if potential != 0:
            symbols = ctx.symbols(*given_inputs(of, "q", "v"))
            items, targets = _added("energy", [(1, symbols(potential))])
            inputs = group.state("q", "v")
            result.append(of.loop(symbols, [Step(of.name, "(22)", "", tuple(items))], inputs, targets))
    return result


def _added(output: str, values: list[tuple[int, ca.SX]]) -> tuple[list[StepItem], dict[str, LoopTarget]]:
    """The items that add values to elements of an output."""
    numbers = [k for k, _ in values]
    target = LoopTarget(output, lambda k: constant(numbers[k]), Operator.ADD)
    return [*stores(output, [value for _, value in values])], {output: target}


def momentum(context: InstanceContext, function: ModelFunction) -> Kernel:
    """The kernel of the linear momentum, and of the angular momentum about the inertial origin."""
    linear, angular = (len(of) for of in _momenta(context))
    of_angular = [f"angular_{k + 1}" for k in range(angular)] if angular > 1 else ["angular"]
    labels = (*(f"linear_{k + 1}" for k in range(linear)), *of_angular)

    def items(of: ClassCode, symbols: Symbols) -> tuple[list[StepItem], dict[str, LoopTarget]]:
        eq = of.context.equations
        every = enumerate((*eq.linear_momentum, *eq.angular_momentum))
        return _added("momentum", [(k, symbols(e)) for k, e in every if e != 0])

    return kernel(
        context,
        function,
        {"momentum": Result(labels)},
        (
            "momentum",
            "(1)",
            "int rho xdot and int rho x x xdot",
            [*_sums("momentum", len(labels)), *loops_of(context, items, "q", "v")],
        ),
    )


def _momenta(context: InstanceContext) -> tuple[tuple[sp.Expr, ...], tuple[sp.Expr, ...]]:
    """The linear and the angular momentum of the first body."""
    equations = context.classes[0].context.equations
    return equations.linear_momentum, equations.angular_momentum


def rates(context: InstanceContext, function: ModelFunction) -> Kernel:
    """The kernel of qdot: a copy of v as a whole where the rates of all bodies are their velocities."""

    def items(of: ClassCode, symbols: Symbols) -> tuple[list[StepItem], dict[str, LoopTarget]]:
        values = [symbols(rate) for rate in of.context.equations.rates]
        return [*stores("qdot", values)], {"qdot": of.target("qdot", of.coordinate)}

    count = context.coordinates
    copies = all([*of.context.equations.rates] == [*of.context.v.symbols] for of in context.classes)
    copy = StoreElement(Element("qdot", variable(INSTANCE)), Element("v", variable(INSTANCE)))
    loops = [ForEach(INSTANCE, constant(0), constant(count), (copy,))] if copies else loops_of(context, items, "q", "v")
    return kernel(
        context,
        function,
        {"qdot": Result(("body by body",), count=count)},
        ("rates", "(1)", "in the plane qdot = v" if copies else "time derivatives of quaternions", loops),
    )


def poses(context: InstanceContext, function: ModelFunction) -> Kernel:
    """The kernel of the positions and rotation angles of all body frames."""

    def items(of: ClassCode, symbols: Symbols) -> tuple[list[StepItem], dict[str, LoopTarget]]:
        (pose,) = of.context.equations.poses
        values = [symbols(e) for _, e in pose.parts]
        place = of.place("pose", [size * m.number for m in of.of.members])
        return [*stores("pose", values)], {"pose": of.target("pose", place)}

    size = len(context.classes[0].context.equations.poses[0].parts)
    known = [
        StoreElement(Element("pose", constant(size * n + k)), value)
        for n, instance in enumerate(context.mechanism.instances)
        if not instance.moves
        for k, value in enumerate(context.known.pose(instance.name))
    ]
    count = size * len(context.mechanism.instances)
    return kernel(
        context,
        function,
        {"pose": Result(("body by body",), count=count)},
        ("poses", "(1)", "bodies in the order of the specification", [*known, *loops_of(context, items, "t", "q")]),
    )
