"""Pages that many tests look at, built once, and what is found on them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from typing import Any

import beams
import derive
from conftest import ROOT
from derive import pipeline
from derive.pipeline import Built, build
from derive.report.document.formula import Equation
from derive.report.document.page import (
    Block,
    Columns,
    Details,
    EquationBlock,
    Heading,
    Listing,
    Math,
    Page,
    TableBlock,
    Text,
)
from derive.report.model_page import model_page
from derive.report.notation.spoken_math import words
from derive.report.sections.files import SpecificationText

SCENES = {"point": "free_beam_point", "mean": "free_beam_mean", "block": "block", "loops": "body_symbolic"}


def spec(name: str) -> Any:
    """A body that is specified here."""
    if name.startswith("beam_"):
        frame, n = name.removeprefix("beam_").rsplit("_", 1)
        return beams.beam(frame, int(n))
    gravity = [0, 0.5, -9.81]
    match name:
        case "heavy":
            return beams.beam("tangent", 2, mass=2.5, gravity=[0, -9.81], ansatz=["1", "xi", "1+xi^2", "xi^3-xi/2"])
        case "carrying":
            middle = {"at": 0, "mass": {"symbol": "mm", "default": 0.5}, "inertia": {"symbol": "Jm", "default": 0.1}}
            return beams.beam(
                "mean", 3, masses={"middle": middle}, damping={"stiffness": {"symbol": "b", "default": 1}}
            )
        case "flat":
            return derive.symbolic_body("flat", 1, frame="given", lowering="flat", damping=True, gravity=gravity)
        case "loops_given":
            return derive.symbolic_body(
                "loops_given", 2, frame="given", lowering="loops", damping=True, gravity=gravity
            )
        case "rigid":
            return derive.symbolic_body("rigid", 0)
        case "forty":
            return derive.symbolic_body("forty", 40)
    raise KeyError(name)


@cache
def built(name: str) -> Built:
    """A body through all stages."""
    if name in SCENES:
        return build(ROOT / "scenes" / f"{SCENES[name]}.toml")
    return pipeline.generate(spec(name))


@cache
def page(name: str) -> Page:
    """The page of a body."""
    return model_page(built(name), given(name))


def given(name: str) -> SpecificationText:
    """The specification as text."""
    file = ROOT / "scenes" / f"{SCENES.get(name, '')}.toml"
    return SpecificationText(file.name, file.read_text() if name in SCENES else f'name = "{name}"')


def everything(blocks: Sequence[Block]) -> Iterator[Block]:
    """All blocks, those in others too."""
    for block in blocks:
        yield block
        match block:
            case Details(_, inner):
                yield from everything(inner)
            case Columns(columns):
                for one in columns:
                    yield from everything(one)


def section(name: str, anchor: str) -> tuple[Block, ...]:
    """The blocks from a heading to the next one of its level or above."""
    blocks = list(everything(page(name).blocks))
    start = next(k for k, b in enumerate(blocks) if isinstance(b, Heading) and b.anchor == anchor)
    level = blocks[start].level
    rest = blocks[start + 1 :]
    end = next((k for k, b in enumerate(rest) if isinstance(b, Heading) and b.level <= level), len(rest))
    return tuple(rest[:end])


def equations(blocks: Sequence[Block]) -> list[Equation]:
    return [line for block in blocks if isinstance(block, EquationBlock) for line in block.rows]


def tables(blocks: Sequence[Block]) -> list[TableBlock]:
    return [block for block in blocks if isinstance(block, TableBlock)]


def listings(blocks: Sequence[Block]) -> list[Listing]:
    return [block for block in blocks if isinstance(block, Listing)]


def plain(text: Text) -> str:
    """Text with its formulas in words."""
    return "".join(
        one if isinstance(one, str) else words(one.formula) if isinstance(one, Math) else one.text for one in text
    )


def page_blocks(name: str) -> tuple[Block, ...]:
    """All blocks of a page."""
    return tuple(everything(page(name).blocks))
