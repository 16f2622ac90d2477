"""`derive` and `lower`: the two stages that depend on what is specified.

A specification is a beam, a body of nodes, a body with parameters, or a scene. The equations of a body keep their sums
over the shapes; `lower` decides whether they are unrolled or become loops, see `derive.lowering.cost_model`, unless
the specification says it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from derive.errors import Problem, SpecError
from derive.ir.model import Model
from derive.lowering import cost_model
from derive.lowering.flat.lower import lower as lower_flat
from derive.lowering.loops.functions import lower_tables
from derive.mechanics import indexed_equations
from derive.mechanics.bodies import beam
from derive.mechanics.bodies.modal_body import ModalBody
from derive.mechanics.bodies.spatial_body import modal_body, parametric_body, symbolic_tables
from derive.mechanics.bodies.spatial_body import parameters as parameters_of
from derive.mechanics.equations import Equations
from derive.mechanics.multibody import assembly
from derive.mechanics.multibody.mechanism import Mechanism
from derive.reduction import reduce
from derive.spec.model.body import Gravity, Lowering, NodalBody, PlanarBeam, SymbolicBody
from derive.spec.model.scene import Scene, Specification


def derive(spec: Specification) -> Equations | Mechanism:
    """The equations of motion of a body, or the mechanism that a scene describes. Raises SpecError.

    Both have `expanded()`, which writes out the sums over the shapes, and the equations of every instance of a body.
    """
    match spec:
        case PlanarBeam():
            return beam.derive(spec)
        case Scene():
            return assembly.mechanism(spec)
        case SymbolicBody():
            return indexed_equations.derive_body(parametric_body(spec), spec.lowering)
        case NodalBody():
            return derive_modal(modal(spec), spec.gravity, spec.lowering)


def modal(spec: NodalBody) -> ModalBody:
    """The shape integrals of a body of nodes, in its frame. Raises SpecError with all that is wrong."""
    return reduce(spec)


def derive_modal(body: ModalBody, gravity: Gravity | None = None, lowering: Lowering = "auto") -> Equations:
    """The equations of motion of a body given by its shape integrals."""
    return indexed_equations.derive_body(modal_body(body, gravity), lowering)


def parameters(body: ModalBody, spec: SymbolicBody) -> NDArray[np.float64]:
    """The parameters p with which the model of `spec` is this body; gravity at its defaults.

    Raises ValueError when the body has not as many modes, or an integral that the model takes to vanish.
    """
    if body.modes != spec.modes:
        raise ValueError(f"{spec.name} has {spec.modes} modes and {body.name} {body.modes}")
    return parameters_of(body, symbolic_tables(spec), spec.gravity)


def lower(derived: Equations | Mechanism) -> Model:
    """The kernels of a model: straight-line code, or loops over the shapes of a body in space, whichever is faster.

    Raises SpecError when the specification asks for straight-line code that would be too long.
    """
    if isinstance(derived, Mechanism) or derived.body is None or not derived.indexed or derived.body.dimension == 2:
        return lower_flat(derived.expanded())
    estimate = cost_model.choose(derived.body)
    try:
        flat = estimate.taken(derived.lowering) == "flat"
    except cost_model.CodeTooLong as error:
        raise SpecError((Problem("body.lowering", str(error)),)) from None
    reason = estimate.reason(derived.lowering)
    return lower_flat(derived.expanded(), reason) if flat else lower_tables(derived, reason)


def lowered_form(derived: Equations | Mechanism, model: Model) -> Equations:
    """The form of the equations that a model was lowered from: with its sums, or written out."""
    if isinstance(derived, Equations) and model.lowering == "table":
        return derived
    return derived.expanded()
