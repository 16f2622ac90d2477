"""The notes that `tisserand build` prints on a model: its lowering, its body, what is eliminated, limits, warnings."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from derive.ir.model import Model
from derive.notes.body_notes import body_notes
from derive.notes.model_notes import limits
from derive.pipeline import Built
from derive.spec.model.body import NodalBody
from derive.spec.toml.read import warnings


def build_notes(built: Built, path: Path) -> tuple[str, ...]:
    """The notes on the model of the specification in the file `path`, with the warnings on that file."""
    spec, model = built.spec, built.model
    return (
        *((model.choice,) if model.choice else ()),
        *(body_notes(spec) if isinstance(spec, NodalBody) else ()),
        *_elimination(model),
        *limits(spec),
        *(f"warning: {text}" for text in (*((built.unstarted,) if built.unstarted else ()), *warnings(path))),
    )


def _elimination(model: Model) -> Iterator[str]:
    """Yield which coordinates of a scene are eliminated and why, and the size of its KKT matrix."""
    if model.kkt is None:
        return
    for out in model.eliminated:
        yield f"eliminated: {out.what}: {out.reason}"
    size, entries = model.kkt.pattern.rows, model.kkt.pattern.full_nnz
    yield (
        f"KKT matrix: {size} x {size}, {entries} non-zeros, fill-in of {model.kkt.fill}; accelerations and multipliers "
        f"take {model.kernel('solve').operations} operations"
    )
