"""The signs of formulas: their characters, their names in the languages of reports, and how they are read aloud."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class MathSign:
    """A sign: its command in the mathematics of LaTeX, its name in that of Typst, and the words for it, if there are
    any. `also` are other texts that stand for it."""

    character: str
    latex: str
    typst: str
    words: str = ""
    also: tuple[str, ...] = ()

    @property
    def texts(self) -> tuple[str, ...]:
        """All texts that stand for the sign."""
        return (self.character, *self.also)


SIGNS = (
    MathSign("∫", "\\int", "integral", "integral"),
    MathSign("∑", "\\sum", "sum", "sum"),
    MathSign("∏", "\\prod", "product", "product"),
    MathSign("=", "=", "=", "equals"),
    MathSign("≡", "\\equiv", "equiv", "is"),
    MathSign("≈", "\\approx", "approx", "about"),
    MathSign("≠", "\\neq", "eq.not", "is not equal to"),
    MathSign("<", "<", "lt", "less than"),
    MathSign(">", ">", "gt", "greater than"),
    MathSign("≤", "\\leq", "lt.eq", "at most", ("<=",)),
    MathSign("≥", "\\geq", "gt.eq", "at least", (">=",)),
    MathSign("∈", "\\in", "in", "in"),
    MathSign("→", "\\to", "arrow.r", "to", ("->",)),
    MathSign("+", "+", "+", "plus"),
    MathSign("\u2212", "-", "minus", "minus", ("-",)),
    MathSign("±", "\\pm", "plus.minus", "plus or minus"),
    MathSign("⋅", "\\cdot", "dot.op", "dot", ("·", "*")),
    MathSign("\u00d7", "\\times", "times", "cross"),
    MathSign("/", "/", "slash", "over"),
    MathSign("⊗", "\\otimes", "times.o"),
    MathSign("∘", "\\circ", "compose"),
    MathSign("d", "\\mathrm{d}", "upright(d)"),
    MathSign("∂", "\\partial", "partial", "partial"),
    MathSign("∇", "\\nabla", "nabla", "nabla"),
    MathSign("∞", "\\infty", "infinity", "infinity"),
    MathSign("\u2032", "'", "prime", "prime"),
    MathSign("'", "'", "prime", "prime"),
    MathSign("…", "\\dots", "dots.h", "and so on", ("...",)),
    MathSign("⋮", "\\vdots", "dots.v"),
    MathSign(",", ",", "comma", ","),
    MathSign(":", ":", "colon", "double dot product"),
    MathSign(";", ";", "semi"),
    MathSign(".", ".", '"."'),
    MathSign("!", "!", "excl"),
    MathSign("(", "(", "paren.l"),
    MathSign(")", ")", "paren.r"),
    MathSign("[", "[", "bracket.l"),
    MathSign("]", "]", "bracket.r"),
    MathSign("{", "\\{", "brace.l"),
    MathSign("}", "\\}", "brace.r"),
    MathSign("|", "\\vert", "bar.v"),
    MathSign("‖", "\\Vert", "bar.v.double"),
    MathSign("⟨", "\\langle", "chevron.l"),
    MathSign("⟩", "\\rangle", "chevron.r"),
)
"""All signs that a writer knows."""

BIG = frozenset("∫∑∏")
"""Signs that are letters with limits: a Name may carry them, its indices are the limits then."""
