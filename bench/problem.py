"""The beam of the paper with any number of shape functions, with parameters and states for its evaluation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from harness import Inputs

import derive

STATES = 64
PARAMETERS = {"m": 1.3, "l": 2.1, "EI": 0.7}


@dataclass(frozen=True)
class Problem:
    """A beam, its equations, its model, the generated files, and inputs for them."""

    spec: derive.PlanarBeam
    equations: derive.Equations
    model: derive.Model
    files: tuple[derive.File, ...]
    inputs: Inputs


def beam(frame: str, shapes: int, orthogonal: bool | None = None) -> derive.PlanarBeam:
    """The free beam with this many shape functions, from two more monomials, since the frame removes two."""
    ansatz = tuple("1" if n == 0 else f"xi^{n}" for n in range(shapes + 2))
    return derive.planar_beam(f"{frame}{shapes}", ansatz=ansatz, frame=frame, orthogonal=orthogonal)


def problem(spec: derive.PlanarBeam, phi: float | None = None) -> Problem:
    """The problem of a beam, at random states with rotations `phi` (rad), or evenly distributed over a revolution."""
    equations = derive.derive(spec).expanded()
    model = derive.lower(equations)
    nv = len(equations.rows)
    states = np.random.default_rng(1).uniform(-1.0, 1.0, (STATES, 2 * nv))
    rotations = np.pi * (2 * np.arange(STATES) + 1 - STATES) / STATES
    states[:, 2] = rotations if phi is None else phi
    states[:, 3:nv] *= 0.2
    p = tuple(PARAMETERS[str(parameter.symbol)] for parameter in equations.parameters)
    inputs = Inputs(p, states, len(model.pattern("mass", "M").rowidx), nv)
    return Problem(spec, equations, model, derive.model_files(model, spec), inputs)
