"""Texts that may be broken into lines: they carry the positions of their breaks as data."""

from __future__ import annotations

from dataclasses import dataclass

from derive.backends.comment_text import WIDTH


@dataclass(frozen=True)
class BreakableText:
    """A text that may be broken into lines before each of its pieces but the first."""

    pieces: tuple[str, ...]

    def __str__(self) -> str:
        return "".join(self.pieces)

    def __len__(self) -> int:
        return sum(map(len, self.pieces))


PLUS = BreakableText(("", " + "))
"""A plus before which a line may be broken."""


def join(*parts: str | BreakableText) -> BreakableText:
    """Texts one after the other; they can be broken where their parts can."""
    pieces = [""]
    for part in parts:
        first, *rest = part.pieces if isinstance(part, BreakableText) else (part,)
        pieces[-1] += first
        pieces += rest
    return BreakableText(tuple(pieces))


def statement(indent: str, head: str, expression: BreakableText, end: str) -> list[str]:
    """`head expression end` on as many lines as it needs, broken before a plus or a minus."""
    lines, current = [], f"{indent}{head}"
    for piece in join(expression, end).pieces:
        if len(current) + len(piece) > WIDTH and current.strip():
            lines.append(current.rstrip())
            current = f"{indent}    {piece.lstrip()}"
        else:
            current += piece
    return [*lines, current]
