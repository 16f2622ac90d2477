"""A page as PDF: whole, the same each time, of text that is never markup."""

# ruff: noqa: RUF001 - letters are what is tested

from __future__ import annotations

import builtins
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sample_report
from sample_report import EVERYTHING, EVIL, PHI, row, square

from derive.artifacts import MARK
from derive.report.document.formula import (
    Call,
    Fenced,
    Formula,
    Matrix,
    Name,
    NumberToken,
    OperatorToken,
    Part,
    Quotient,
)
from derive.report.document.page import Page, Paragraph, Picture
from derive.report.writers.typst import TypstMissing, pdf, typst
from derive.report.writers.typst_math import string, summand_typst, typst_math
from derive.visual.line_chart import Chart, Curve, Panel, svg


def text_of(data: bytes, folder: Path) -> str:
    """The text of a PDF, or of what made it where there is no reader."""
    (folder / "a.pdf").write_bytes(data)
    return subprocess.run(
        ["pdftotext", "-layout", folder / "a.pdf", "-"], capture_output=True, text=True, check=True
    ).stdout


def test_it_is_made_and_the_same_each_time() -> None:
    pytest.importorskip("typst")
    data = pdf(sample_report.page(8))
    assert data.startswith(b"%PDF-") and MARK.encode() in data and len(data) < 400_000
    code = (
        "import sample_report as s, sys; from derive.report.writers.typst import pdf; "
        "sys.stdout.buffer.write(pdf(s.page(8)))"
    )
    env = {"PYTHONHASHSEED": "7", "PYTHONPATH": f"{Path(__file__).parents[3]}:.", "TZ": "Asia/Tokyo", "HOME": "/"}
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=Path(__file__).parent, env=env, capture_output=True, check=True
    )
    assert done.stdout == data


@pytest.mark.skipif(shutil.which("pdftotext") is None, reason="there is no pdftotext here")
def test_what_it_says(tmp_path: Path) -> None:
    pytest.importorskip("typst")
    said = " ".join(text_of(pdf(sample_report.page()), tmp_path).split())
    for word in (
        "Kinematics",
        "(33)",
        "accelerations",
        "Nothing is left out.",
        "int free_beam_mass(",
        "What was given:",
    ):
        assert word in said, word
    assert "#set $x$ `q` | _a_ *b* 100% {c}" in said


@pytest.mark.skipif(shutil.which("pdftotext") is None, reason="there is no pdftotext here")
def test_pictures_have_their_font_and_are_on_one_page_with_their_captions(tmp_path: Path) -> None:
    """Wherever a page ends, and if a chart, here with a panel for each of seven units, is higher than a page."""
    pytest.importorskip("typst")
    x = np.linspace(0, 1, 5)
    panels = tuple(Panel("deflection / 0.4 m", f"unit {n}", (Curve("", x, 1e-4 * x),)) for n in range(7))
    high, low = (Picture(svg(Chart("a title", "time", "s", some)), "", "a caption") for some in (panels, panels[:1]))
    texts = (Paragraph(("A sentence that is above a picture. " * (5 * n + 2),)) for n in range(12))
    data = pdf(Page("title", (), (high, *(block for text in texts for block in (text, low)))))
    assert b"DejaVuSans" in data.replace(b"DejaVuSansMono", b"")
    pages = text_of(data, tmp_path).split("\f")
    for shown in pages:
        assert shown.count("a title") == shown.count("time, s") == shown.count("a caption")
    assert sum(shown.count("a caption") for shown in pages) == 13
    assert any(all(f"unit {n}" in shown for n in range(7)) for shown in pages)


def test_strings() -> None:
    assert string('a"b\\c') == '"a\\"b\\\\c"' and string("a\nb") == '"a b"'
    made = typst(sample_report.page())
    assert string(EVIL) in made and EVIL not in re.sub(r'"(\\.|[^"\\])*"', '""', made)


@pytest.mark.parametrize(
    ("formula", "shown"),
    [
        (Name("alpha", 2, ("1",)), "attach(dot.double(α), b: 1)"),
        (Name("omega", style="vector"), "bold(italic(ω))"),
        (Name("J", style="tensor"), "bold(upright(J))"),
        (Name("Phi"), "italic(Φ)"),
        (Name("EI"), 'italic("EI")'),
        (Name("max", style="word"), 'upright("max")'),
        (Name("$x"), 'italic("$x")'),
        (OperatorToken("#"), '"#"'),
        (row(NumberToken("2"), NumberToken("3")), "2 dot.op 3"),
        (square(Name("c", below=("1",))), "attach(c, b: 1, t: 2)"),
        (square(Call("sin", PHI)), 'attach(op("sin"), t: 2) φ'),
        (Fenced(Quotient(Name("a"), Name("b")), "{", "}"), "lr(brace.l frac(a, b) brace.r)"),
        (Matrix(((Name("a"), None),)), 'mat(delim: "[", a, dot.op)'),
        (NumberToken("-1"), '"\u22121"'),
    ],
)
def test_formulas(formula: Formula, shown: str) -> None:
    assert typst_math(formula) == shown


def test_signs() -> None:
    assert summand_typst(Part("-", Name("a")), True) == 'class("unary", minus) a'
    assert summand_typst(Part("+", Name("a")), False) == 'zws class("binary", +) a'


def test_every_formula_is_taken(tmp_path: Path) -> None:
    wheel = pytest.importorskip("typst")
    odd = [OperatorToken(c) for c in "#$\\\"'`@_^&/:;,!?~%*()[]{}|<>=+-"] + [Name(c) for c in "#$\\\"'`@_^&/"]
    body = " ".join(f"${typst_math(one)}$" for one in [*odd, EVERYTHING, Call("#", PHI), NumberToken("#")])
    assert wheel.compile(body.encode(), format="pdf", ignore_system_fonts=True).startswith(b"%PDF")


def test_a_missing_wheel_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def without(name: str, *others: Any) -> Any:
        if name == "typst":
            raise ImportError(name)
        return real(name, *others)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(TypstMissing, match=r"pip install 'tisserand\[report\]'"):
        pdf(sample_report.page())
