"""The two arrows that depend on what is specified: a beam, a body of nodes, or a body with parameters.

A body in space has two lowerings. Which one is taken follows from the counts of its non-zeros, see `choice`, unless the
specification says it.
"""

from __future__ import annotations

from derive.kernel import choice
from derive.kernel import lower as flat
from derive.kernel.model import Model
from derive.mechanics import beam, general
from derive.mechanics.equations import Equations
from derive.mechanics.generic import GenericEquations
from derive.mechanics.modal import ModalBody
from derive.spec.body import Gravity, Lowering, NodalBody, PlanarBeam, Specification, SymbolicBody


def derive(spec: Specification) -> Equations | GenericEquations:
    """The equations of motion of what is specified, written out or for a generic shape. Raises SpecError."""
    if isinstance(spec, PlanarBeam):
        return beam.derive(spec)
    if isinstance(spec, SymbolicBody):
        tables = general.symbolic_tables(spec)
        taken = _lowering(spec.lowering, choice.choose(tables, general.present_symbolic(spec), spec.modes))
        return general.derive_symbolic(spec) if taken == "flat" else general.generic_symbolic(spec)
    return derive_modal(modal(spec), spec.gravity, spec.lowering)


def modal(spec: NodalBody) -> ModalBody:
    """The shape integrals of a body of nodes, in its frame. Raises SpecError with all that is wrong."""
    from derive.reduction import reduce

    return reduce(spec)


def derive_modal(
    body: ModalBody, gravity: Gravity | None = None, lowering: Lowering = "auto"
) -> Equations | GenericEquations:
    """The equations of motion of a body given by its shape integrals."""
    tables = general.modal_tables(body)
    taken = _lowering(lowering, choice.choose(tables, general.present_modal(body), body.modes))
    return general.derive_modal(body, gravity) if taken == "flat" else general.generic_modal(body, gravity)


def _lowering(asked: Lowering, choice_made: choice.Choice) -> str:
    return choice_made.lowering if asked == "auto" else asked


def lower(equations: Equations | GenericEquations) -> Model:
    """The kernels of a model: straight lines, or loops where the equations are those of a generic shape."""
    if isinstance(equations, GenericEquations):
        from derive.kernel.table import lower_tables

        return lower_tables(equations)
    return flat.lower(equations)
