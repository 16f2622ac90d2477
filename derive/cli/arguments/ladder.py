"""The options of the studies that go through a ladder of models. Only the standard library is imported here."""

from __future__ import annotations

import argparse
import difflib

from derive.cli.arguments.types import count, pieces

MAX_SHAPES = 12
"""The largest number of shape functions in a ladder."""


def add_ladder(
    command: argparse.ArgumentParser, many_shapes: tuple[int, ...] = (2, 3, 4, 6), many_sines: tuple[int, ...] = (1, 2)
) -> None:
    """Add the options for the orders, the frames and the shapes of a ladder, with these numbers of shapes."""
    command.add_argument(
        "--orders",
        type=orders,
        default=("first", "truncated"),
        metavar="A,...",
        help="orders of the displacements among first, truncated, full (default: first,truncated)",
    )
    command.add_argument(
        "--frames",
        type=frames_of_ladder,
        default=("mean",),
        metavar="A,...",
        help="frames of polynomials among mean, chord, point, tangent (default: mean)",
    )
    command.add_argument(
        "--shapes",
        type=shapes,
        default=many_shapes,
        metavar="N,...",
        help=f"polynomials of one beam (default: {','.join(map(str, many_shapes))})",
    )
    command.add_argument(
        "--pieces", type=pieces, default=(2, 3), metavar="N,...", help="numbers of beams with P2, P3 (default: 2,3)"
    )
    command.add_argument(
        "--sines",
        type=shapes,
        default=many_sines,
        metavar="N,...",
        help=f"half sine waves of one beam (default: {','.join(map(str, many_sines))})",
    )
    command.add_argument(
        "--modes",
        type=modes,
        default=(),
        metavar="A,...",
        help="other natural modes of one beam in the same numbers, among free-free and clamped-free (default: none)",
    )


def orders(text: str) -> tuple[str, ...]:
    """Orders of displacements by their names."""
    return among(text, ("first", "truncated", "full"))


def frames_of_ladder(text: str) -> tuple[str, ...]:
    """Frames of beams by their names."""
    return among(text, ("mean", "chord", "point", "tangent"))


def modes(text: str) -> tuple[str, ...]:
    """Natural modes of beams by their names."""
    return among(text, ("free-free", "clamped-free"))


def among(text: str, known: tuple[str, ...]) -> tuple[str, ...]:
    """Names among those that are known."""
    names = tuple(dict.fromkeys(text.split(",")))
    for name in names:
        if name not in known:
            close = difflib.get_close_matches(name, known, n=1)
            hint = f"did you mean {close[0]}?" if close else f"choose from {', '.join(known)}"
            raise argparse.ArgumentTypeError(f"unknown: {name!r}; {hint}")
    return names


def shapes(text: str) -> tuple[int, ...]:
    """Numbers of shape functions."""
    numbers = tuple(dict.fromkeys(count(part) for part in text.split(",")))
    if max(numbers) > MAX_SHAPES:
        raise argparse.ArgumentTypeError(f"a ladder has at most {MAX_SHAPES} shapes, not {max(numbers)}")
    return numbers
