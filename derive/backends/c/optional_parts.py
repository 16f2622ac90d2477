"""The parts of the C of a model that a compilation leaves out where a macro is defined."""

from __future__ import annotations

from enum import Enum

REDUCED_FORMS = {"ggl": "_ggl", "index1": "_index1"}
"""The forms of the equations of a scene whose index is reduced, with the suffixes of the names of their functions."""


class OptionalPart(Enum):
    """A part that a host may do without; the value is the macro that leaves it out.

    What is left out is missing from the descriptor: batches are null pointers, `forms` of a scene has index 3 alone.
    """

    BATCHES = "TISSERAND_WITHOUT_BATCHES"
    REDUCED_FORMS = "TISSERAND_WITHOUT_REDUCED_FORMS"


def optional_part(name: str) -> OptionalPart | None:
    """The part that the function of this name, without that of the model, belongs to."""
    parts = {f"{kind}{suffix}" for kind in ("residual", "jacobian") for suffix in REDUCED_FORMS.values()}
    return OptionalPart.REDUCED_FORMS if name in parts else None
