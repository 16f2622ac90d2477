"""Operations wait for few others: processors compute those at once that do not, and each division takes many cycles."""

from __future__ import annotations

from pathlib import Path

import pytest

import derive
from derive.ir.expressions import Expr, Number, Operation, Operator, ScalarRef, walk
from derive.ir.kernel import Kernel
from derive.ir.statements import Let, Require, Store
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.graph import Graph
from derive.lowering.flat.lower import lower
from derive.lowering.flat.schedule import EarlyValue, OutputValue, Step, schedule
from derive.mechanics.multibody.mechanism import Mechanism
from derive.mechanics.symbols import local

SCENE = Path(__file__).parents[2] / "scenes" / "crank_slider_3.toml"


@pytest.fixture(scope="module")
def accelerations() -> Kernel:
    """The accelerations of the crank-slider with three beams in straight line."""
    mechanism = derive.derive(derive.read(SCENE))
    assert isinstance(mechanism, Mechanism)
    return lower(mechanism.expanded(), explicit=True).kernel("accel")


def test_the_longest_chain_of_the_crank_slider(accelerations: Kernel) -> None:
    """Its operations are as they are today; a smaller number is progress."""
    depths: dict[str, int] = {}

    def depth(expr: Expr) -> int:
        if isinstance(expr, ScalarRef):
            return depths.get(expr.name, 0)
        return 1 + max(map(depth, expr.args)) if isinstance(expr, Operation) else 0

    longest = 0
    for statement in accelerations.statements:
        if isinstance(statement, Let):
            depths[statement.name] = depth(statement.expr)
        elif isinstance(statement, Store):
            longest = max(longest, depth(statement.expr))
    assert longest == 53


def test_numbers_are_factors_and_no_divisors(accelerations: Kernel) -> None:
    every = (part for s in accelerations.statements if isinstance(s, Let | Store) for part in walk(s.expr))
    divisors = [part.args[1] for part in every if isinstance(part, Operation) and part.kind is Operator.DIV]
    assert divisors and not any(isinstance(divisor, Number) for divisor in divisors)


def test_pivots_are_checked_where_nothing_waits_for_them(accelerations: Kernel) -> None:
    """A branch keeps compilers from moving operations, so that all are in the last section."""
    *others, last = accelerations.sections
    assert sum(isinstance(s, Require) for s in last.body) == 14
    assert not any(isinstance(s, Require) for section in others for s in section.body)


def test_right_hand_sides_are_eliminated_with_the_pivots(accelerations: Kernel) -> None:
    """Operations that do not wait for a pivot are computed while its division runs, if it stands near."""
    pivots = next(section for section in accelerations.sections if section.name == "pivots")
    lets = [s for s in pivots.body if isinstance(s, Let)]
    velocities = [k for k, s in enumerate(lets) if any(part == ScalarRef("rod_1_phidot") for part in walk(s.expr))]
    last = max(k for k, s in enumerate(lets) if s.name.startswith("pivot_"))
    assert velocities and min(velocities) < last


@pytest.mark.parametrize("used", [True, False])
def test_an_early_value_is_computed_in_its_step_if_another_needs_it(used: bool) -> None:
    symbols = Symbols(frozenset(), frozenset())
    for name in "xy":
        symbols.input(local(name), ScalarRef(name))
    x, y = symbols.values_of([local("x"), local("y")])
    product = x * y
    results = [product + x, product * product] if used else [x, y]
    steps = (
        Step("first", "", "", (EarlyValue(product), OutputValue("out", 0, x + y))),
        Step("second", "", "", tuple(OutputValue("out", k + 1, value) for k, value in enumerate(results))),
    )
    first, _ = schedule(Graph(), symbols, (), steps)
    names = [s.name for s in first.body if isinstance(s, Let)]
    assert names == (["t1"] if used else [])
