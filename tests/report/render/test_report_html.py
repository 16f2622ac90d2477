"""A page as HTML: valid, by itself, escaped, small, the same each time."""

from __future__ import annotations

import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
import sample_report

import strict_html
from derive.artifacts import MARK
from derive.report.document.anchors import faults
from derive.report.document.formula import Name
from derive.report.document.page import Cell, CodeLine, Hyperlink, Listing, Math, Page, Paragraph, Picture, TableBlock
from derive.report.notation.spoken_math import words
from derive.report.writers.equation_html import equations_shown
from derive.report.writers.html import html
from derive.report.writers.latex import latex
from derive.report.writers.listings import comments
from derive.report.writers.markdown import markdown
from derive.report.writers.mathml import math
from derive.report.writers.picture import inline, scoped, standalone
from derive.report.writers.typst import typst

CSS = Path(__file__).parents[3] / "templates" / "report" / "colours.css"


def of(*blocks: object) -> Page:
    return Page("t", (), blocks)  # type: ignore[arg-type]


def test_it_is_valid_and_every_link_leads_somewhere() -> None:
    text = html(sample_report.page())
    page = strict_html.Page(text)
    assert page.faults == []
    assert MARK in text[:1000]
    assert page.count("h1") == page.count("main") == page.count("nav") == 1
    assert page.count("math") > 50 and page.count("table") == 3 and page.count("svg") == 2
    assert '<html lang="en">' in text and 'href="#content"' in text
    assert faults(sample_report.page()) == ()


def test_the_reader_is_strict() -> None:
    assert strict_html.Page("<p><b></p></b>").faults
    assert strict_html.Page('<p id="a"></p><p id="a"></p>').faults == ["id a comes twice"]
    assert strict_html.Page('<a href="#b"></a>').faults == ["nothing has the id of #b"]
    assert strict_html.Page("<p>").faults and strict_html.Page('<p onclick="x"></p>').faults


def test_it_needs_nothing_from_outside() -> None:
    text = html(sample_report.page())
    assert not re.search(r"<script|<link|@import|src=|url\((?!#)", text)
    assert re.findall(r"https?://[^\s\"'<]+", text) == ["https://example.org/?a=1&amp;b=2"]


def test_text_is_never_markup() -> None:
    evil = sample_report.EVIL
    cell = Cell((evil,), evil)
    page = Page(
        evil,
        (evil,),
        (
            Paragraph((evil, Hyperlink(evil, "#a"))),
            TableBlock(evil, ((evil,),), ((cell,),)),
            Listing(evil, evil, (CodeLine(1, evil, "a", (Hyperlink(evil, "#a"),)),)),
            Picture(sample_report.SVG, evil, evil),
        ),
    )
    read = strict_html.Page(html(page))
    assert read.faults == [] and read.count("script") == 0 and read.count("style") == 2
    assert evil in read.text("p") and evil in read.text("caption") and evil in read.text("figcaption")
    assert evil in read.text("title") and evil in read.values("title")


def test_a_page_of_eight_shapes_is_small() -> None:
    text = html(sample_report.page(8))
    assert len(re.sub(r"<svg.*?</svg>", "", text, flags=re.S).encode()) < 80_000


def test_links_and_anchors() -> None:
    text = html(sample_report.page())
    assert 'id="phi-1" href="#line-12" title="J, of X. (15)"' in text
    assert 'id="phi-a1" href="#phi-a1"' in text
    assert re.search(r'id="line-12"[^>]*data-n="12">int .*<a href="#phi-1">\(33\) φ</a>', text)
    with pytest.raises(ValueError, match="javascript"):
        html(of(Paragraph((Hyperlink("x", "javascript:alert(1)"),))))
    dangling = of(
        Paragraph((Hyperlink("x", "#nowhere"),)), Listing("c", "", (CodeLine(1, "", "a"), CodeLine(2, "", "a")))
    )
    assert faults(dangling) == ("the anchor 'a' comes twice", "nothing has the anchor 'nowhere'")


def test_groups_of_a_long_sum_are_told() -> None:
    text = html(sample_report.page(8))
    assert text.count("<small>accelerations</small>") == text.count("<small>rates</small>") == 1
    assert "<small>elastic</small>" not in text


def test_tables() -> None:
    text = html(sample_report.page())
    assert text.count('scope="col"') == 4 + 4 + 16 and text.count('scope="row"') == 9
    assert '<td class="entry r" title="J" tabindex="0">' in text
    assert text.count("<caption>") == 3 and 'class="table wide" role="region"' in text


def test_tables_have_heads_that_are_read_and_scroll_by_keys() -> None:
    phi = Name("φ")
    text = html(of(TableBlock("", ((), ("value",)), ((Cell((Math(phi),)), Cell(("1",))),))))
    assert '<div class="table" role="group" aria-label="Table" tabindex="0">' in text
    assert '<tr><td></td><th scope="col">value</th></tr>' in text
    assert f'<th scope="row" aria-label="{words(phi)}">' in text


def test_comments_of_code() -> None:
    def found(language: str, *text: str) -> list[str]:
        listing = Listing(language, "", tuple(CodeLine(k, line) for k, line in enumerate(text)))
        return [line[a:b] for line, (a, b) in zip(text, comments(listing), strict=True)]

    assert found("c", "a /* b", "c", "d */ e", "f // g", "h") == ["/* b", "c", "d */", "// g", ""]
    assert found("python", 'a = "#" # b', "c") == ["# b", ""]
    assert found("text", "# a // b") == [""]


def test_pictures_keep_to_themselves() -> None:
    svg = inline(sample_report.SVG, "p1", "a & b")
    assert 'id="p1-clip"' in svg and 'clip-path="url(#p1-clip)"' in svg and 'href="#p1-dot"' in svg
    assert "#p1 .value, #p1 .other {" in svg and svg.count("#p1 text {") == 2 and "<title>m, of (15)</title>" in svg
    assert '<title id="p1-title">a &amp; b</title>' in svg and 'role="img"' in svg and "old" not in svg
    assert standalone(sample_report.SVG).startswith('<svg xmlns="http://www.w3.org/2000/svg"')
    assert scoped("a{b:c}@media x{d,e{f:g}}", "#s") == "#s a {b:c} @media x { #s d, #s e {f:g}}"
    for bad in (
        "<script>1</script>",
        '<rect onload="x"/>',
        '<use href="http://a/b#c"/>',
        '<rect fill="url(http://a)"/>',
        "<style>@import 'a';</style>",
        "<foreignObject/>",
        '<use xmlns:x="http://www.w3.org/1999/xlink" x:href="data:a"/>',
    ):
        with pytest.raises(ValueError, match="picture"):
            inline(f'<svg xmlns="http://www.w3.org/2000/svg">{bad}</svg>', "p", "")


def test_equations_by_themselves() -> None:
    text = equations_shown((sample_report.VECTOR,))
    assert strict_html.Page(text).faults == [] and text.startswith("<style>") and 'role="group"' in text
    assert "href" not in text and " id=" not in text
    assert math(sample_report.PHI2).startswith("<math>")


def test_the_same_page_gives_the_same_bytes() -> None:
    """The bytes of a page do not depend on the seed of hashes."""
    code = (
        "import sample_report, sys; from derive.report.writers.html import html; "
        "sys.stdout.write(html(sample_report.page()))"
    )
    made = [
        subprocess.run(
            [sys.executable, "-c", code],
            cwd=Path(__file__).parent,
            env={"PYTHONHASHSEED": seed, "PYTHONPATH": f"{Path(__file__).parents[3]}:.", "PYTHONIOENCODING": "utf-8"},
            capture_output=True,
            check=True,
        ).stdout
        for seed in ("1", "2")
    ]
    assert made[0] == made[1] == html(sample_report.page()).encode()


def test_colours_have_contrast() -> None:
    """4.5 to 1 of each ink on each ground that it stands on, in light and dark."""
    for scheme in CSS.read_text().split("@media"):
        colours = dict(re.findall(r"--(\w+): #(\w+);", scheme))
        for ink in ("ink", "soft", "link", "zero", "good", "bad"):
            for ground in ("page", "faint") if ink != "zero" else ("page",):
                assert _contrast(colours[ink], colours[ground]) >= 4.5, (ink, ground)
        assert _contrast(colours["ink"], colours["entry"]) >= 4.5 <= _contrast(colours["ink"], colours["seen"])


def _contrast(a: str, b: str) -> float:
    bright, dark = sorted((_luminance(a), _luminance(b)), reverse=True)
    return (bright + 0.05) / (dark + 0.05)


def _luminance(colour: str) -> float:
    full = "".join(c * 2 for c in colour) if len(colour) == 3 else colour
    parts = [int(full[k : k + 2], 16) / 255 for k in (0, 2, 4)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
    return sum(c * w for c, w in zip(linear, (0.2126, 0.7152, 0.0722), strict=True))


def test_many_told_cells_are_no_stops_of_the_tab_key() -> None:
    table = sample_report.table()
    rows = tuple(tuple(replace(cell, title="why") for cell in row) for row in table.rows)
    assert html(of(replace(table, rows=rows * 10))).count('title="why" tabindex="0"') == 120
    assert 'title="why" tabindex' not in html(of(replace(table, rows=rows * 20)))


def test_hints_for_the_pointer_are_on_the_screen_alone() -> None:
    page = of(Picture(sample_report.SVG, "a", "b", "The pointer shows more."))
    assert '<span class="hint">The pointer shows more.</span>' in html(page)
    assert "The pointer" not in typst(page) + latex(page) + markdown(page)
    assert re.search(r"\.hint[^{]*\{ display: none; \}", (CSS.parent / "print.css").read_text())


def test_a_subtitle_has_formulas() -> None:
    page = Page("t", ("modes ", Math(Name("xi"))), ())
    assert "<p>modes <math><mi>ξ</mi></math></p>" in html(page)
    assert "ξ" in typst(page) and "\\xi" in latex(page) and "\\xi" in markdown(page)
