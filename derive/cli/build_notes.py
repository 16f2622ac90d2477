"""The notes that `tisserand build` prints on a model: its lowering, its body, what is eliminated, limits, warnings."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from derive.ir.model import Model
from derive.lowering.mechanism_costs import estimate_mechanism_costs
from derive.mechanics.multibody.mechanism import Mechanism
from derive.mechanics.multibody.space.mechanism import SpatialMechanism
from derive.notes.body_notes import body_notes, notes_on_flexible_bodies
from derive.notes.model_notes import limits
from derive.notes.requested_notes import requested_notes
from derive.pipeline import Built
from derive.report.sections.instance_rows import merged_rows
from derive.spec.model.body import NodalBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.toml.read import warnings


def build_notes(built: Built, path: Path) -> tuple[str, ...]:
    """The notes on the model of the specification in the file `path`, with the warnings on that file."""
    spec, model = built.spec, built.model
    return (
        *_lowering(built),
        *(body_notes(spec) if isinstance(spec, NodalBody) else ()),
        *(notes_on_flexible_bodies(spec) if isinstance(spec, SpatialScene) else ()),
        *_elimination(model),
        *requested_notes(model),
        *_functions_of_controllers(built),
        *limits(spec),
        *(f"warning: {text}" for text in (*((built.unstarted,) if built.unstarted else ()), *warnings(path))),
    )


def _lowering(built: Built) -> Iterator[str]:
    """Yield the reason for the lowering; the files of scenes in straight-line code do not contain it."""
    model, derived = built.model, built.derived
    if model.choice:
        yield model.choice
    elif isinstance(derived, Mechanism):
        costs = estimate_mechanism_costs(derived)
        if costs.lowering == model.lowering:
            yield costs.reason(derived.scene.lowering)


def _elimination(model: Model) -> Iterator[str]:
    """Yield which coordinates of a scene are eliminated and why, and the size of its KKT matrix."""
    for what, reason in merged_rows([(out.what, out.reason) for out in model.eliminated]):
        yield f"{what}: {reason}"
    if model.kkt is None:
        return
    size, entries = model.kkt.pattern.rows, model.kkt.pattern.full_nnz
    yield (
        f"KKT matrix: {size} x {size}, {entries} non-zeros, fill-in of {model.kkt.fill}; accelerations and multipliers "
        f"take {model.kernel('solve').operations} operations"
    )


def _functions_of_controllers(built: Built) -> Iterator[str]:
    """Yield how trees in relative coordinates, such as robots, get inverse dynamics, if they have no such functions."""
    bodies = built.derived.instances if isinstance(built.derived, SpatialMechanism) else ()
    if any(of.coordinates.is_carried for of in bodies) and not built.model.requested:
        yield "without inverse dynamics, which controllers need: --functions inverse_dynamics or all adds them"
