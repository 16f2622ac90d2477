"""Statements over instances: what nothing reads is left out, and values in loops have names of their own."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

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


def beams(pairs: dict[str, list[str]], kind: str) -> derive.Scene:
    """Beams, the first one pinned to the ground, and others at its joints."""
    beam = {"ansatz": ["1", "xi", "xi^2"], "bending_stiffness": "1/5", "mass": "1/20", "length": "1/10"}
    names = {place.split(".")[0] for pair in pairs.values() for place in pair} | {"link_0"}
    return derive.scene(
        f"beams_{len(pairs)}_{kind}",
        ground={"origin": [0, 0]},
        bodies={name: {**beam, "markers": {"left": -1, "middle": 0, "right": 1}} for name in sorted(names)},
        joints={
            "pin": {"kind": "revolute", "between": ["ground.origin", "link_0.left"]},
            **{name: {"kind": kind, "between": between} for name, between in pairs.items()},
        },
    )


CHAIN = {f"joint_{k}": [f"link_{k}.right", f"link_{k + 1}.left"] for k in range(5)}
TREE = {"joint_0": ["link_0.right", "link_1.left"], "joint_1": ["link_0.middle", "link_2.left"]}


ONE = {"joint_0": CHAIN["joint_0"]}
CASES = [(pairs, kind) for kind in ("weld", "revolute") for pairs in ({}, ONE, CHAIN, TREE)]
QUICK = (({}, "weld"), (CHAIN, "revolute"), (TREE, "weld"))


@pytest.mark.parametrize(
    ("pairs", "kind"), [pytest.param(*case, marks=() if case in QUICK else pytest.mark.long) for case in CASES]
)
def test_loops_compile_without_warnings(tmp_path: Path, pairs: dict[str, list[str]], kind: str) -> None:
    """With markers, batches and forms: of a body alone, of paths, and of joints in any graph."""
    mechanism = derive.derive(beams(pairs, kind))
    assert isinstance(mechanism, Mechanism)
    model = lower_instances(mechanism)
    derive.write(CBackend().files(model, "a test"), tmp_path)
    compile_c([tmp_path / model.name / f"{model.name}.c"], tmp_path / "model.o", STRICT)
