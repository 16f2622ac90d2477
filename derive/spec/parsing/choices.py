"""The values of a specification that are one of several words."""

from __future__ import annotations

from typing import TypeVar

from derive.errors import quoted
from derive.spec.model.body import BodyFrameKind, Ends, FamilyKind, FrameKind, Lowering, SymbolicFrame
from derive.spec.parsing.faults import did_you_mean
from derive.spec.parsing.values import WrongValueError, kind_of

FRAME_KINDS: tuple[FrameKind, ...] = ("mean", "point", "chord", "tangent", "given")
BODY_FRAME_KINDS: tuple[BodyFrameKind, ...] = ("mean", "point", "given")
ENDS: tuple[Ends, ...] = ("pinned", "free")
FAMILY_KINDS: tuple[FamilyKind, ...] = ("pinned", "free-free", "clamped-free")
SECOND_ORDER_TERMS = ("truncated", "full")
SYMBOLIC_FRAMES: tuple[SymbolicFrame, ...] = ("mean", "given")
LOWERINGS: tuple[Lowering, ...] = ("auto", "flat", "table")

_Text = TypeVar("_Text", bound=str)


def choice(value: object, options: tuple[_Text, ...], noun: str) -> _Text:
    """The option that a value is. Raises WrongValueError with all options and the one that resembles the value."""
    for option in options:
        if isinstance(value, str) and value == option:
            return option
    words = ", ".join(quoted(option) for option in options)
    given = quoted(value) + did_you_mean(value, options) if isinstance(value, str) else kind_of(value)
    raise WrongValueError(f"{noun} is one of {words}, not {given}")


def frame_kind(value: object) -> FrameKind:
    """The kind of the frame of a beam."""
    return choice(value, FRAME_KINDS, "the frame")


def ends(value: object) -> Ends:
    """The conditions on shapes at the ends of a beam."""
    return choice(value, ENDS, "`ends`")


def family_kind(value: object) -> FamilyKind:
    """The family of shape functions."""
    return choice(value, FAMILY_KINDS, "the family")


def second_order_terms(value: object) -> str:
    """The terms that a beam of order 2 keeps."""
    return choice(value, SECOND_ORDER_TERMS, "terms")


def body_frame_kind(value: object) -> BodyFrameKind:
    """The kind of the frame of a body of nodes."""
    return choice(value, BODY_FRAME_KINDS, "the frame")


def symbolic_frame(value: object) -> SymbolicFrame:
    """The kind of the frame of a body whose constants are all parameters."""
    return choice(value, SYMBOLIC_FRAMES, "the frame of a symbolic body")


def lowering(value: object) -> Lowering:
    """The lowering that is specified, such as flat or table."""
    return choice(value, LOWERINGS, "the lowering")
