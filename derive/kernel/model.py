"""What `lower` returns: the kernels of one model with the names, units, patterns and reasons they are told with."""

from __future__ import annotations

from dataclasses import dataclass

from derive.kernel.ir import Kernel, Pattern


@dataclass(frozen=True)
class Variable:
    """A coordinate, rate, parameter or constant: its name, what it is, its unit; a parameter has a default."""

    name: str
    doc: str
    unit: str
    default: float = 0.0


@dataclass(frozen=True)
class Zero:
    """A structural zero, or a vanished term, with its reason."""

    what: str
    reason: str


@dataclass(frozen=True)
class Model:
    """The kernels of one model. `kernels` begins with setup; `markers` names those that are material points."""

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

    def kernel(self, name: str) -> Kernel:
        """The kernel of that name."""
        return next(kernel for kernel in self.kernels if kernel.name == name)

    def pattern(self, kernel: str, output: str) -> Pattern:
        """The sparsity of a matrix that a kernel writes."""
        found = next(o.pattern for o in self.kernel(kernel).outputs if o.name == output)
        if found is None:
            raise KeyError(f"{output} of {kernel} is no sparse matrix")
        return found
