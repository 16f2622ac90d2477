"""From a specification to files in one go, with what each stage took and made."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from pathlib import Path

from derive.derivation import derive, lower
from derive.emit.files import File
from derive.emit.model_files import model_files
from derive.kernel.model import Model
from derive.mechanics.equations import Equations
from derive.mechanics.generic import GenericEquations
from derive.spec import SpecError, Specification, read
from derive.spec.read import with_lines


@dataclass(frozen=True)
class Stage:
    """A row of the stage table; None where a column does not apply."""

    name: str
    seconds: float
    terms: int | None = None
    operations: int | None = None
    nonzeros: int | None = None


@dataclass(frozen=True)
class Built:
    """A specification with all that was made of it."""

    spec: Specification
    equations: Equations | GenericEquations
    model: Model
    files: tuple[File, ...]
    stages: tuple[Stage, ...]


def build(path: Path) -> Built:
    """Run all stages on a specification file. Raises SpecError."""
    clock = [time.perf_counter()]

    def lap() -> float:
        clock.append(time.perf_counter())
        return clock[-1] - clock[-2]

    spec = read(path)
    reading = Stage("read", lap())
    try:
        equations = derive(spec)
    except SpecError as error:  # a fault of the numbers, found where they are used
        raise with_lines(error, path) from None
    deriving = Stage("derive", lap(), terms=len(equations.terms))
    model = lower(equations)
    operations, nonzeros = model.kernel("mass_force").operations, model.pattern("mass", "M").full_nnz
    lowering = Stage("lower", lap(), operations=operations, nonzeros=nonzeros)
    if isinstance(equations, Equations):
        deriving = replace(deriving, nonzeros=sum(entry != 0 for entry in equations.mass))
    files = model_files(model, spec)
    emitting = Stage("emit", lap())
    return Built(spec, equations, model, files, (reading, deriving, lowering, emitting))
