"""The numbers that `main` of an example returns, as readers see them."""

from __future__ import annotations

from collections.abc import Mapping
from numbers import Integral, Real

MINUS = "\N{MINUS SIGN}"
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def number_texts(value: object) -> list[tuple[str, str]]:
    """The label and the text of each number in a result; a number that stands alone has the label "".

    Mappings give labels, and the numbers of a sequence stand beside each other. Raises TypeError for anything else.
    """
    if isinstance(value, Mapping):
        return [(str(label), _joined(each)) for label, each in value.items()]
    return [("", _joined(value))]


def _joined(value: object) -> str:
    if isinstance(value, Real):
        return number_text(value)
    if isinstance(value, list | tuple):
        return ", ".join(f"({_joined(each)})" if isinstance(each, list | tuple) else _joined(each) for each in value)
    raise TypeError(f"{value!r} is no number, and no sequence or mapping of numbers")


def number_text(value: Real) -> str:
    """A number with six digits; very small and very large ones with two and a power of ten; whole ones in full."""
    if isinstance(value, Integral) or value == 0:
        return str(int(value))
    if 1e-3 <= abs(value) < 1e6:
        return f"{value:#.6g}".removesuffix(".").replace("-", MINUS)
    mantissa, _, exponent = f"{value:.1e}".partition("e")
    return f"{mantissa} · 10{str(int(exponent)).translate(SUPERSCRIPTS)}".replace("-", MINUS)
