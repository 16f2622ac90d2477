"""Each generated function says what it takes, what it gives and what it costs, and that is true."""

from __future__ import annotations

import ast
import hashlib
import json
import re

import pytest
from toolchain import EVERY_MODEL, MODELS, text_of

import beams
from derive.backends.c.source import ABI
from derive.backends.description import section_text
from derive.ir.kernel import Kernel, Output, Section
from derive.roles import Source


def flat(text: str) -> str:
    """Lines of a comment as one line, without the stars of C, which are behind a single blank."""
    return " ".join(re.sub(r"^ \*", "", line).strip() for line in text.splitlines())


def comments_of_c(made: beams.Made) -> dict[str, str]:
    """The comment above each function of a header."""
    found = re.findall(r"/\*((?:(?!\*/).)*)\*/\nint (\w+)\(", text_of(made, ".h"), re.DOTALL)
    return {name.removeprefix(f"{made.model.name}_"): flat(comment) for comment, name in found}


def functions_of_python(made: beams.Made) -> dict[str, ast.FunctionDef]:
    tree = ast.parse(text_of(made, ".py"))
    return {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef) and node.name[0] != "_"}


def said_of(output: Output) -> str:
    """How an output has to be described, up to its size."""
    if output.pattern is None:
        return f" {output.name}: {output.doc} ({output.size}): {', '.join(output.elements)}"
    size = f"{output.pattern.rows} x {output.pattern.cols}, {output.size} values"
    return f" {output.name}: {output.doc}, {size}"


def check(kernel: Kernel, comment: str) -> None:
    assert kernel.doc in comment
    for argument in kernel.arguments:
        size = "" if argument.scalar else f" ({argument.size})"
        assert f" {argument.name}: {argument.doc}{size}" in comment
    for output in kernel.outputs:
        assert said_of(output) in comment
    for section in kernel.sections:
        assert section.equation in comment
    assert re.findall(r"(\d+) operations\.", comment) == [str(kernel.operations)]


@pytest.mark.parametrize("model", EVERY_MODEL)
def test_header_describes_each_function(model: str) -> None:
    made = MODELS[model]()
    comments = comments_of_c(made)
    assert list(comments) == [*(kernel.name for kernel in made.model.kernels), "defaults"]
    for kernel in made.model.kernels:
        check(kernel, comments[kernel.name])


@pytest.mark.parametrize("model", EVERY_MODEL)
def test_python_describes_each_function(model: str) -> None:
    made = MODELS[model]()
    functions = functions_of_python(made)
    assert list(functions) == ["dense", *(kernel.name for kernel in made.model.kernels)]
    for kernel in made.model.kernels:
        function = functions[kernel.name]
        check(kernel, flat(ast.get_docstring(function) or ""))
        assert [a.arg for a in function.args.args] == [a.name for a in kernel.arguments]


@pytest.mark.parametrize("model", EVERY_MODEL)
def test_the_operations_that_are_counted_are_those_of_the_text(model: str) -> None:
    """Counted in the generated Python by its own parser: arithmetic on anything but two literals, and functions."""
    made = MODELS[model]()
    if made.model.lowering == "loops":
        return  # an operation on a whole axis is one in the text; tests/kernel/test_loops.py counts those of the loops
    tree = ast.parse(text_of(made, ".py"))
    functions = {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}
    for name in functions_of_python(made):
        if name in ("setup", "accel", "solve", "project_velocity", "dense"):
            continue  # these check, and Python checks in another way than C
        count = sum(is_operation(node) for statement in functions[f"_{name}"].body for node in ast.walk(statement))
        assert count == made.model.kernel(name).operations, name


def is_operation(node: ast.AST) -> bool:
    if isinstance(node, ast.BinOp):
        return not (is_literal(node.left) and is_literal(node.right))
    if isinstance(node, ast.UnaryOp):
        return not is_literal(node.operand)
    called = node.func if isinstance(node, ast.Call) else None
    return isinstance(called, ast.Attribute) and called.attr in ("sin", "cos", "sqrt")


def is_literal(node: ast.AST) -> bool:
    if isinstance(node, ast.UnaryOp):
        return is_literal(node.operand)
    return isinstance(node, ast.Constant)


@pytest.mark.parametrize("model", EVERY_MODEL)
def test_sections_are_told_in_the_code(model: str) -> None:
    made = MODELS[model]()
    for ending in (".c", ".py"):
        text = " ".join(line.strip(" #*/") for line in text_of(made, ending).splitlines())
        for kernel in made.model.kernels:
            assert all(section.doc in text for section in kernel.sections if ending == ".c" or section.name != "check")


@pytest.mark.parametrize("model", EVERY_MODEL)
def test_head_names_state_parameters_and_constants(model: str) -> None:
    made = MODELS[model]()
    for ending in (".h", ".py"):
        text = text_of(made, ending)
        head = flat(text[: text.index("Arrays may have" if ending == ".py" else "#ifndef")])
        for variable in (*made.model.coordinates, *made.model.parameters, *made.model.constants):
            assert re.search(rf"\b{variable.name} +(\[[^]]*\] +)?{re.escape(variable.doc)}", head), variable.name
        for zero in (*made.model.zeros, *made.model.vanished):
            assert zero.what in head
            assert zero.reason in head


@pytest.mark.parametrize("model", EVERY_MODEL)
def test_enum_of_the_header_gives_sizes_and_indices(model: str) -> None:
    made = MODELS[model]()
    macro = made.model.name.upper()
    found = {name: int(value) for name, value in re.findall(rf"^    {macro}_(\w+) = (\d+)", text_of(made, ".h"), re.M)}
    given = made.model
    tables = {"Q": given.coordinates, "V": given.velocities, "P": given.parameters, "K": given.constants}
    expected = {f"N{name}": sum(v.size for v in table) for name, table in tables.items()}
    expected |= {"NY": expected["NQ"] + expected["NV"] + len(given.multipliers)}
    expected |= {"NMARKERS": len(made.model.markers), "ABI": ABI}
    outputs = {"MASS": ("mass", "M"), "JACOBIAN": ("jacobian", "jac")}
    if given.bodies:
        expected |= {"NLAMBDA": len(given.multipliers), "NBODIES": len(given.bodies)}
        expected |= {f"LAMBDA_{m.name}": place for place, m in enumerate(given.multipliers)}
        outputs |= {"CONSTRAINT_JACOBIAN": ("constraint_jacobian", "G")}
        outputs |= {f"JACOBIAN_{form.upper()}": (f"jacobian_{form}", "jac") for form in ("ggl", "index1")}
    outputs |= {f"MARKER_{m.name.upper()}": (f"marker_{m.name}", "jacobian") for m in made.model.markers}
    expected |= {f"NNZ_{name}": len(made.model.pattern(*place).rowidx) for name, place in outputs.items()}
    for name in "QVPK":
        place = 0
        for variable in tables[name]:
            expected[f"{name}_{variable.name}"] = place
            place += variable.size
    assert found == expected


@pytest.mark.parametrize("model", EVERY_MODEL)
def test_manifest_tells_operations_and_digests(model: str) -> None:
    made = MODELS[model]()
    manifest = json.loads(text_of(made, "manifest.json"))
    assert manifest["operations"] == {kernel.name: kernel.operations for kernel in made.model.kernels}
    others = [file for file in made.files if not file.path.endswith("manifest.json")]
    assert manifest["files"] == {file.path: hashlib.sha256(file.text.encode()).hexdigest() for file in others}
    for file in others:
        assert manifest["specification_sha256"] in file.text[:300]


@pytest.mark.parametrize("model", EVERY_MODEL)
def test_files_are_tidy(model: str) -> None:
    for file in MODELS[model]().files:
        assert not re.search(r"[ \t]+$|\r|\t", file.text, re.MULTILINE)
        assert file.text.endswith("\n")
        assert not file.text.endswith("\n\n")


@pytest.mark.parametrize(
    ("source", "text"), [("(15)", "M (15): x"), (Source.APPENDIX, "M (appendix): x"), ("", "M: x")]
)
def test_a_section_names_its_equation_or_its_source(source: str, text: str) -> None:
    assert section_text(Section("M", source, "x", ())) == text
