"""Text and tables for LaTeX: no part of a text is ever a command."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Sequence

from derive.report.document.page import Inline, Math, TableBlock, Text
from derive.report.notation.glyphs import GREEK as GREEK_NAMES
from derive.report.notation.glyphs import NAMES
from derive.report.notation.line_breaking import width
from derive.report.notation.signs import SIGNS as KNOWN

SPECIAL = {
    **{c: f"\\{c}" for c in "#$%&_{}"},
    **{c: f"{{{c}}}" for c in "[]*"},
    "\\": "\\textbackslash{}",
    "~": "\\textasciitilde{}",
    "^": "\\textasciicircum{}",
    "<": "\\textless{}",
    ">": "\\textgreater{}",
    "|": "\\textbar{}",
    "`": "`{}",
    "\1": "{}",
    "\n": " ",
    "\t": " ",
    "\u00a0": "~",
}
ACCENTS = dict(
    zip(
        "\u0300\u0301\u0302\u0303\u0308\u030a\u030c\u0327\u0304\u0306\u0307\u030b",
        ("`", "'", "^", "~", '"', "r", "v", "c", "=", "u", ".", "H"),
        strict=True,
    )
)
LETTERS = {"ß": "{\\ss}", "æ": "{\\ae}", "Æ": "{\\AE}", "ø": "{\\o}", "Ø": "{\\O}", "œ": "{\\oe}", "ł": "{\\l}"}
SIGNS = {
    **{sign: f"${known.latex}$" for known in KNOWN for sign in known.texts if not sign.isascii()},
    **{
        "\u2013": "--",
        "\u2014": "---",
        "\u2018": "`{}",
        "\u2019": "'",
        "\u201c": "``",
        "\u201d": "''",
        "…": "\\dots{}",
    },
    **{"°": "$^{\\circ}$", "←": "$\\leftarrow$", "√": "$\\surd$", "✓": "$\\surd$", "¬": "$\\neg$"},
    **{"§": "\\S{}", "µ": "$\\mu$", "…": "\\dots{}"},
}
_LATIN = {
    **{
        "Alpha": "A",
        "Beta": "B",
        "Epsilon": "E",
        "Zeta": "Z",
        "Eta": "H",
        "Iota": "I",
        "Kappa": "K",
        "Mu": "M",
        "Nu": "N",
    },
    **{"Omicron": "O", "Rho": "P", "Tau": "T", "Chi": "X"},
}
GREEK = {
    **{letter: f"\\{name}" for letter, name in NAMES.items()},
    **{"ε": "\\varepsilon", "φ": "\\varphi", "ϕ": "\\phi", "\u03bf": "o"},
    **{GREEK_NAMES[name]: f"\\mathrm{{{c}}}" for name, c in _LATIN.items()},
}
DERIVATIVES = {"\u0307": "\\dot", "\u0308": "\\ddot"}


def escaped(text: str) -> str:
    """Text as LaTeX shows it; characters that its fonts lack are replaced by their code points."""
    text = "".join(c for c in unicodedata.normalize("NFC", text) if c.isprintable() or c in "\n\t\u00a0")
    dotted = re.sub(r"(\w)([\u0307\u0308])", lambda result: f"\0{result[2]}{result[1]}", text)
    dotted = re.sub(r"-(?=-)", "-\1", dotted)
    out, k = [], 0
    while k < len(dotted):
        if dotted[k] == "\0" and k + 2 < len(dotted):
            out.append(f"${DERIVATIVES[dotted[k + 1]]}{{{GREEK.get(dotted[k + 2], dotted[k + 2])}}}$")
            k += 3
        else:
            out.append(_character(dotted[k]))
            k += 1
    return "".join(out)


def _character(c: str) -> str:
    if c in SPECIAL:
        return SPECIAL[c]
    if " " <= c <= "~":
        return c
    if c in LETTERS or c in SIGNS:
        return LETTERS.get(c) or SIGNS[c]
    if c in GREEK:
        return f"${GREEK[c]}$"
    parts = unicodedata.decomposition(c).split()
    if len(parts) == 2 and parts[0] in ("<super>", "<sub>") and (small := chr(int(parts[1], 16))).isascii():
        return f"${'^' if parts[0] == '<super>' else '_'}{{{small}}}$"
    if len(parts) == 2 and not parts[0].startswith("<"):
        base, accent = (chr(int(item, 16)) for item in parts)
        if base.isascii() and accent in ACCENTS:
            return f"\\{ACCENTS[accent]}{{{base}}}"
    return f"\\texttt{{U+{ord(c):04X}}}"


LINE, LONG, MANY = 78, 24, 8


def tabular(table: TableBlock, shown: Callable[[Text], str]) -> str:
    """A table; `shown` turns text into LaTeX."""
    columns = _columns(table)
    paragraphs = [column.startswith("p") for column in columns]
    caption = f"\\caption{{{shown((table.caption,))}}}\\\\\n" if table.caption else ""
    head = _row([f"\\textbf{{{shown(words)}}}" if words else "" for words in table.head], paragraphs)
    rows = "\n".join(_row([shown(cell.text) for cell in row], paragraphs) for row in table.rows)
    small = "\\scriptsize\\setlength{\\tabcolsep}{3pt}" if len(table.head) > MANY else "\\small"
    uncounted = "" if table.caption else "\n\\addtocounter{table}{-1}"
    return (
        f"\\begingroup{small}\n\\begin{{longtable}}{{@{{}}{''.join(columns)}@{{}}}}\n{caption}"
        f"\\toprule\n{head}\n\\midrule\n\\endfirsthead\n\\toprule\n{head}\n\\midrule\n\\endhead\n"
        f"\\bottomrule\n\\endlastfoot\n{rows}\n\\end{{longtable}}{uncounted}\n\\endgroup"
    )


def _row(cells: Sequence[str], paragraphs: Sequence[bool]) -> str:
    filled = [f"\\raggedright {cell}" if long else cell for cell, long in zip(cells, paragraphs, strict=True)]
    return f"{' & '.join(filled)} \\tabularnewline"


def _columns(table: TableBlock) -> list[str]:
    """The kind of each column: l, r or c, and a paragraph where the table would be too wide."""
    align = table.align.ljust(len(table.head), "l")
    texts = [[words, *(row[k].text for row in table.rows)] for k, words in enumerate(table.head)]
    widths = [max(_width(text) for text in column) for column in texts]
    if sum(widths) + 2 * len(widths) <= LINE:
        return list(align)
    short = [item for item in widths if item <= LONG]
    long = [item for item in widths if item > LONG]
    room = max(0.9 - sum(short) / LINE - 0.02 * len(widths), 0.3)
    return [
        side if item <= LONG or not long else f"p{{{room * item / sum(long):.2f}\\linewidth}}"
        for side, item in zip(align, widths, strict=True)
    ]


def _width(text: Text) -> float:
    """The width of text, in characters."""
    return sum(_inline(part) for part in text)


def _inline(part: Inline) -> float:
    if isinstance(part, str):
        return len(part)
    return 2 * width(part.formula) if isinstance(part, Math) else len(part.text)
