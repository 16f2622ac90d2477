"""The options of the studies that go through a ladder of models. Only light modules are imported here."""

from __future__ import annotations

import argparse
import difflib
from collections.abc import Sequence

from derive.cli.arguments.types import count, pieces
from derive.study.study_options import FRAMES, MAX_SHAPES, MODES, ORDERS, LadderRange


def add_ladder(command: argparse.ArgumentParser, default: LadderRange) -> None:
    """Add the options for the orders, the frames and the shapes of a ladder, with these defaults."""
    command.add_argument(
        "--orders",
        type=orders,
        default=default.orders,
        metavar="A,...",
        help=f"orders of the displacements among {', '.join(ORDERS)} (default: {joined(default.orders)})",
    )
    command.add_argument(
        "--frames",
        type=frames_of_ladder,
        default=default.frames,
        metavar="A,...",
        help=f"frames of polynomials among {', '.join(FRAMES)} (default: {joined(default.frames)})",
    )
    command.add_argument(
        "--shapes",
        type=shapes,
        default=default.shapes,
        metavar="N,...",
        help=f"polynomials of one beam (default: {joined(default.shapes)})",
    )
    command.add_argument(
        "--pieces",
        type=pieces,
        default=default.pieces,
        metavar="N,...",
        help=f"numbers of beams with P2, P3 (default: {joined(default.pieces)})",
    )
    command.add_argument(
        "--sines",
        type=shapes,
        default=default.sines,
        metavar="N,...",
        help=f"half sine waves of one beam (default: {joined(default.sines)})",
    )
    command.add_argument(
        "--modes",
        type=modes,
        default=default.modes,
        metavar="A,...",
        help=f"other natural modes of one beam in the same numbers, among {' and '.join(MODES)} "
        f"(default: {joined(default.modes)})",
    )


def joined(values: Sequence[object]) -> str:
    """Default values as they are written in a command."""
    return ",".join(map(str, values)) or "none"


def orders(text: str) -> tuple[str, ...]:
    """Orders of displacements by their names."""
    return among(text, ORDERS)


def frames_of_ladder(text: str) -> tuple[str, ...]:
    """Frames of beams by their names."""
    return among(text, FRAMES)


def modes(text: str) -> tuple[str, ...]:
    """Natural modes of beams by their names."""
    return among(text, MODES)


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
