"""The result of a lowering: a model with its kernels, and the names, units, patterns and reasons of its quantities."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from derive import display
from derive.ir.kernel import ConstantArray, Kernel
from derive.ir.patterns import Pattern
from derive.registry import UnknownNameError
from derive.roles import Role
from derive.short_text import WIDTH, listed, summary
from derive.spec.model.time_function import Spline

RESIDUAL = "residual"
"""The name of the kernel of the residual of implicit integrators."""
JACOBIAN = "jacobian"
"""The name of the kernel of the iteration matrix of implicit integrators."""
PARAMETER_JACOBIAN = "parameter_jacobian"
"""The name of the kernel of derivatives with respect to parameters and inputs."""


@dataclass(frozen=True)
class Variable:
    """A generalised coordinate, generalised velocity, equation of motion, parameter, constant, marker or multiplier.

    doc: a description in words; unit: that of the value; default: the value of a parameter that the user does not set;
    size: the number of values of an array; role: what a coordinate describes; shown: the name for people, link[3]_phi
    of link_3_phi, where that is another one.
    """

    name: str
    doc: str
    unit: str
    default: float = 0.0
    size: int = 1
    role: Role | None = None
    shown: str = ""

    @property
    def elements(self) -> tuple[str, ...]:
        """The names of the values of the variable."""
        return element_names(self.name, self.size)

    @property
    def columns(self) -> tuple[str, ...]:
        """The names of its values for people, which are those of columns."""
        return (self.shown,) if self.shown else self.elements

    @property
    def title(self) -> str:
        """The name for people, link[3]_phi; of an array that of the whole array."""
        return self.shown or self.name


def element_names(name: str, size: int) -> tuple[str, ...]:
    """The names of the values of a variable; those of an array are numbered from 1, as straight-line code has them."""
    if size == 1:
        return (name,)
    stem = name.removesuffix("dot")
    return tuple(f"{stem}{k}{name[len(stem) :]}" for k in range(1, size + 1))


@dataclass(frozen=True)
class MarkerClass:
    """Markers of one name of bodies that have one code: functions with the number of the instance as an argument.

    name: that of the functions, which `marker_` and `load_` precede; doc: a description in words; pattern: that of the
    Jacobian in the generalised velocities of the body; markers: the markers of the instances; columns: the first
    generalised velocity of each.
    """

    name: str
    doc: str
    pattern: Pattern
    markers: tuple[Variable, ...]
    columns: tuple[int, ...]


@dataclass(frozen=True)
class Zero:
    """A structural zero, or a vanished term, with its reason."""

    what: str
    reason: str


@dataclass(frozen=True)
class ModelTerm:
    """A term of the equations of motion: the names of its row and of itself, its equation, and where its value goes.

    mass, force: the indices of the values of M and of h that it is a part of.
    """

    row: str
    name: str
    equation: str
    mass: tuple[int, ...]
    force: tuple[int, ...]


@dataclass(frozen=True)
class Kkt:
    """The structure of a scene's KKT matrix [M, -G^T; -G, 0]: lower triangle, order of elimination, fill-in of L.

    relative: the rows of multipliers of joints along which rotations are relative to each other, in inertial
    components, before the rest of the matrix is eliminated; without that change the order is that of a plain LDL^T.
    """

    pattern: Pattern
    order: tuple[int, ...]
    fill: int
    relative: tuple[int, ...] = ()


@dataclass(frozen=True)
class StartState:
    """The initial state of a specification with the defaults of its parameters: q (nq,) and v (nv,) at t = 0."""

    q: tuple[float, ...]
    v: tuple[float, ...]


@dataclass(frozen=True)
class Model:
    """The result of a lowering: the kernels of one model and the description of its quantities.

    Only a scene has multipliers, names of bodies, eliminated components, run-time inputs, outputs and a KKT matrix.

    Attributes:
        name: the name of the model, which is the prefix of its C.
        doc: the kind of model in words.
        frame_doc: the definition of the floating frames in words.
        coordinates: q (nq,) with names, units and roles.
        velocities: v (nv,) likewise.
        equations: the equations of motion with their units.
        parameters: p (np,) with their defaults.
        constants: k (nk,), which `setup` computes from p.
        kernels: the functions, setup first.
        markers: the material points.
        zeros: the structural zeros of the mass matrix.
        vanished: the terms of (15) that vanish.
        lowering: "flat" (straight-line code), "loops" (loops over the modes) or "instances" (loops over the bodies and
            joints).
        choice: the reason for it.
        data: the defaults of parameters that are arrays, as pairs (index, value); all other values are zero.
        multipliers: the constraint reactions on body 2 of each joint, lambda (nlambda,).
        bodies: the names of the bodies of a scene.
        eliminated: the components and constraints that are eliminated.
        kkt: the structure of the KKT matrix.
        inputs: the run-time inputs u.
        outputs: the outputs.
        terms: the terms of the equations of motion with the values they are part of.
        start: the initial state, if it has been computed.
        splines: the tables that kernels look up.
        marker_classes: what loops over instances have in place of `markers`.
        proximal: whether the constraints may be redundant, since a proximal term gives multipliers of least norm.
        in_space: whether the bodies of a scene are in space.
        requested: the names of the functions that it has on request.

    Examples:
        >>> import derive
        >>> model = derive.lower(derive.derive(derive.planar_beam("beam")))
        >>> model.lowering
        'flat'
        >>> [(variable.name, variable.unit) for variable in model.coordinates]
        [('c1', 'm'), ('c2', 'm'), ('phi', 'rad'), ('alpha1', 'm'), ('alpha2', 'm')]
        >>> model.defaults
        (1.0, 1.0, 1.0)
    """

    name: str
    doc: str
    frame_doc: str
    coordinates: tuple[Variable, ...]
    velocities: tuple[Variable, ...]
    equations: tuple[Variable, ...]
    parameters: tuple[Variable, ...]
    constants: tuple[Variable, ...]
    kernels: tuple[Kernel, ...]
    markers: tuple[Variable, ...]
    zeros: tuple[Zero, ...]
    vanished: tuple[Zero, ...]
    lowering: Literal["flat", "loops", "instances"] = "flat"
    choice: str = ""
    data: tuple[tuple[int, float], ...] = ()
    multipliers: tuple[Variable, ...] = ()
    bodies: tuple[str, ...] = ()
    eliminated: tuple[Zero, ...] = ()
    kkt: Kkt | None = None
    inputs: tuple[Variable, ...] = ()
    outputs: tuple[Variable, ...] = ()
    terms: tuple[ModelTerm, ...] = ()
    start: StartState | None = None
    splines: tuple[Spline, ...] = ()
    marker_classes: tuple[MarkerClass, ...] = ()
    proximal: bool = False
    in_space: bool = False
    requested: tuple[str, ...] = ()

    @property
    def defaults(self) -> tuple[float, ...]:
        """The defaults of all parameters."""
        if self.lowering != "loops":
            return tuple(p.default for p in self.parameters)
        values = [0.0] * sum(p.size for p in self.parameters)
        for index, value in self.data:
            values[index] = value
        return tuple(values)

    @property
    def is_scene(self) -> bool:
        """Whether the model has the functions of a scene: `solve`, those of constraints, `poses` and `outputs`."""
        return bool(self.bodies)

    @property
    def explicit(self) -> bool:
        """Whether the kernels are left out that explicit integration does not call."""
        return all(kernel.name != RESIDUAL for kernel in self.kernels)

    @property
    def has_iteration_matrix(self) -> bool:
        """Whether the model has the iteration matrix of index 3."""
        return any(kernel.name == JACOBIAN for kernel in self.kernels)

    @property
    def sensitivities(self) -> bool:
        """Whether the model has the kernels of sensitivities, `parameter_jacobian` among them."""
        return any(kernel.name == PARAMETER_JACOBIAN for kernel in self.kernels)

    @property
    def constant_arrays(self) -> tuple[ConstantArray, ...]:
        """The constant arrays that the kernels read, each once."""
        return tuple({array.name: array for kernel in self.kernels for array in kernel.constants}.values())

    def kernel(self, name: str) -> Kernel:
        """The kernel of that name.

        Raises:
            UnknownNameError: if there is none.

        Examples:
            >>> [argument.name for argument in model.kernel("mass").arguments]
            ['q', 'k']
        """
        for kernel in self.kernels:
            if kernel.name == name:
                return kernel
        raise UnknownNameError("kernel", name, (kernel.name for kernel in self.kernels))

    def pattern(self, kernel: str, output: str) -> Pattern:
        """The sparsity of the matrix `output` that a kernel writes; of a symmetric matrix, that of its lower triangle.

        Raises:
            UnknownNameError: if there is no such kernel or matrix.

        Examples:
            >>> pattern = model.pattern("mass", "M")
            >>> pattern.rowidx
            (0, 1, 2, 3, 4)
        """
        patterns = {o.name: o.pattern for o in self.kernel(kernel).outputs if o.pattern is not None}
        if output not in patterns:
            raise UnknownNameError(f"matrix of {kernel}", output, patterns)
        return patterns[output]

    def _repr_html_(self) -> str:
        """The HTML of the model in a notebook."""
        return display.html(self)

    def __repr__(self) -> str:
        mass, size = self.pattern("mass", "M"), len(self.velocities)
        operations = sum(kernel.operations for kernel in self.kernels)
        return summary(
            f"Model {self.name}: {self.doc}",
            {
                "functions": f"{len(self.kernels)} with {operations} operations, {self.lowering} code",
                "mass matrix": f"{mass.full_nnz} of {size * size} entries are not zero",
                "velocities": listed((v.name for v in self.velocities), WIDTH - 16),
                "parameters": listed((p.name for p in self.parameters), WIDTH - 16),
            },
        )
