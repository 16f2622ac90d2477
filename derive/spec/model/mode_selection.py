"""The wish for as many modes as represent a body well enough, in place of their number."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from derive.short_text import record_text
from derive.spec.model.documentation import documented
from derive.spec.model.keys import KeyType, key


@documented
@dataclass(frozen=True)
class ModeSelection:
    """As few modes as keep the natural frequencies and the static deflections of a body within an error.

    The frequencies are those of the free body up to a limit, by the full matrices. The deflections are those of the
    markers of the interface, if there is one, under unit forces and moments there, balanced by inertia forces.

    Examples:
        >>> import derive
        >>> derive.ModeSelection(error=0.01, up_to=500.0).up_to
        500.0
    """

    error: Annotated[
        float,
        key(
            KeyType.TOLERANCE,
            "The largest relative error of these frequencies and deflections, such as 0.01.",
            example="0.01",
        ),
    ]
    up_to: Annotated[
        float,
        key(KeyType.POSITIVE_FLOAT, "The frequency up to which the body is represented, Hz.", example="500"),
    ]
    __repr__ = record_text
