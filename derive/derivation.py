"""The two arrows that depend on what is specified: a beam, a body of nodes, a body with parameters, or a scene.

A body in space has two lowerings. Which one is taken follows from the counts of its non-zeros, see `choice`, unless the
specification says it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from derive.errors import Problem, SpecError
from derive.ir.model import Model
from derive.lowering import cost_model as choice
from derive.lowering.flat import lower as flat
from derive.mechanics.bodies import beam
from derive.mechanics.bodies import spatial_body as general
from derive.mechanics.bodies.modal_body import ModalBody
from derive.mechanics.equations import Equations
from derive.mechanics.indexed_equations import GenericEquations
from derive.mechanics.multibody import assembly as mechanism
from derive.spec.model.body import Gravity, Lowering, NodalBody, PlanarBeam, SymbolicBody
from derive.spec.model.scene import Scene, Specification


def derive(spec: Specification) -> Equations | GenericEquations:
    """The equations of motion of what is specified, written out or for a generic shape. Raises SpecError."""
    if isinstance(spec, PlanarBeam):
        return beam.derive(spec)
    if isinstance(spec, Scene):
        return mechanism.derive(spec)
    if isinstance(spec, SymbolicBody):
        found = choice.choose(general.symbolic_tables(spec), general.present_symbolic(spec), spec.modes)
        if _taken(found, spec.lowering) == "flat":
            return replace(general.derive_symbolic(spec), choice=found.reason(spec.lowering))
        return replace(general.generic_symbolic(spec), choice=found.reason(spec.lowering))
    return derive_modal(modal(spec), spec.gravity, spec.lowering)


def _taken(found: choice.Choice, asked: Lowering) -> str:
    try:
        return found.taken(asked)
    except choice.CodeTooLong as error:
        raise SpecError((Problem("body.lowering", str(error)),)) from None


def modal(spec: NodalBody) -> ModalBody:
    """The shape integrals of a body of nodes, in its frame. Raises SpecError with all that is wrong."""
    from derive.reduction import reduce

    return reduce(spec)


def derive_modal(
    body: ModalBody, gravity: Gravity | None = None, lowering: Lowering = "auto"
) -> Equations | GenericEquations:
    """The equations of motion of a body given by its shape integrals. Raises SpecError when they are too long."""
    found = choice.choose(general.modal_tables(body), general.present_modal(body), body.modes)
    if _taken(found, lowering) == "flat":
        return replace(general.derive_modal(body, gravity), choice=found.reason(lowering))
    return replace(general.generic_modal(body, gravity), choice=found.reason(lowering))


def parameters(body: ModalBody, spec: SymbolicBody) -> NDArray[np.float64]:
    """The parameters p with which the model of `spec` is this body; gravity at its defaults.

    Raises ValueError when the body has not as many modes, or an integral that the model takes to vanish.
    """
    if body.modes != spec.modes:
        raise ValueError(f"{spec.name} has {spec.modes} modes and {body.name} {body.modes}")
    return general.parameters(body, general.symbolic_tables(spec), spec.gravity)


def lower(equations: Equations | GenericEquations) -> Model:
    """The kernels of a model: straight lines, or loops where the equations are those of a generic shape."""
    if isinstance(equations, GenericEquations):
        from derive.lowering.loops.functions import lower_tables

        return lower_tables(equations)
    return flat.lower(equations)
