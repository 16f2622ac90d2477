"""Successive sums are computed term by term, with the operations and the results of the sums one after the other."""

from __future__ import annotations

from derive.ir.expressions import Element, Expr, Operation, Operator, ScalarRef
from derive.ir.indices import constant
from derive.ir.loop_nests import Assign, Node
from derive.ir.parallel_sums import with_parallel_sums
from derive.ir.statements import Let

TERMS, SUMS = 4, 3


def product(a: str, b: str) -> Expr:
    return Operation(Operator.MUL, (ScalarRef(a), ScalarRef(b)))


def total(*of: Expr) -> Expr:
    first, *others = of
    for other in others:
        first = Operation(Operator.ADD, (first, other))
    return first


def lines(terms: int = TERMS) -> list[Node]:
    values: list[Node] = [Let(f"f{k}", product(f"z{k}", "scale")) for k in range(terms)]
    sums = [total(*(product(f"f{k}", f"y{k}{n}") for k in range(terms))) for n in range(SUMS)]
    return [*values, *(Assign(Element("x", constant(n)), expr) for n, expr in enumerate(sums))]


def written_out(nodes: tuple[Node, ...]) -> dict[object, Expr]:
    """The expressions that elements get, without names in between."""
    named: dict[str, Expr] = {}

    def whole(expr: Expr) -> Expr:
        if isinstance(expr, Operation):
            return Operation(expr.kind, tuple(map(whole, expr.args)))
        return named.get(expr.name, expr) if isinstance(expr, ScalarRef) else expr

    result: dict[object, Expr] = {}
    for node in nodes:
        assert isinstance(node, Let | Assign)
        if isinstance(node, Let):
            named[node.name] = whole(node.expr)
        else:
            result[node.target] = whole(node.expr)
    return result


def test_a_factor_serves_all_sums_at_once_and_is_computed_for_its_term() -> None:
    made = with_parallel_sums(lines())
    names = [node.name for node in made if isinstance(node, Let)]
    first = ["f0", "sum1_0_0", "sum1_1_0", "sum1_2_0"]
    assert names[:8] == [*first, "f1", "sum1_0_1", "sum1_1_1", "sum1_2_1"]
    assert written_out(made) == written_out(tuple(lines()))  # the same operations in the same order: the same bits


def test_short_sums_and_single_ones_stay() -> None:
    for given in (lines(TERMS - 1), lines()[: TERMS + 1]):
        assert with_parallel_sums(given) == tuple(given)
