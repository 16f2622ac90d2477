"""Names of the derivation as they stand in formulas: `c8_1_2` is c with the index 8,12 and `phidot` has a dot.

Indices are the number of the integral, the shapes, and the components, parted by commas. In a scene the body stands
above. A sum over the shapes that has a name in the code, such as D2dot, is written as the product that it is.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum

from derive.report.document.formula import Call, Formula, Name, Power, Row
from derive.report.document.formula import Number as Digits


class Kind(IntEnum):
    """What a symbol is; in this order the factors of a product stand."""

    CONSTANT = 0
    MOMENT = 1
    AMPLITUDE = 2
    RATE = 3
    ACCELERATION = 4
    TURN = 5
    SINE = 6


@dataclass(frozen=True)
class Known:
    """A symbol of the derivation: what it is, and how it is written."""

    kind: Kind
    formula: Formula


SHAPES = {"c1": 0, "c2": 1, "C3": 0, "C4": 1, "C5": 2, "c6": 1, "c7": 2, "c8": 2, "K": 2, "B": 2}
"""Shape integrals, stiffness and damping, with how many of their indices count shapes."""

MOMENTS = {"d1": 0, "D2": 1, "d3": 1, "S": 1, "J": 0}
"""Moments of r, likewise."""

DOTS = {"": 0, "dot": 1, "ddot": 2}
MOTION = (Kind.AMPLITUDE, Kind.RATE, Kind.ACCELERATION)
ITEM = "(?:[0-9]+|[ij])"

Write = Callable[[re.Match[str], tuple[str, ...]], Known]


def known(name: str) -> Known | None:
    """How a name is written, and what it is; None if it is no name of the derivation."""
    parts = name.removesuffix("_").split("_")
    for cut in range(len(parts)):
        rest = "_".join(parts[cut:])
        above = (" ".join(parts[:cut]),) if cut else ()
        for pattern, write in RULES:
            if found := re.fullmatch(pattern, rest):
                return write(found, above)
    return None


def constant(name: str) -> Name:
    """A symbol that the specification chose: letters, then digits and what follows an underscore as indices."""
    found = re.fullmatch(r"([A-Za-z]+)([0-9]*)_?(.*)", name)
    if found is None:
        return Name(name, style="word")
    letters, digits, rest = found.groups()
    below = ",".join(part for part in (digits, rest.replace("_", " ")) if part)
    return Name(letters, below=(below,) if below else ())


def indices(family: str, parts: list[str], shapes: int) -> tuple[str, ...]:
    """The number of the integral, the shapes, the components, parted by commas."""
    first, rest = parts[:shapes], parts[shapes:]
    close = " " if any(part in "ij" for part in first) else ""
    beside = close.join(first) if all(len(part) == 1 for part in first) else ",".join(first)
    text = ",".join(part for part in (family, beside, *rest) if part)
    return (text,) if text else ()


def table(name: str) -> Name:
    """A whole integral, with the indices of its shapes and components left out: the vector c2, the tensor C4."""
    letter, number = name[0], name[1:]
    tensor = letter.isupper() or name == "c8"
    return Name(letter, below=(number,) if number else (), style="tensor" if tensor else "vector")


def column(dots: int = 0, transposed: bool = False) -> Name:
    """The column of the amplitudes, or of their derivatives."""
    return Name("alpha", dots=dots, above=("T",) if transposed else (), style="vector")


def _component(found: re.Match[str], above: tuple[str, ...]) -> Known:
    letters, number, dots = found.groups()
    n = DOTS[dots or ""]
    kind = Kind(MOTION[n] + (letters == "omega"))
    return Known(kind, Name(letters, dots=n, below=(number,) if number else (), above=above))


def _generic(found: re.Match[str], above: tuple[str, ...]) -> Known:
    n = DOTS[found[1] or ""]
    return Known(MOTION[n], Name("alpha", dots=n, below=(found[2],), above=above))


def _sine(found: re.Match[str], above: tuple[str, ...]) -> Known:
    return Known(Kind.SINE, Call(found[1], Name("phi", above=above)))


def _turns(found: re.Match[str], above: tuple[str, ...]) -> Known:
    first, second = (Name("omega", below=(k,), above=above) for k in found.groups())
    return Known(Kind.RATE, Power(first, Digits("2")) if first == second else Row((first, second)))


def _integral(found: re.Match[str], above: tuple[str, ...]) -> Known:
    family, *parts = found[0].split("_")
    shapes = min(SHAPES[family], len(parts))
    return Known(Kind.CONSTANT, Name(family[0], below=indices(family[1:], parts, shapes), above=above))


def _moment(found: re.Match[str], above: tuple[str, ...]) -> Known:
    family, dots, *_ = found.groups()
    parts = [part for part in found[0].split("_")[1:] if part]
    below = indices(family[1:], parts, min(MOMENTS[family], len(parts)))
    return Known(Kind.MOMENT, Name(family[0], dots=DOTS[dots or ""], below=below, above=above))


def _with_rates(found: re.Match[str], above: tuple[str, ...]) -> Known:
    """D2dot and d3dot, sums of the D2_i and d3_i with the rates; with accelerations d1ddot and d3ddot."""
    family, dots, rest = found.groups()
    letter, digit = ("c", "2") if family == "d1" else (family[0], family[1:])
    below = ",".join(part for part in (digit, *(rest or "").split("_")) if part)
    moment = Name(letter, below=(below,) if below else (), above=above)
    return Known(Kind.MOMENT, Row((column(DOTS[dots], transposed=True), moment)))


def _times_rates(found: re.Match[str], above: tuple[str, ...]) -> Known:
    """c7dot_i and c8ddot_i: row i of a table times the rates, or the accelerations."""
    family, dots, index, component = found.groups()
    below = ",".join(part for part in (family[1:], index, (component or "").strip("_")) if part)
    return Known(Kind.MOMENT, Row((Name(family[0], below=(below,), above=above), column(DOTS[dots]))))


def _twice(found: re.Match[str], above: tuple[str, ...]) -> Known:
    matrix = Name("c", below=("8",), above=above, style="tensor")
    return Known(Kind.MOMENT, Row((column(1, transposed=True), matrix, column(1))))


def _force(found: re.Match[str], above: tuple[str, ...]) -> Known:
    """elastic_i and damping_i: row i of the stiffness times the amplitudes, of the damping times the rates."""
    letter, dots = {"elastic": ("K", 0), "damping": ("B", 1)}[found[1]]
    return Known(Kind.MOMENT, Row((Name(letter, below=(found[2],), above=above), column(dots))))


def _strain(found: re.Match[str], above: tuple[str, ...]) -> Known:
    return Known(Kind.MOMENT, Row((column(transposed=True), table("K"), column())))


def _gravity(found: re.Match[str], above: tuple[str, ...]) -> Known:
    body = ("b",) if found[2] else ()
    kind = Kind.TURN if found[2] else Kind.CONSTANT
    return Known(kind, Name(found[1], below=(found[3],), above=(*above, *body)))


def _point(found: re.Match[str], above: tuple[str, ...]) -> Known:
    letter, dots, rest = found.groups()
    below = rest.replace("_", " ").strip()
    kind = Kind.CONSTANT if letter in ("X", "turn") else Kind.MOMENT
    letter = "theta" if letter == "turn" else letter
    return Known(kind, Name(letter, dots=DOTS[dots or ""], below=(below,) if below else (), above=above))


RULES: tuple[tuple[str, Write], ...] = (
    (r"(c|alpha|omega|e)([0-9]+)(dot|ddot)?", _component),
    (r"(phi|s)()(dot|ddot)?", _component),
    (rf"alpha(dot|ddot)?_({ITEM})", _generic),
    (r"(cos|sin)_phi", _sine),
    (r"oo_([1-3])([1-3])", _turns),
    (r"mass()", lambda found, above: Known(Kind.CONSTANT, Name("m", above=above))),
    (r"Q_([1-3]+)", lambda found, above: Known(Kind.TURN, Name("Q", below=(found[1],), above=above))),
    (rf"(c1|c2|C4|C5|c6|c7|c8|K|B)(_{ITEM}+)+", _integral),
    (rf"C3(_{ITEM})?", _integral),
    (rf"(d1)(dot)?(_{ITEM})", _moment),
    (rf"(D2|d3|S)()(_{ITEM})(_{ITEM})?", _moment),
    (rf"(J)()(_{ITEM})?", _moment),
    (rf"(D2|d3|S)(dot)(_{ITEM})?", _with_rates),
    (rf"(d1|d3)(ddot)(_{ITEM})?", _with_rates),
    (rf"(c7|c8)(dot|ddot)_({ITEM})(_{ITEM})?", _times_rates),
    (r"c8dotdot", _twice),
    (rf"(elastic|damping)_({ITEM})", _force),
    (r"strain", _strain),
    (r"(g|F)(b?)_([1-3])", _gravity),
    (r"(X|turn)(dot)?((?:_[A-Za-z0-9]+)+)", _point),
    (r"(r|s)(dot)?(_[1-3])", _point),
)
