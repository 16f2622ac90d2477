"""The generated C of mass matrix and forces, each line with the terms that it computes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import PurePosixPath

from derive.backends.source_map import FunctionLines, SourceMap
from derive.report.document.page import Block, CodeLine, CodeSpan, Details, Heading, Hyperlink, Listing, Paragraph
from derive.report.notation.labels import delta
from derive.report.sections.term_lines import LocatedTerm, line_anchor

LONG = 400
"""Lines of a function that is shown as a whole; of a longer one those that compute a term or a moment."""


@dataclass(frozen=True)
class Targets:
    """What lines lead to: terms by the lines that store them, and the anchors of moments by their names in the code.

    `wanted` are the lines that other places lead to.
    """

    terms: Mapping[int, tuple[LocatedTerm, ...]]
    moments: Mapping[str, str]
    wanted: frozenset[int] = frozenset()


def targets(located: Iterable[LocatedTerm], moments: Mapping[str, str]) -> Targets:
    """What lines lead to."""
    result: dict[int, list[LocatedTerm]] = {}
    wanted: set[int] = set()
    for item in located:
        wanted |= {number for _, number in item.names}
        for number in item.stores:
            result.setdefault(number, []).append(item)
    return Targets({number: tuple(some) for number, some in result.items()}, moments, frozenset(wanted))


def code_blocks(code: SourceMap, lead: Targets) -> tuple[Block, ...]:
    """The functions `mass` and `force`, and `setup` folded."""
    setup = code.functions["setup"]
    return (
        Heading("The generated C", "c"),
        Paragraph(
            (
                "From ",
                CodeSpan(PurePosixPath(code.path).name),
                ", with the numbers of its lines. Behind a line stand the terms of the equations of motion that it "
                "computes; ",
                CodeSpan("mass_force"),
                " gives both at once.",
            )
        ),
        _listing(code.functions["mass"], lead, "mass: the mass matrix, lower triangle by columns"),
        _listing(code.functions["force"], lead, "force: the forces h"),
        Details(
            f"setup: what depends on parameters alone, once ({len(setup.lines)} lines)",
            (_listing(setup, Targets({}, {}), "setup"),),
        ),
    )


def _listing(function: FunctionLines, lead: Targets, caption: str) -> Listing:
    lines = tuple(_line(number, line.text, line.defines or "", lead) for number, line in function.numbered)
    return Listing("c", caption, lines if len(lines) <= LONG else _shortened(lines, lead.wanted))


def _line(number: int, text: str, name: str, lead: Targets) -> CodeLine:
    links = [Hyperlink(f"{p.term.name} {delta(p.variation)}", f"#{p.anchor}") for p in lead.terms.get(number, ())]
    if name in lead.moments:
        links.append(Hyperlink(name, f"#{lead.moments[name]}"))
    return CodeLine(number, text, line_anchor(number), tuple(links))


def _shortened(lines: Sequence[CodeLine], wanted: frozenset[int]) -> tuple[CodeLine, ...]:
    """The first line, those that lead somewhere or that something leads to, comments before them, and the last."""
    kept = {0, len(lines) - 1}
    for k, line in enumerate(lines):
        if line.links or line.number in wanted:
            kept |= {k, k - 1} if "/*" in lines[k - 1].text or "*/" in lines[k - 1].text else {k}
    return tuple(lines[k] for k in sorted(kept))
