"""The vectors and tensors that the derivation writes in components: their names in formulas, and their components."""

from __future__ import annotations

import re
from dataclasses import dataclass

import sympy as sp

from derive.mechanics.spatial import PAIRS, skew, symbols_of_rotation, symmetric, vector
from derive.report.document.formula import Formula, Name, Operator, Row


@dataclass(frozen=True)
class Atom:
    """A scalar, vector or tensor of the derivation: how it is written, and its components."""

    formula: Formula
    components: sp.ImmutableMatrix


def _name(text: str, below: str = "", dots: int = 0, tensor: bool = False) -> Name:
    return Name(text, dots, (below,) if below else (), style="tensor" if tensor else "vector")


def _column(dots: int, transposed: bool = False) -> Name:
    return Name("alpha", dots, above=("T",) if transposed else (), style="vector")


def _sum(dots: int, of: Name) -> Row:
    """A sum over the shapes with the rates or the accelerations, which has a name in the code alone."""
    return Row((_column(dots, transposed=True), of))


def _turned(even: str, odd: str) -> sp.Matrix:
    """D2 v = S v - d3 x v / 2, see `spatial`."""
    return symmetric(even) - skew(vector(odd)) / 2


def _atoms() -> dict[str, Atom]:
    given: dict[str, tuple[Formula, sp.Matrix]] = {
        "mass": (Name("m"), sp.Matrix([sp.Symbol("mass")])),
        "Q": (_name("Q", tensor=True), symbols_of_rotation()),
        "cddot": (_name("c", dots=2), sp.Matrix(sp.symbols("c1ddot c2ddot c3ddot"))),
        "omega": (_name("omega"), sp.Matrix(sp.symbols("omega1:4"))),
        "omegadot": (_name("omega", dots=1), sp.Matrix(sp.symbols("omega1dot omega2dot omega3dot"))),
        "c": (_name("c"), sp.Matrix(sp.symbols("c1:4"))),
        "delta_c": (Row((Operator("δ"), _name("c"))), vector("delta_c")),
        "delta_alpha_i": (Row((Operator("δ"), Name("alpha", below=("i",)))), sp.Matrix([sp.Symbol("delta_alpha_i")])),
        "delta_pi": (Row((Operator("δ"), _name("pi"))), vector("delta_pi")),
        "e": (_name("e"), vector("e")),
        "J": (_name("J", tensor=True), symmetric("J")),
        "D2dot": (_sum(1, _name("D", "2", tensor=True)), _turned("Sdot", "d3dot")),
        "D2_i": (_name("D", "2 i", tensor=True), _turned("S_i", "d3_i")),
        "X": (_name("X"), vector("X")),
        "r": (_name("r"), vector("r")),
        "rdot": (_name("r", dots=1), vector("rdot")),
        "rddot": (_name("r", dots=2), vector("rddot")),
        "Phi_i": (_name("Phi", "i"), vector("Phi_i")),
        "d1": (_name("d", "1"), vector("d1")),
        "d1dot": (_sum(1, _name("c", "2")), vector("d1dot")),
        "d1ddot": (_sum(2, _name("c", "2")), vector("d1ddot")),
        "d3ddot": (_sum(2, _name("d", "3")), vector("d3ddot")),
        "c2_i": (_name("c", "2 i"), vector("c2_i")),
        "d3_i": (_name("d", "3 i"), vector("d3_i")),
        "c7dot_i": (Row((_name("c", "7 i"), _column(1))), vector("c7dot_i")),
        "c8ddot_i": (Row((_name("c", "8 i", tensor=True), _column(2))), sp.Matrix([sp.Symbol("c8ddot_i")])),
    }
    return {name: Atom(formula, sp.ImmutableMatrix(value)) for name, (formula, value) in given.items()}


ATOMS = _atoms()
"""In the order in which a product is tried."""

SAME = {"Sdot": "D2dot", "d3dot": "D2dot", "S_i": "D2_i"}
"""Symmetric and antisymmetric parts that the derivation holds apart."""

PRODUCTS = {sp.Symbol(f"oo_{i}{j}"): sp.Symbol(f"omega{i}") * sp.Symbol(f"omega{j}") for i, j in PAIRS}
"""Products of omega that have a name of their own."""


def atom_of(symbol: sp.Symbol) -> str:
    """The name of the atom that a symbol is a component of."""
    stem = re.sub(r"_\d+$", "", symbol.name)
    stem = re.sub(r"^(c|omega)\d(d*o*t*)$", r"\1\2", stem)
    return SAME.get(stem, stem)
