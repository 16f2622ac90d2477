"""Nodes in messages: their numbers in the program, of which the first are listed."""

from __future__ import annotations

from derive.fem.model import Indices

LISTED = 8


def node_list(numbers: Indices) -> str:
    """The first numbers, and how many more there are."""
    first = ", ".join(str(number) for number in numbers[:LISTED].tolist())
    return first if len(numbers) <= LISTED else f"{first} and {len(numbers) - LISTED} more"
