"""The parts of which the HTML of an object consists: a head, tables, pictures and players. All texts are escaped here.

Pictures get ids that follow from their content, so that the same object gives the same bytes and several of them do not
disturb each other on a page.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from hashlib import sha256
from html import escape

from derive.report.writers.picture import inline

MOST_ROWS = 24
"""The largest number of rows of a table; further ones are counted."""
LARGEST_PLAYER = 1_500_000
"""The largest player, in bytes, that is put into the output of a notebook, which keeps it with its text."""
PLAYER_HEIGHT, STRIP_HEIGHT, MOST_STRIPS = 640, 120, 3
"""The height of a player and that of each curve below it, in pixels, and the most curves for which there is room."""
NARROW = '"max-width: 100%; height: auto"'
"""The style of pictures, which are no wider than a page."""
PADDING = "padding: 2px 10px"
SHORT = 12
"""The characters of a text, such as a number with its unit, that is not broken into lines in a table."""


def head(name: str, text: str = "") -> str:
    """The first line of an object: its name and what it is."""
    return f"<p><strong>{escape(name)}</strong>{f': {escape(text)}' if text else ''}</p>"


def paragraph(text: str) -> str:
    """A sentence below a head."""
    return f"<p>{escape(text)}</p>"


def lines(texts: Iterable[str]) -> str:
    """A list of sentences, such as notes and warnings; empty without any."""
    items = "".join(f"<li>{escape(text)}</li>" for text in texts)
    return f"<ul>{items}</ul>" if items else ""


def table(columns: Sequence[str], rows: Sequence[Sequence[object]], left: int = 1, most: int = MOST_ROWS) -> str:
    """A table with its first rows; the first `left` columns are left-aligned. Empty without rows."""
    if not rows:
        return ""
    titles = "".join(_cell("th", title, number < left) for number, title in enumerate(columns))
    body = "".join(
        f"<tr>{''.join(_cell('td', cell, number < left) for number, cell in enumerate(row))}</tr>"
        for row in rows[:most]
    )
    more = f"<p>and {len(rows) - most} more rows</p>" if len(rows) > most else ""
    # notebooks have a style for tables of pandas, which have this class
    return f'<table class="dataframe"><thead><tr>{titles}</tr></thead><tbody>{body}</tbody></table>{more}'


def _cell(tag: str, content: object, left: bool) -> str:
    style = f"text-align: {'left' if left else 'right'}; {PADDING}"
    if len(str(content)) <= SHORT:
        style += "; white-space: nowrap"
    return f'<{tag} style="{style}">{escape(str(content))}</{tag}>'


def picture(svg: str, alt: str) -> str:
    """A picture that a page keeps apart from its other elements; `alt` says what it shows."""
    drawn = inline(svg, f"t{digest(svg)}", alt)
    return f"<div>{drawn.replace('<svg ', f'<svg style={NARROW} ', 1)}</div>"


def digest(text: str) -> str:
    """A few letters that follow from a text."""
    return sha256(text.encode()).hexdigest()[:12]


def folded(title: str, content: str) -> str:
    """An element that shows its content when a reader opens it; empty without content."""
    return f"<details><summary>{escape(title)}</summary>{content}</details>" if content else ""


def player(page: str, title: str, curves: int = 0) -> str:
    """A page that plays a motion, in a frame of its own, which runs scripts and reaches nothing outside of itself.

    curves: how many there are below the motion. Of a page that is too large for the output of a notebook there is a
    sentence instead.
    """
    size = len(page.encode())
    if size > LARGEST_PLAYER:
        return paragraph(
            f"The player of this motion has {size / 1e6:.1f} MB, which is too much for a notebook; the command "
            "`tisserand simulate` writes it as a page of its own."
        )
    height = PLAYER_HEIGHT + STRIP_HEIGHT * min(curves, MOST_STRIPS)
    style = f"width: 100%; height: {height}px; border: 0"
    return (
        f'<iframe title="{escape(title)}" sandbox="allow-scripts" loading="lazy" style="{style}" '
        f'srcdoc="{escape(page)}"></iframe>'
    )


def joined(*parts: str) -> str:
    """Parts below each other, in an element of their own."""
    return f"<div>{''.join(part for part in parts if part)}</div>"


def number(value: float) -> str:
    """A number with four digits."""
    return f"{value:.4g}"


Writers = dict[type, Callable[..., str]]
"""The functions that write objects as HTML, by the types of the objects."""
