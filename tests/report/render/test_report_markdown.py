"""A page as Markdown: formulas between dollars, tables, code; text stays text."""

from __future__ import annotations

import re

import sample_report
from sample_report import EVERYTHING, EVIL, row

from derive.artifacts import MARK
from derive.report.document.formula import Fenced, Matrix, Name, NumberToken
from derive.report.document.page import Cell, CodeLine, CodeSpan, Hyperlink, Listing, Math, Page, Paragraph, TableBlock
from derive.report.writers.markdown import markdown, math, picture_files, plain, text


def of(*blocks: object) -> Page:
    return Page("t", (), blocks)  # type: ignore[arg-type]


def test_the_page() -> None:
    shown = markdown(sample_report.page())
    assert shown.startswith(f"<!-- {MARK} -->\n\n# The free beam in the mean frame\n")
    assert shown.count("```math\n\\begin{align}\n") == shown.count("\\end{align}\n```") == 5
    assert "| --- | ---: | ---: | --- |" in shown and "\\tag{33}" in shown and "```c\n/* M (15)" in shown
    assert "<details><summary>The specification</summary>\n\nWhat was given:" in shown
    assert "\\begin{align}\n\\delta \\varphi &\\colon\\quad" in shown and "\\label" not in shown
    assert '<a id="row-phi"></a><a id="phi-1"></a>\n\n```math' in shown


def test_pictures_are_words_or_files() -> None:
    page = sample_report.page()
    assert "> A square &amp; a dot" in markdown(page)
    assert "![A square &amp; a dot](free_beam/picture-1.svg)" in markdown(page, "free_beam")
    assert [name for name, _ in picture_files(page)] == ["picture-1.svg", "picture-2.svg"]
    assert all(svg.startswith("<svg xmlns") for _, svg in picture_files(page))


def test_text_is_never_markup() -> None:
    shown = plain(EVIL)
    assert "<" not in shown and ">" not in shown and not re.search(r"(?<!\\)[`*_\[\]$|#]", shown)
    assert text(("- a",)) == "\\- a" and text(("1. a",)) == "1\u200b. a" and text(("12",)) == "12"
    assert text((Hyperlink("a]b", "http://x/<y>"),)) == "[a\\]b](<http://x/%3Cy%3E>)"
    table = of(TableBlock("", (("a|b",),), ((Cell((CodeSpan("a|b"), "\n")),),)))
    assert "| a\\|b |\n| --- |\n| `a\\|b`  |" in markdown(table)


def test_code_spans() -> None:
    assert (
        text((CodeSpan("a"),)) == "`a`"
        and text((CodeSpan("a`b"),)) == "``a`b``"
        and text((CodeSpan("`"),)) == "`` ` ``"
    )


def test_formulas_within_text_have_no_marks_of_markdown() -> None:
    for formula in (
        EVERYTHING,
        Fenced(row(Name("EI"), Name("x")), "{", "}"),
        Matrix(((Name("a"),), (NumberToken("1"),))),
    ):
        shown = math(formula)
        assert not re.search(r"\\[^A-Za-z]|[<>|*`$]", shown), shown
    assert text((Math(Name("alpha", 1, ("1",))),)) == "$\\dot{\\alpha}_{1}$"
    assert math(Name("<b>", style="word")) == "\\text{?b?}"


def test_fences_are_longer_than_what_is_in_them() -> None:
    lines = (CodeLine(1, "```"), CodeLine(2, "a"), CodeLine(9, "b"))
    shown = markdown(of(Listing("text", "", lines), Paragraph(("c",))))
    assert shown.endswith("````text\n```\na\n````\n\n````text\nb\n````\n\nc\n")
