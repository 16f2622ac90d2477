"""Formulas as MathML, which browsers show by themselves."""

from __future__ import annotations

import re
import unicodedata
from html import unescape
from typing import Any

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx

_STYLED = re.compile(r'<(?P<tag>m[in]) mathvariant="(?P<style>bold|bold-italic)">(?P<character>[^<]+)</m[in]>')


def mathml(formula: str, display: str) -> str:
    """The MathML of a formula in LaTeX; display: inline or block.

    Browsers do not know the styles of letters that MathML once had, and so bold letters are characters of their own.
    Large braces are braces, which the converter leaves as commands.
    """
    text = convert(formula, display=display)
    text = text.replace(">\\{<", ">{<").replace(">\\}<", ">}<")
    return _STYLED.sub(lambda match: _element(match["tag"], match["style"], unescape(match["character"])), text)


def _element(tag: str, style: str, text: str) -> str:
    """An element whose letters and digits are the characters that have a style."""
    style = "BOLD" if tag == "mn" else style.upper().replace("-", " ")
    return f"<{tag}>{''.join(_styled(character, style) for character in text)}</{tag}>"


def _styled(character: str, style: str) -> str:
    """The character that a letter or digit is in a style, such as BOLD ITALIC SMALL OMEGA; others stay as they are."""
    letter = unicodedata.name(character).replace("LETTER ", "").removeprefix("LATIN ").removeprefix("GREEK ")
    try:
        return unicodedata.lookup(f"MATHEMATICAL {style} {letter}")
    except KeyError:
        return character


def _inline(translator: Any, node: nodes.math) -> None:
    translator.body.append(mathml(node.astext(), "inline"))
    raise nodes.SkipNode


def _display(translator: Any, node: nodes.math_block) -> None:
    translator.body.append(f'<div class="formula">{mathml(node.astext(), "block")}</div>\n')
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the writer of formulas with Sphinx."""
    app.add_html_math_renderer("mathml", (_inline, None), (_display, None))
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
