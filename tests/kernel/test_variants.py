"""The forms of the equations of a scene in loops over instances: one text computes them all, and keeps their bits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from random_graphs import graph, ring_of_rods
from toolchain import C99, WARNINGS

from derive.artifacts import write
from derive.backends.c.forms import KINDS, shared_forms
from derive.backends.c.nests import CNests
from derive.backends.c.source import CBackend
from derive.backends.source_map import source_map
from derive.ir.expansion import expand
from derive.ir.expressions import Element, Number, Operator
from derive.ir.indices import constant, variable
from derive.ir.interpreter import interpret
from derive.ir.kernel import Argument, ConstantArray, Kernel, Output, Section
from derive.ir.loop_nests import Assign, If, Integer, Node, every, ordered_loop
from derive.ir.model import Model
from derive.ir.statements import Clear, ForEach, StoreElement
from derive.ir.variants import Variants, variants
from derive.lowering.instances.loop_code.class_code import INSTANCE
from derive.runtime.compiler import compile_c

FORMS = ("", "_ggl", "_index1")
RING = 500
"""The number of a ring of rods whose elements are not equally spaced in the iteration matrices."""
SEEDS = ((0, False), (9, False), (57, True), (RING, False))
"""Seeds, and whether their joints are varying."""


@cache
def loops(seed: int, varying: bool) -> Model:
    return (ring_of_rods(5, [0, 2, 1, 3, 4]) if seed == RING else graph(seed, 4, varying=varying)).instances


def kernels(model: Model, kind: str) -> list[Kernel]:
    return [model.kernel(f"{kind}{form}") for form in FORMS]


def shared(kernels: Sequence[Kernel]) -> Variants:
    result = variants(kernels)
    assert result
    return result


def selected(
    of: Variants, number: int, arguments: Mapping[str, Any], first: Sequence[Node] = ()
) -> dict[str, list[Any]]:
    """The results of the statements of all kernels for one of them; first: statements before these."""
    kernel, selector = of.kernels[number], Argument(of.selector, (), "the kernel", scalar=True, integer=True)
    before = (node for statement in of.before[number] for node in expand(statement))
    constants = dict.fromkeys(array for own in of.kernels for array in own.constants)
    whole = replace(kernel, arguments=(selector, *kernel.arguments), constants=(*constants, *of.tables))
    return interpret(whole, {**arguments, of.selector: number}, nodes=[*first, *before, *of.nodes])


@pytest.mark.parametrize(("seed", "varying"), SEEDS)
@pytest.mark.parametrize("kind", KINDS)
def test_each_form_has_the_bits_of_its_own_function(kind: str, seed: int, varying: bool) -> None:
    of, rng = shared(kernels(loops(seed, varying), kind)), np.random.default_rng(seed)
    for number, kernel in enumerate(of.kernels):
        given = {a.name: rng.uniform(-1, 1, a.size).tolist() for a in kernel.arguments if not a.scalar}
        given |= {a.name: rng.uniform() for a in kernel.arguments if a.scalar}
        found, expected = selected(of, number, given), interpret(kernel, given)
        for name, values in expected.items():
            assert None not in values
            assert np.array(found[name], float).tobytes() == np.array(values, float).tobytes(), (kernel.name, name)


@pytest.mark.parametrize(("seed", "varying"), SEEDS)
@pytest.mark.parametrize(("kind", "share"), [("residual", 0.7), ("jacobian", 0.75)])
def test_what_forms_have_in_common_is_written_once(kind: str, share: float, seed: int, varying: bool) -> None:
    of = shared(kernels(loops(seed, varying), kind))
    alone = sum(count(node for s in kernel.statements for node in expand(s)) for kernel in of.kernels)
    assert count(of.nodes) < share * alone


def count(nodes: Any) -> int:
    """The plain statements, besides those that place others."""
    return sum(not isinstance(node, Integer | If) for node in every(nodes))


def test_the_functions_of_the_forms_call_one_function() -> None:
    model = loops(0, False)
    files = CBackend().files(model, "a test")
    functions = source_map(files, "c").functions
    (text,) = (file.text for file in files if file.path.endswith(".c"))
    for kind in KINDS:
        assert text.count(f"TISSERAND_OF_FORMS int {model.name}_{kind}_of_forms(") == 1
        for number, form in enumerate(FORMS):
            (call,) = (line.text for line in functions[f"{kind}{form}"].lines if "_of_forms(" in line.text)
            assert f"_of_forms({number}, t, y, ydot, " in call
            assert not any("tisserand_cos" in line.text for line in functions[f"{kind}{form}"].lines)
    assert not shared_forms(replace(model, lowering="flat"))


@pytest.mark.parametrize("flags", [(), ("-DTISSERAND_WITHOUT_REDUCED_FORMS",)], ids=["all forms", "one form"])
def test_there_are_no_warnings(flags: tuple[str, ...], tmp_path: Path) -> None:
    """Compilers find nothing unused: no table of a form that the table of all forms replaces, and no selector."""
    model = loops(RING, False)
    write(CBackend().files(model, "a test"), tmp_path)
    source, library = tmp_path / model.name / f"{model.name}.c", tmp_path / "model.so"
    compile_c([source], library, [*C99, *WARNINGS, "-O0", "-shared", "-fPIC", *flags])


def test_loops_that_do_not_match_share_nothing() -> None:
    """Kernels whose loops have other bounds, or read what they write, have functions of their own."""
    first, second, third = kernels(loops(0, False), "residual")
    (section,) = second.sections
    *others, last = section.body
    assert isinstance(last, ForEach)
    longer = replace(last, stop=last.stop.plus(1))
    (target, *_) = (item.target for item in last.body if isinstance(item, StoreElement))
    reading = replace(last, body=(*last.body, StoreElement(target, target)))
    for changed in (longer, reading):
        body = (*others, changed)
        kernel = replace(second, sections=(replace(section, body=body),))
        assert variants([first, kernel, third]) is None
    assert shared([first, second, third]).differ
    assert not shared([first, first, first]).differ


def number(value: int) -> Number:
    return Number(Fraction(value))


def test_assignments_to_one_element_stay_in_order() -> None:
    """An element gets what all kernels do to it behind what one of them does to it first."""
    first, second = (Element("F", constant(k)) for k in range(2))
    start = [Assign(element, number(1)) for element in (first, second)]
    sets, adds = StoreElement(first, number(3)), StoreElement(first, number(1), Operator.ADD)
    doubles, other = StoreElement(first, number(2), Operator.MUL), StoreElement(second, number(5))
    bodies = [(sets, adds, other), (sets, doubles, adds, other), (adds, doubles, other)]
    loops = [ForEach("i", constant(0), constant(1), body) for body in bodies]
    results = (Output("F", (), "", count=2),)
    of = shared([Kernel("f", "", (), results, (Section("s", "", "", (loop,)),)) for loop in loops])
    assert [selected(of, k, {}, start)["F"] for k in range(3)] == [[4, 5], [7, 5], [4, 5]]


def test_a_name_of_the_kernels_is_no_name_of_the_selector() -> None:
    """A parameter that is called like the integer that selects a kernel keeps its name."""
    own = kernels(loops(0, False), "residual")
    named = [replace(k, arguments=(*k.arguments, Argument("p", ("variant",), "a parameter"))) for k in own]
    assert shared(own).selector == "variant"
    assert shared(named).selector == "variant_2"


def test_places_of_the_iterations_come_from_tables_where_distances_differ() -> None:
    """A row of the first table has a number for each kernel; the others have the places of all iterations in each."""
    assert len(shared(kernels(loops(0, False), "jacobian")).tables) == 1
    of = shared(kernels(loops(RING, False), "jacobian"))
    (first, *others) = of.tables
    strides = {node.array: node.index.stride(of.selector) for node in every(of.nodes) if isinstance(node, Integer)}
    assert len(first.values) % len(FORMS) == 0 and strides[first.name] == 1
    assert {strides[table.name] for table in others} == {3}  # the rods that have one loop


def test_tables_have_the_places_and_the_text_the_distances_from_them() -> None:
    """Numbers that grow with the number of bodies are no text."""
    of = shared(kernels(loops(0, False), KINDS[1]))
    targets = [node.target for node in every(of.nodes) if isinstance(node, Assign) and isinstance(node.target, Element)]
    names = [node.name for node in every(of.nodes) if isinstance(node, Integer) and node.name.startswith("place")]
    firsts = {
        name: min(e.index.offset for e in targets if e.index and e.index.has(name) and not e.index.stride(INSTANCE))
        for name in names
        if any(e.index and e.index.has(name) and not e.index.stride(INSTANCE) for e in targets)
    }
    assert firsts and set(firsts.values()) == {0}


def test_an_integer_may_be_multiplied_by_the_variable_of_a_loop() -> None:
    """Steps that differ from kernel to kernel are elements of a table, in the interpreter and in C."""
    at = Integer("at", "steps", constant(1), "i")
    loop = ordered_loop("i", 3, [at, Assign(Element("F", variable("at")), number(7))])
    kernel = Kernel("f", "", (), (Output("F", (), "", count=5),), (), (ConstantArray("steps", (3, 2), True),))
    assert interpret(kernel, {}, nodes=[loop])["F"] == [7, None, 7, None, 7]
    assert "    const int at = steps[1] * i;" in [line.text.removeprefix("    ") for line in CNests().lines([loop])]
    assert [at.factor({"i": 5}), replace(at, times="").factor({"i": 5})] == [5, 1]


def test_a_part_of_an_output_is_set_to_zero() -> None:
    kernel = Kernel("f", "", (), (Output("F", (), "", count=5),), ())
    assert interpret(kernel, {}, nodes=expand(Clear("F", 2, 1)))["F"] == [None, 0, 0, None, None]
