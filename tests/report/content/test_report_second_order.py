"""Reports of beams of second order: they say what is beyond the paper, and define every symbol of it."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from functools import cache
from typing import Any

import pytest

import beams
import derive
from derive.mechanics.symbols import Family, identity
from derive.pipeline import generate
from derive.report.document.formula import Name
from derive.report.document.page import Details, Heading, Page
from derive.report.model_page import model_page
from derive.report.notation.expressions import notation
from derive.report.notation.families import written
from derive.report.notation.spoken_math import words
from derive.report.scene_page import scene_page
from derive.report.sections.files import SpecificationText
from derive.roles import Source

FULL = {"order": 2, "terms": "full"}


def rod(x: float, **more: Any) -> dict[str, Any]:
    made = {
        "mass": 1,
        "length": 1,
        "bending_stiffness": 1,
        "frame": "chord",
        "ansatz": ["1", "xi", "xi^2"],
        "start": {"position": [x, 0]},
    }
    return made | {"markers": {"left": -1, "right": 1}} | more


@cache
def built(name: str) -> tuple[Any, Page]:
    match name:
        case "truncated" | "full":
            spec: Any = beams.beam("chord", 1 + (name == "truncated"), order=2, terms=name)
        case "both":
            joints = {"pin": {"kind": "revolute", "between": ["one.right", "two.left"]}}
            spec = derive.scene(name, bodies={"one": rod(0, order=2), "two": rod(1, **FULL)}, joints=joints)
        case _:
            spec = derive.scene(name, bodies={"one": rod(0)})
    made = generate(spec)
    page = scene_page if made.model.kkt else model_page
    return made.equations, page(made, SpecificationText("the specification", "name = 1"))


def names(part: Any) -> Iterator[Name]:
    """The symbols in a part of a page or of a formula."""
    if isinstance(part, Name):
        yield part
    elif dataclasses.is_dataclass(part):
        for field in dataclasses.fields(part):
            yield from names(getattr(part, field.name))
    elif isinstance(part, tuple):
        for item in part:
            yield from names(item)


def key(name: Name) -> tuple[str, int, str]:
    """The key of a name: its letter and dots, and what distinguishes c_9 from c_10, and beta_p from its derivatives."""
    below = name.below[0] if name.below else ""
    if name.text in ("c", "d", "C", "D"):
        return name.text, 0, below.split(",")[0]
    return name.text, name.dots if name.text == "beta" else 0, "," * (name.text == "beta" and "," in below)


def nomenclature(page: Page) -> set[tuple[str, int, str]]:
    at = next(i for i, b in enumerate(page.blocks) if isinstance(b, Heading) and b.anchor == "nomenclature")
    (folded,) = (block for block in page.blocks[at : at + 4] if isinstance(block, Details))
    return {key(name) for row in folded.blocks[0].rows for name in names(row[0])}


@pytest.mark.parametrize("name", ["truncated", "full", "both"])
def test_every_symbol_of_second_order_is_in_the_nomenclature(name: str) -> None:
    equations, page = built(name)
    items = (*equations.coefficients, *equations.definitions)
    symbols = {item.symbol for item in items if item.equation == Source.SECOND_ORDER and not item.zero}
    assert {identity(symbol).family for symbol in symbols} >= {Family.POINT_SECOND}
    used = {key(found) for symbol in symbols for found in names(written(symbol).formula)}
    rates = {(letter, 1, "") for letter in ("beta",)}  # a dot is a time derivative
    assert used - nomenclature(page) - rates == set()
    assert ("beta", 2, "") in used or name == "truncated"


@pytest.mark.parametrize("name", ["truncated", "full", "both"])
def test_what_is_beyond_the_paper_is_said(name: str) -> None:
    text = repr(built(name)[1])
    assert "Beyond the paper: the displacement" in text
    assert "displacements of both ends along the axis are opposite" in text
    kept = {"truncated": ["The model is truncated"], "full": ["The model is full"]}
    both = ["The model of one is truncated", "The model of two is full", "the displacement of one, two is"]
    assert all(words in text for words in kept.get(name, both))


def test_a_scene_of_first_order_says_nothing_of_it() -> None:
    _, page = built("first")
    assert "Beyond the paper: the displacement" not in repr(page)
    assert not {"Psi", "beta", "theta"} & {letter for letter, _, _ in nomenclature(page)}


def test_the_second_derivative_of_a_moment_is_no_product_with_accelerations_alone() -> None:
    """d1ddot = sum (alphaddot_i d4_i + alphadot_i c9dot_i) along the axis; at first order it is alphaddot^T c2."""
    product, name = "open bracket alpha double dot super T c sub 2 {} close bracket", "d double dot sub 1 1"
    for order, expected in ((1, {product.format(2)}), (2, {product.format(2), name})):
        equations = derive.derive(beams.beam("chord", 2, order=order))
        written_as = notation(equations)
        sums = {words(written_as.formula(s.symbol)) for s in equations.mode_sums}
        assert expected <= sums and product.format(1) not in sums
        assert (name in sums) is (order == 2)
