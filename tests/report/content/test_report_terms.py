"""Terms on a page: each once, with its name and number, and both ways between it and the C that computes it."""

from __future__ import annotations

import re

import pages
import pytest

from derive.report.document.anchors import faults
from derive.report.document.page import Hyperlink
from derive.report.notation.expressions import notation

GROUPS = (
    ("translation", "Euler", "relative"),
    ("centrifugal", "Coriolis"),
    ("elastic",),
    ("preload",),
    ("damping",),
    ("gravity",),
)
"""Terms as readers expect them: accelerations, velocities, stiffness, damping, gravity; others come last."""

LATER = ("beam_point_8", "forty", "flat", "loops_given")
"""Bodies whose pages are longer than those of others, and have the same sections."""
BODIES = [
    *("point", "mean", "block", "loops", "heavy", "carrying", "rigid"),
    *(pytest.param(name, marks=pytest.mark.long) for name in LATER),
]


def links(cell) -> list[Hyperlink]:
    return [one for one in cell.text if isinstance(one, Hyperlink)]


def source(name: str) -> list[str]:
    return next(f.text for f in pages.built(name).files if f.path.endswith(".c")).splitlines()


def code(name: str) -> dict[str, object]:
    """Lines of the generated C on the page, by their anchors."""
    return {line.anchor: line for listing in pages.listings(pages.section(name, "c")) for line in listing.lines}


@pytest.mark.parametrize("name", BODIES)
def test_every_term_is_there_once_with_its_name_and_number(name: str) -> None:
    terms = pages.built(name).equations.terms
    blocks = pages.section(name, "motion")
    parts = [part for line in pages.equations(blocks) for part in line.parts]
    told = [(row[0].text[0].text, row[0].text[0].to, row[2].text[0]) for t in pages.tables(blocks) for row in t.rows]
    expected = [(t.name, f"#term-{t.row}-{t.name}", t.equation) for t in terms]
    assert sorted(told) == sorted(expected)
    for t in terms:
        of_term = [p for p in parts if p.anchor == f"term-{t.row}-{t.name}"]
        assert len(of_term) == 1
        assert t.name in of_term[0].title and t.equation in of_term[0].title


@pytest.mark.parametrize("name", BODIES)
def test_terms_stand_by_groups(name: str) -> None:
    known = [t.name for t in pages.built(name).equations.terms]
    order = {term: next((k for k, group in enumerate(GROUPS) if term in group), len(GROUPS)) for term in known}
    for table in pages.tables(pages.section(name, "motion")):
        found = [order[row[0].text[0].text] for row in table.rows]
        assert found == sorted(found)
    groups = {row[1].text[0] for t in pages.tables(pages.section("heavy", "motion")) for row in t.rows}
    assert groups == {"accelerations", "rates", "elastic", "gravity"}


@pytest.mark.parametrize("name", [*BODIES, "beam_chord_2", pytest.param("beam_mean_8", marks=pytest.mark.long)])
def test_links_lead_to_places_of_the_page(name: str) -> None:
    assert faults(pages.page(name)) == ()


@pytest.mark.parametrize("name", BODIES)
def test_lines_are_those_of_the_file(name: str) -> None:
    text = source(name)
    shown = code(name)
    for line in shown.values():
        assert line.text == text[line.number - 1] and line.anchor == f"c-{line.number}"
    assert len(shown) >= min(len(text), 60)


@pytest.mark.parametrize("name", BODIES)
def test_a_term_leads_to_the_line_that_stores_it_and_back(name: str) -> None:
    built, shown = pages.built(name), code(name)
    entries = built.model.pattern("mass", "M").entries
    index = {row.name: k for k, row in enumerate(built.equations.rows)}
    rows = {f"#term-{t.row}-{t.name}": t for t in built.equations.terms}
    for table in pages.tables(pages.section(name, "motion")):
        for cells in table.rows:
            own = cells[0].text[0].to
            term = rows[own]
            stores = links(cells[3])
            assert stores
            for link in stores:
                line = shown[link.to.removeprefix("#")]
                assert Hyperlink(f"{term.name} {notation(built.equations).delta(term.row)}", own) in line.links
                stored = re.search(r"\b(h|M)(?:\[| \+ )(\d+)", line.text)
                assert stored
                if stored[1] == "h":
                    assert int(stored[2]) == index[term.row]
                else:
                    i, j = entries[int(stored[2])]
                    assert index[term.row] in (i, j)


@pytest.mark.parametrize("name", ["point", "block", "loops"])
def test_names_lead_to_the_lines_that_define_them(name: str) -> None:
    shown = code(name)
    found = 0
    for table in pages.tables(pages.section(name, "motion")):
        for cells in table.rows:
            for link in links(cells[4]):
                line = shown[link.to.removeprefix("#")]
                assert re.search(r"const double \w+ = |\w+ [-+]= |\[i\] = ", line.text), line.text
                found += 1
    assert found > 10


def test_terms_lead_to_the_entry_of_their_acceleration() -> None:
    """Row phi of the beam in the frame of its middle: c1 and c2 in two entries, J, and c6."""
    (table,) = pages.tables(pages.section("point", "row-phi"))
    lines = {row[0].text[0].text: [link.to.removeprefix("#") for link in links(row[3])] for row in table.rows}
    text = {name: [code("point")[anchor].text.strip() for anchor in some] for name, some in lines.items()}
    assert text == {
        "translation": ["M[1] = -(d1_2 * cos_phi);", "M[4] = -(d1_2 * sin_phi);"],
        "Euler": ["M[6] = J;"],
        "relative": ["M[7] = c6_2;"],
        "Coriolis": ["h[2] = t3 * D2dot;"],
    }


def test_long_functions_are_shortened_and_keep_what_is_linked() -> None:
    shown = code("flat")
    assert len(shown) > 100
    assert len(code("forty")) == sum(len(listing.lines) for listing in pages.listings(pages.section("forty", "c")))
