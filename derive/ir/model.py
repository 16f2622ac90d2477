"""What `lower` returns: the kernels of one model with the names, units, patterns and reasons they are told with."""

from __future__ import annotations

from dataclasses import dataclass

from derive.ir.kernel import Kernel
from derive.ir.patterns import Pattern
from derive.roles import Role


@dataclass(frozen=True)
class Variable:
    """A coordinate, rate, parameter or constant: its name, what it is, its unit; a parameter has a default.

    With a `size` it is an array of so many values. Coordinates have a role.
    """

    name: str
    doc: str
    unit: str
    default: float = 0.0
    size: int = 1
    role: Role | None = None


@dataclass(frozen=True)
class Zero:
    """A structural zero, or a vanished term, with its reason."""

    what: str
    reason: str


@dataclass(frozen=True)
class Kkt:
    """The structure of a scene's KKT matrix [M, -G^T; -G, 0]: lower triangle, order of elimination, fill-in of L."""

    pattern: Pattern
    order: tuple[int, ...]
    fill: int


@dataclass(frozen=True)
class Model:
    """The kernels of one model. `kernels` begins with setup; `markers` names those that are material points.

    `lowering` says how they were made, flat (straight line) or table (loops over the shapes), `choice` why. `data`
    holds the defaults of parameters that are arrays, as pairs (index, value); all else is zero.

    A scene has `multipliers`, with the units of what joints exert, `bodies` whose poses it tells, and `left_out`,
    what it does not model.
    """

    name: str
    doc: str
    origin: str
    coordinates: tuple[Variable, ...]
    rates: tuple[Variable, ...]
    rows: tuple[Variable, ...]
    parameters: tuple[Variable, ...]
    constants: tuple[Variable, ...]
    kernels: tuple[Kernel, ...]
    markers: tuple[Variable, ...]
    zeros: tuple[Zero, ...]
    vanished: tuple[Zero, ...]
    lowering: str = "flat"
    choice: str = ""
    data: tuple[tuple[int, float], ...] = ()
    multipliers: tuple[Variable, ...] = ()
    bodies: tuple[str, ...] = ()
    left_out: tuple[Zero, ...] = ()
    kkt: Kkt | None = None

    @property
    def defaults(self) -> tuple[float, ...]:
        """The defaults of all parameters."""
        if self.lowering == "flat":
            return tuple(p.default for p in self.parameters)
        values = [0.0] * sum(p.size for p in self.parameters)
        for index, value in self.data:
            values[index] = value
        return tuple(values)

    def kernel(self, name: str) -> Kernel:
        """The kernel of that name."""
        return next(kernel for kernel in self.kernels if kernel.name == name)

    def pattern(self, kernel: str, output: str) -> Pattern:
        """The sparsity of a matrix that a kernel writes."""
        found = next(o.pattern for o in self.kernel(kernel).outputs if o.name == output)
        if found is None:
            raise KeyError(f"{output} of {kernel} is no sparse matrix")
        return found

    def _repr_html_(self) -> str:
        """What a notebook shows; the report is imported when one asks."""
        from derive.report.notebook import model_html

        return model_html(self)
