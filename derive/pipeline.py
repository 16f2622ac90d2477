"""From a specification to files in one go, with what each stage took and made."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path

from derive.emit.files import File
from derive.emit.model_files import model_files
from derive.kernel.lower import lower
from derive.kernel.model import Model
from derive.mechanics.beam import derive
from derive.mechanics.equations import Equations
from derive.spec import PlanarBeam, read


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

    spec: PlanarBeam
    equations: Equations
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
    equations = derive(spec)
    entries = sum(entry != 0 for entry in equations.mass)
    deriving = Stage("derive", lap(), terms=len(equations.terms), nonzeros=entries)
    model = lower(equations)
    operations = model.kernel("mass_force").operations
    lowering = Stage("lower", lap(), operations=operations, nonzeros=model.pattern("mass", "M").full_nnz)
    files = model_files(model, spec)
    emitting = Stage("emit", lap())
    return Built(spec, equations, model, files, (reading, deriving, lowering, emitting))
