"""Tables for LaTeX: longtable with rules of booktabs; columns of much text are paragraphs."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from derive.report.document.page import Inline, Math, Table, Text
from derive.report.notation.line_breaking import width

LINE, LONG, MANY = 78, 24, 8


def tabular(table: Table, shown: Callable[[Text], str]) -> str:
    """A table; `shown` turns text into LaTeX."""
    columns = _columns(table)
    paragraphs = [column.startswith("p") for column in columns]
    caption = f"\\caption{{{shown((table.caption,))}}}\\\\\n" if table.caption else ""
    head = _row([f"\\textbf{{{shown(said)}}}" if said else "" for said in table.head], paragraphs)
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


def _columns(table: Table) -> list[str]:
    """The kind of each column: l, r or c, and a paragraph where the table would be too wide."""
    align = table.align.ljust(len(table.head), "l")
    texts = [[said, *(row[k].text for row in table.rows)] for k, said in enumerate(table.head)]
    widths = [max(_width(text) for text in column) for column in texts]
    if sum(widths) + 2 * len(widths) <= LINE:
        return list(align)
    short = [one for one in widths if one <= LONG]
    long = [one for one in widths if one > LONG]
    room = max(0.9 - sum(short) / LINE - 0.02 * len(widths), 0.3)
    return [
        side if one <= LONG or not long else f"p{{{room * one / sum(long):.2f}\\linewidth}}"
        for side, one in zip(align, widths, strict=True)
    ]


def _width(text: Text) -> float:
    """The width of text, in characters."""
    return sum(_inline(part) for part in text)


def _inline(part: Inline) -> float:
    if isinstance(part, str):
        return len(part)
    return 2 * width(part.formula) if isinstance(part, Math) else len(part.text)
