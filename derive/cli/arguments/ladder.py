"""The options of the studies that go through a ladder of models. Only light modules are imported here."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from derive.cli.arguments.types import among, count, pieces
from derive.study.study_options import COMPONENT_MODES, FRAMES, MAX_MODES, MAX_SHAPES, MODES, ORDERS, LadderRange


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


def add_spatial_ladder(command: argparse.ArgumentParser, default: LadderRange) -> None:
    """Add the options for what flexible bodies have in space alone: torsion, and component modes."""
    command.add_argument(
        "--torsion",
        type=twists,
        default=default.torsion,
        metavar="N,...",
        help="shapes of torsion of one beam in space (default: as in the scene)",
    )
    command.add_argument(
        "--component-modes",
        type=component_modes,
        default=default.component_modes,
        metavar="A,...",
        help=f"modes of finite-element bodies, among {', '.join(COMPONENT_MODES)} "
        f"(default: {joined(default.component_modes)})",
    )
    command.add_argument(
        "--component-counts",
        type=counts,
        default=default.component_counts,
        metavar="N,...",
        help="numbers of free modes, or of modes beside the static ones of the interface "
        f"(default: {joined(default.component_counts)})",
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


def component_modes(text: str) -> tuple[str, ...]:
    """Modes of finite-element bodies by their names."""
    return among(text, COMPONENT_MODES)


def shapes(text: str) -> tuple[int, ...]:
    """Numbers of shape functions."""
    return _numbers(text, MAX_SHAPES, "shapes")


def twists(text: str) -> tuple[int, ...]:
    """Numbers of shapes of torsion, among which none may be."""
    return tuple(dict.fromkeys(n for part in text.split(",") for n in ((0,) if part == "0" else shapes(part))))


def counts(text: str) -> tuple[int, ...]:
    """Numbers of modes of finite-element bodies."""
    return _numbers(text, MAX_MODES, "modes")


def _numbers(text: str, most: int, noun: str) -> tuple[int, ...]:
    numbers = tuple(dict.fromkeys(count(part) for part in text.split(",")))
    if max(numbers) > most:
        raise argparse.ArgumentTypeError(f"a ladder has at most {most} {noun}, not {max(numbers)}")
    return numbers
