"""The notes on a model, gathered for the commands that print them and for the interfaces to other programs."""

from __future__ import annotations

from derive.ir.model import Model
from derive.notes.body_notes import body_notes
from derive.notes.conditioning import condition_warnings
from derive.notes.scene_notes import scene_notes
from derive.notes.spin_limit import spin_notes
from derive.spec.model.body import NodalBody
from derive.spec.model.scene import Scene, Specification


def limits(spec: Specification) -> tuple[str, ...]:
    """The notes on where a model ceases to be valid, and on bodies that nothing connects with the ground."""
    of_scene = scene_notes(spec) if isinstance(spec, Scene) else ()
    return (*spin_notes(spec), *of_scene, *(f"warning: {text}" for text in condition_warnings(spec)))


def build_notes(spec: Specification, model: Model) -> tuple[str, ...]:
    """The notes on a model that has been built: lowering, bodies and elimination, and its limits."""
    of_body = body_notes(spec) if isinstance(spec, NodalBody) else ()
    return (*((model.choice,) if model.choice else ()), *of_body, *_elimination(model), *limits(spec))


def _elimination(model: Model) -> tuple[str, ...]:
    """Return which coordinates of a scene are eliminated and why, and the size of its KKT matrix."""
    if model.kkt is None:
        return ()
    size, entries = model.kkt.pattern.rows, model.kkt.pattern.full_nnz
    solving = (
        f"KKT matrix: {size} x {size}, {entries} non-zeros, fill-in of {model.kkt.fill}; accelerations and multipliers "
        f"take {model.kernel('solve').operations} operations"
    )
    return (*(f"eliminated: {out.what}: {out.reason}" for out in model.eliminated), solving)
