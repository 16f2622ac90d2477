"""Components of the derivation in vector form: `Q_11 d1_3 omega2dot - ...` is Q . (omegadot x d1).

The derivation works in components. Every product of the vectors and tensors of a term, each as often as it occurs
there, is tried until one has the same components for all values of the symbols, up to a number. Nothing of the paper
is used, and a term that is no such product is an error.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import combinations
from random import Random
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from derive.algebra import sp
from derive.mechanics.axes import AXES, PAIRS
from derive.mechanics.fixed_symbols import MASS
from derive.mechanics.motion.spatial import symbols_of_rotation, symmetric
from derive.mechanics.motion.vectors import skew
from derive.mechanics.symbols import Family, I, ShapeIndex, local, quantity
from derive.mechanics.symbols import vector as components_of
from derive.report.document.formula import Fenced, Formula, FormulaRow, Name, NumberToken, OperatorToken, Part
from derive.report.notation.typeset_names import column, indexed, whole


@dataclass(frozen=True)
class Atom:
    """A scalar, vector or tensor of the derivation: how it is written, and its components."""

    formula: Formula
    components: sp.ImmutableMatrix


def _letter(text: str, dots: int = 0, below: tuple[str, ...] = ()) -> Name:
    return Name(text, dots, below, style="vector")


def _sum(dots: int, of: Name) -> FormulaRow:
    """A sum over the shapes with the rates or the accelerations, which has a name in the code alone."""
    return FormulaRow((column(dots, transposed=True), of))


def _varied(of: Name) -> FormulaRow:
    return FormulaRow((OperatorToken("δ"), of))


def arrow(label: str) -> sp.Matrix:
    """A vector that the report writes in components and the derivation does not know."""
    return sp.Matrix([local(label, k) for k in AXES])


def _vector(family: Family, derivative: int = 0, *shapes: ShapeIndex) -> sp.Matrix:
    return components_of(family, len(AXES), derivative, shapes)


def _second_moment(derivative: int, *shapes: ShapeIndex) -> sp.Matrix:
    """D2 v = S v - d3 x v / 2, see `spatial`."""
    return symmetric(Family.S, derivative, shapes) - skew(_vector(Family.D3, derivative, *shapes)) / 2


C8DDOT = quantity(Family.C8_SUM, derivative=2, shapes=(I,))
DELTA_ALPHA = local("delta_alpha_i")
"""The variation of an amplitude."""


def _atoms() -> dict[str, Atom]:
    given: dict[str, tuple[Formula, sp.Matrix]] = {
        "mass": (Name("m"), sp.Matrix([MASS])),
        "Q": (Name("Q", style="tensor"), symbols_of_rotation()),
        "cddot": (_letter("c", 2), _vector(Family.TRANSLATION, 2)),
        "omega": (_letter("omega"), _vector(Family.ANGULAR_VELOCITY)),
        "omegadot": (_letter("omega", 1), _vector(Family.ANGULAR_VELOCITY, 1)),
        "c": (_letter("c"), _vector(Family.TRANSLATION)),
        "delta_c": (_varied(_letter("c")), arrow("delta_c")),
        "delta_alpha_i": (_varied(Name("alpha", below=("i",))), sp.Matrix([DELTA_ALPHA])),
        "delta_pi": (_varied(_letter("pi")), arrow("delta_pi")),
        "e": (_letter("e"), arrow("e")),
        "J": (whole(Family.INERTIA), symmetric(Family.INERTIA)),
        "D2dot": (_sum(1, whole(Family.D2)), _second_moment(1)),
        "D2_i": (indexed(Family.D2, I), _second_moment(0, I)),
        "X": (_letter("X"), arrow("X")),
        "r": (_letter("r"), arrow("r")),
        "rdot": (_letter("r", 1), arrow("rdot")),
        "rddot": (_letter("r", 2), arrow("rddot")),
        "Phi_i": (_letter("Phi", below=("i",)), arrow("Phi_i")),
        "d1": (whole(Family.D1), _vector(Family.D1)),
        "d1dot": (_sum(1, whole(Family.C2)), _vector(Family.D1, 1)),
        "d1ddot": (_sum(2, whole(Family.C2)), _vector(Family.D1, 2)),
        "d3ddot": (_sum(2, whole(Family.D3)), _vector(Family.D3, 2)),
        "c2_i": (indexed(Family.C2, I), _vector(Family.C2, 0, I)),
        "d3_i": (indexed(Family.D3, I), _vector(Family.D3, 0, I)),
        "c7dot_i": (FormulaRow((indexed(Family.C7, I), column(1))), _vector(Family.C7_SUM, 1, I)),
        "c8ddot_i": (FormulaRow((indexed(Family.C8, I), column(2))), sp.Matrix([C8DDOT])),
    }
    return {name: Atom(formula, sp.ImmutableMatrix(value)) for name, (formula, value) in given.items()}


ATOMS = _atoms()
"""The atoms by name, in the order in which products are tried."""

PRODUCTS = {
    quantity(Family.OMEGA_PRODUCT, i, j): quantity(Family.ANGULAR_VELOCITY, i) * quantity(Family.ANGULAR_VELOCITY, j)
    for i, j in PAIRS
}
"""Products of omega that have a name of their own."""


def _owners() -> dict[sp.Symbol, str]:
    """The atom that each symbol is a component of; parts of D2 that are atoms themselves count as such."""
    composed = ("D2dot", "D2_i")
    owners: dict[sp.Symbol, str] = {}
    for name in (*(n for n in ATOMS if n not in composed), *composed):
        for symbol in ATOMS[name].components.free_symbols:
            owners.setdefault(symbol, name)
    return owners


ATOM_OF = _owners()
"""The atom that a symbol is a component of."""


@dataclass(frozen=True)
class Leaf:
    """An atom by its name, or its conjugate."""

    atom: str
    conjugate: bool = False


Tree = Leaf | tuple[Literal["dot", "cross", "scale"], "Tree", "Tree"]
"""An atom, or a product of two trees."""

Rank = Literal[0, 1, 2]

SIGNS = {"dot": (OperatorToken("·"),), "cross": (OperatorToken("\u00d7"),), "scale": ()}


def summand(components: Sequence[sp.Expr], group: str = "", title: str = "") -> Part:
    """A term of the derivation, in three components or in one, as a product of vectors with its sign."""
    wanted = sp.ImmutableMatrix(components).xreplace(PRODUCTS).expand()
    used = _used(wanted)
    point = _point(used)
    target = np.array(wanted.xreplace(point), dtype=object).ravel()
    rank: Rank = 1 if len(wanted) > 1 else 0
    for tree in sorted(_trees(used, rank), key=_conjugates):
        factor = _ratio(target, _value(tree, point).ravel())
        if factor and (sp.Matrix(_value(tree, {})).reshape(len(wanted), 1) * factor - wanted).expand().is_zero_matrix:
            number = () if abs(factor) == 1 else (NumberToken(str(abs(factor))),)
            return Part("-" if factor < 0 else "+", FormulaRow((*number, formula(tree))), group=group, title=title)
    raise ArithmeticError(f"no product of {', '.join(used)} is {list(wanted)}")


def summands(components: Sequence[sp.Expr]) -> tuple[Part, ...]:
    """A vector of the derivation as a sum of products: its terms sorted by their factors."""
    result: dict[tuple[str, ...], list[sp.Expr]] = {}
    for k, entry in enumerate(components):
        for term in sp.Add.make_args(sp.expand(entry)):
            kept = result.setdefault(_used(sp.ImmutableMatrix([term])), [sp.S.Zero] * len(components))
            kept[k] += term
    return tuple(summand(kept) for kept in result.values())


def _conjugates(tree: Tree) -> int:
    """The number of conjugates in a tree; trees without them are tried first."""
    if isinstance(tree, Leaf):
        return int(tree.conjugate)
    _, left, right = tree
    return _conjugates(left) + _conjugates(right)


def _used(components: sp.ImmutableMatrix) -> tuple[str, ...]:
    """The atoms of a term, each repeated by its power."""
    entry = next(e for e in components if e != 0)
    powers = sp.Add.make_args(entry)[0].as_powers_dict()
    names = [ATOM_OF[symbol] for symbol, power in powers.items() if symbol.is_Symbol for _ in range(int(power))]
    return tuple(name for name in ATOMS for _ in range(names.count(name)))


def _rank(atom: str) -> Rank:
    rows, columns = ATOMS[atom].components.shape
    return 2 if columns > 1 else 1 if rows > 1 else 0


@cache
def _trees(atoms: tuple[str, ...], rank: Rank) -> tuple[Tree, ...]:
    """All products of some atoms that have this rank."""
    if len(atoms) == 1:
        (atom,) = atoms
        return () if _rank(atom) != rank else (Leaf(atom), Leaf(atom, True)) if atom == "Q" else (Leaf(atom),)
    return tuple(tree for left, right in _splits(atoms) for tree in _joined(left, right, rank))


def _joined(left: tuple[str, ...], right: tuple[str, ...], rank: Rank) -> Iterator[Tree]:
    ways: list[tuple[Literal["dot", "cross", "scale"], Rank, Rank]]
    ways = [("dot", 1, 1)] if rank == 0 else [("scale", 0, 1), ("dot", 2, 1), ("cross", 1, 1)] if rank == 1 else []
    for sign, first, second in ways:
        for a in _trees(left, first):
            for b in _trees(right, second):
                yield sign, a, b


def _splits(atoms: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], tuple[str, ...]]]:
    """The atoms in two parts, the shorter first parts before the longer."""
    places = range(len(atoms))
    seen = set()
    for count in range(1, len(atoms)):
        for chosen in combinations(places, count):
            pair = tuple(atoms[k] for k in chosen), tuple(atoms[k] for k in places if k not in chosen)
            if pair not in seen:
                seen.add(pair)
                yield pair


def _point(used: tuple[str, ...]) -> dict[sp.Symbol, int]:
    random = Random(1988)
    symbols = sorted({s for name in used for s in ATOMS[name].components.free_symbols}, key=str)
    return {s: 2 * random.randint(-999, 999) for s in symbols}


def _value(tree: Tree, point: dict[sp.Symbol, int]) -> NDArray[np.object_]:
    """The components of a tree, as integers at a point, or in symbols."""
    if isinstance(tree, Leaf):
        result = np.array(ATOMS[tree.atom].components.xreplace(point), dtype=object)
        return result.T if tree.conjugate else result if result.shape[1] > 1 else result[:, 0]
    sign, left, right = tree
    a, b = _value(left, point), _value(right, point)
    if sign == "cross":
        pairs = ((1, 2), (2, 0), (0, 1))
        return np.array([a[j] * b[k] - a[k] * b[j] for j, k in pairs], dtype=object)
    return np.asarray(a * b if sign == "scale" else np.atleast_1d(a @ b), dtype=object)


def _ratio(wanted: NDArray[np.object_], result: NDArray[np.object_]) -> sp.Rational | None:
    """The number by which `result` has to be multiplied to give `wanted`; None if there is none."""
    if wanted.shape != result.shape or not any(result):
        return None
    k = next(k for k, value in enumerate(result) if value)
    factor = sp.Rational(int(wanted[k]), int(result[k]))
    return factor if factor and all(w == factor * f for w, f in zip(wanted, result, strict=True)) else None


def formula(tree: Tree) -> Formula:
    """A product in the notation of the paper."""
    if isinstance(tree, Leaf):
        result = ATOMS[tree.atom].formula
        return (
            Name(result.text, above=("c",), style="tensor") if tree.conjugate and isinstance(result, Name) else result
        )
    sign, left, right = tree
    return FormulaRow((_inner(left), *SIGNS[sign], _inner(right)))


def _inner(tree: Tree) -> Formula:
    result = formula(tree)
    closed = isinstance(result, Name) or (isinstance(result, FormulaRow) and isinstance(result.parts[0], OperatorToken))
    return result if closed else Fenced(result)
