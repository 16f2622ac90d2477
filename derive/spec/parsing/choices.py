"""The values of a specification that are one of several words."""

from __future__ import annotations

from typing import TypeVar, get_args

from derive.errors import quoted
from derive.spec.model.beam_parts import FrameKind
from derive.spec.model.body import BodyFrameKind
from derive.spec.parsing.faults import similar_name
from derive.spec.parsing.values import WrongValueError, kind_of

FRAME_KINDS: tuple[FrameKind, ...] = get_args(FrameKind)
BODY_FRAME_KINDS: tuple[BodyFrameKind, ...] = get_args(BodyFrameKind)

_Text = TypeVar("_Text", bound=str)


def choice(value: object, options: tuple[_Text, ...], noun: str) -> _Text:
    """The option that a value is. Raises WrongValueError with all options and the one that resembles the value."""
    for option in options:
        if isinstance(value, str) and value == option:
            return option
    words = ", ".join(quoted(option) for option in options)
    given = quoted(value) + similar_name(value, options, "") if isinstance(value, str) else kind_of(value)
    raise WrongValueError(f"{noun} is one of {words}, not {given}")


def frame_kind(value: object) -> FrameKind:
    """The kind of the frame of a beam."""
    return choice(value, FRAME_KINDS, "the frame")


def body_frame_kind(value: object) -> BodyFrameKind:
    """The kind of the frame of a body of nodes."""
    return choice(value, BODY_FRAME_KINDS, "the frame")
