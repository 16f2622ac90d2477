"""Statements over instances: what nothing reads is left out, and values in loops have names of their own."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest
from random_graphs import graph

import derive
from derive.backends.c.source import CBackend
from derive.ir.expressions import Element, Expr, Number, Operation, Operator, ScalarRef
from derive.ir.indices import constant, variable
from derive.ir.statements import Entry, ForEach, InstanceItem, Let, Require, Requirement, ReturnCode, StoreElement, Work
from derive.ir.unused import without_shadows, without_unused
from derive.lowering.instances.lower import lower_instances
from derive.mechanics.multibody.mechanism import Mechanism
from derive.runtime.compiler import compile_c

STRICT = ("-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror", "-O0", "-c")
"""The flags under which generated code compiles; warnings of unused variables need no optimisation."""
SEVEN = Number(Fraction(7))


def over(*body: InstanceItem, index: str = "i") -> ForEach:
    return ForEach(index, constant(0), constant(2), body)


def double(expr: Expr) -> Operation:
    return Operation(Operator.ADD, (expr, expr))


def stored(array: str, expr: Expr, index: str = "i") -> StoreElement:
    return StoreElement(Element(array, variable(index)), expr)


def test_what_nothing_reads_is_left_out() -> None:
    """Also a value of this name in another loop, where it is read, an integer, and an array with all that fills it."""
    read = over(Let("x", SEVEN), stored("out", ScalarRef("x")))
    idle = over(Let("x", SEVEN), Entry("n", "table", variable("i")), Let("y", ScalarRef("x")), stored("z", SEVEN))
    assert without_unused([(Work("z", 2), idle, read)], ["out"]) == [(read,)]


def test_what_a_later_section_reads_stays() -> None:
    first = (Work("z", 2), over(Let("x", SEVEN), stored("z", ScalarRef("x"))))
    second = (over(over(stored("out", Element("z", variable("j")), "j"), index="j")),)
    assert without_unused([first, second], ["out"]) == [first, second]


def test_requirements_and_what_they_read_stay() -> None:
    check = Require(Requirement.POSITIVE, ScalarRef("x"), ReturnCode.PIVOT, "x vanished")
    body = (over(Let("x", Element("given", variable("i"))), check),)
    assert without_unused([body], ["out"]) == [body]


def test_values_in_inner_loops_have_names_of_their_own() -> None:
    inner = over(Let("x", double(ScalarRef("x"))), stored("out", ScalarRef("x"), "j"), index="j")
    ((loop,),) = without_shadows([(over(Let("x", SEVEN), inner, stored("last", ScalarRef("x"))),)])
    assert isinstance(loop, ForEach)
    own = over(Let("x_2", double(ScalarRef("x"))), stored("out", ScalarRef("x_2"), "j"), index="j")
    assert loop.body == (Let("x", SEVEN), own, stored("last", ScalarRef("x")))


def chain(count: int) -> derive.Scene:
    """Beams that are welded to each other, the first one pinned to the ground, with and without joints behind it."""
    beam = {"ansatz": ["1", "xi", "xi^2"], "bending_stiffness": "1/5", "mass": "1/20", "length": "1/10"}
    markers = {"left": -1, "right": 1}
    pairs = {f"weld_{k}": [f"link_{k}.right", f"link_{k + 1}.left"] for k in range(count - 1)}
    return derive.scene(
        f"chain_{count}",
        ground={"origin": [0, 0]},
        bodies={f"link_{k}": {**beam, "markers": markers} for k in range(count)},
        joints={
            "pin": {"kind": "revolute", "between": ["ground.origin", "link_0.left"]},
            **{name: {"kind": "weld", "between": between} for name, between in pairs.items()},
        },
    )


@pytest.mark.parametrize("case", ["chain of 1", "chain of 2", "chain of 6", "graph"])
def test_loops_compile_without_warnings(tmp_path: Path, case: str) -> None:
    """With markers, batches and forms, and along paths sensitivities: of a body alone, of a path, and of any graph."""
    scene = graph(2, most=6).scene if case == "graph" else chain(int(case.rsplit(maxsplit=1)[1]))
    mechanism = derive.derive(scene)
    assert isinstance(mechanism, Mechanism)
    model = lower_instances(mechanism, sensitivities=case != "graph")
    derive.write(CBackend().files(model, "a test"), tmp_path)
    compile_c([tmp_path / model.name / f"{model.name}.c"], tmp_path / "model.o", STRICT)
