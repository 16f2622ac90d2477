"""Numbers as exact numbers in quotation marks, here and there, wherever the schema accepts them."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

from corpus.draws import Draws
from corpus.features import Schema, children, fits

SHARE = 0.4
"""The share of the numbers of a scene that are written so, if some are."""


def respell(tables: dict[str, Any], root: Schema, draws: Draws, probability: float) -> None:
    """With that probability, write some numbers of a specification as text, such as "7/20" for 0.35."""
    chosen = draws.chance(probability)
    for container, key in [*_numbers(tables, root, root)] if chosen else []:
        if draws.chance(SHARE) and not isinstance(container[key], str):  # two forms of a value may both be numbers
            container[key] = str(Fraction(repr(container[key])))


def _numbers(value: Any, schema: Any, root: Schema) -> Iterator[tuple[Any, Any]]:
    """The places of numbers that may be texts as well: a table or a list, and the key or the index in it."""
    for key, inner in children(value, schema, root):
        item = value[key]
        if isinstance(item, (int, float)) and not isinstance(item, bool) and fits("1/3", inner, root):
            yield value, key
        yield from _numbers(item, inner, root)
