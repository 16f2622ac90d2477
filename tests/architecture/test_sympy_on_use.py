"""SymPy is taken from `derive.algebra`, which loads it when it is used."""

from __future__ import annotations

import grimp

DERIVING = {
    "derive.lowering.flat.constant_elimination",
    "derive.lowering.flat.polynomials",
    "derive.mechanics.time_functions",
    "derive.mechanics.time_integrals.closed_form",
}
"""The modules that are loaded only where equations are derived; they need names of parts of SymPy."""


def test_modules_take_sympy_from_one_place() -> None:
    graph = grimp.build_graph("derive", include_external_packages=True, cache_dir=None)
    found = graph.find_modules_that_directly_import("sympy")
    assert found == {"derive.algebra", *DERIVING}, "write: from derive.algebra import sp"
