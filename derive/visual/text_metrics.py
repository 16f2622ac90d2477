"""The sizes of texts in pictures.

The font is DejaVu Sans, whose metrics are the same on every machine; it is wider than most fonts of a browser.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache

FONT = "DejaVu Sans"
TIED = "\N{NO-BREAK SPACE}"


@cache
def text_size(text: str, size: float, bold: bool = False) -> tuple[float, float]:
    """The width and the height of a line of text, in the unit of the size of its font."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import text_to_path

    font = FontProperties(family=FONT, weight="bold" if bold else "normal", size=size)
    width, height, _ = text_to_path.get_text_width_height_descent(text, font, False)
    return width, height


def widest(texts: Iterable[str], size: float, bold: bool = False) -> float:
    """The width of the widest of some lines of text; zero if there is none."""
    return max((text_size(text, size, bold)[0] for text in texts), default=0.0)


def wrapped(text: str, width: float, size: float, bold: bool = False) -> list[str]:
    """The lines of a text, none of which is wider than a width; a word is divided where it is.

    A number and its percent sign stay together.
    """
    lines = [""]
    for word in text.replace(" %", f"{TIED}%").split(" "):
        longer = f"{lines[-1]} {word}" if lines[-1] else word
        if widest([longer], size, bold) <= width:
            lines[-1] = longer
            continue
        rest = word
        lines += [""] if lines[-1] else []
        while widest([rest], size, bold) > width and len(rest) > 1:
            count = max(n for n in range(1, len(rest)) if n == 1 or widest([rest[:n]], size, bold) <= width)
            lines[-1:], rest = [rest[:count], ""], rest[count:]
        lines[-1] = rest
    return [line.replace(TIED, " ") for line in lines]
