"""The representations of equations and models in notebooks."""

from __future__ import annotations

from html.parser import HTMLParser

import pytest

import beams
import derive


class _Balanced(HTMLParser):
    VOID = ("mspace", "br", "meta", "rect", "circle")

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []

    def handle_starttag(self, tag: str, attrs: object) -> None:
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if tag not in self.VOID:
            assert self.open.pop() == tag


def shown(thing: object) -> str:
    text: str = thing._repr_html_()  # type: ignore[attr-defined]
    reader = _Balanced()
    reader.feed(text)
    assert not reader.open
    return text


@pytest.mark.parametrize("frame", ["mean", "point"])
def test_equations_are_shown_row_by_row(frame: str) -> None:
    equations = beams.made(frame, 2).equations
    text = shown(equations)
    assert text.count("<math") >= sum(1 for _ in equations.rows)
    assert equations.doc.split(",")[0] in text
    assert all(f"{term.name} term, {term.equation}" in text for term in equations.terms)


def test_a_model_is_shown_with_its_pattern_and_its_functions() -> None:
    model = beams.made("mean", 2).model
    text = shown(model)
    assert "<svg" in text
    assert all(f"<code>{kernel.name}</code>" in text for kernel in model.kernels)


def test_equations_of_a_generic_shape_are_shown() -> None:
    spec = derive.symbolic_body("any_body", 8, lowering="loops")
    assert "<mi>i</mi>" in shown(derive.derive(spec))
