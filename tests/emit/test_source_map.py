"""Source maps say where statements stand in the emitted files: as reading the files back finds it."""

from __future__ import annotations

import ast
import json
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from read_back import sources

import beams
import derive
import free_block
from conftest import ROOT
from derive.artifacts import MARK, File
from derive.backends.c.source import CBackend
from derive.backends.model_files import BACKENDS, emit
from derive.backends.protocol import Backend
from derive.backends.python.backend import PythonBackend
from derive.backends.source_map import (
    FunctionLines,
    SourceBuilder,
    SourceFile,
    SourceLine,
    SourceMap,
    StoredValue,
    plain,
    source_map,
    storing,
)
from derive.ir.kernel import Kernel
from derive.ir.model import Model
from derive.ir.statements import Accumulate, Let, Map, MatrixStore, MatVec, Store, StoreLocal
from derive.registry import UnknownNameError

MODELS: dict[str, Callable[[], Model]] = {
    "beam, mean frame": lambda: beams.made("mean", 3).model,
    "beam, point frame": lambda: beams.made("point", 2).model,
    "block, flat": lambda: free_block.model("point", "flat", 2),
    "block, loops": lambda: free_block.model("mean", "loops", 5),
    "block, loops, point frame": lambda: free_block.model("point", "loops", 3),
    "symbolic body, loops": lambda: lowered("body_symbolic"),
    "scene": lambda: lowered("double_pendulum"),
}


def lowered(name: str) -> Model:
    return beams.build(derive.read(ROOT / "scenes" / f"{name}.toml")).model


@pytest.fixture(params=MODELS, scope="module")
def model(request: pytest.FixtureRequest) -> Model:
    return MODELS[request.param]()


def emitted(backend: Backend, model: Model) -> tuple[SourceMap, str]:
    """The map and the text of the file that has one."""
    (file,) = (file for file in backend.files(model, "test") if isinstance(file, SourceFile))
    assert file.source_map.path == file.path and file.source_map.language == backend.name
    return file.source_map, file.text


def names_defined(kernel: Kernel) -> Iterator[str]:
    """All names that statements of a kernel give to values."""
    for statement in kernel.statements:
        match statement:
            case Let():
                yield statement.name
            case Map():
                yield from (item.name for item in statement.body if isinstance(item, Let))
                yield from (item.array for item in statement.body if isinstance(item, StoreLocal))
            case Accumulate():
                yield from (item.name for item in (*statement.lets, *statement.sums))
            case MatVec():
                yield from (term.name for term in statement.terms)
            case _:
                pass


def test_the_map_of_c_is_what_reading_it_back_finds(model: Model) -> None:
    found, text = emitted(CBackend(), model)
    expected = sources(f"{model.name}.c", text, model.name)
    assert list(found.functions) == [kernel.name for kernel in model.kernels]
    for name, function in found.functions.items():
        read = expected.functions[name]
        assert (function.first, tuple(line.text for line in function.lines)) == (read.first, read.lines)
        stores = {(s.output, s.index, s.over_modes): n for s, n in function.stores.items() if s.output in ("M", "h")}
        assert stores == read.stores
        defined = {*names_defined(model.kernel(name))}
        assert dict(function.definitions) == {n: line for n, line in read.definitions.items() if n in defined}
        assert defined == {*function.definitions}


def test_the_map_of_python_is_what_its_parser_finds(model: Model) -> None:
    found, text = emitted(PythonBackend(), model)
    functions = {node.name: node for node in ast.parse(text).body if isinstance(node, ast.FunctionDef)}
    for name, function in found.functions.items():
        nodes = [functions[own] for own in (name, f"_{name}") if own in functions]
        assert (function.first, function.last) == (nodes[0].lineno, nodes[-1].end_lineno)
        assigned = lines_that_assign(nodes[-1])
        for defined, number in function.definitions.items():
            assert number in assigned[defined]
        counted = {output.name for output in model.kernel(name).outputs if output.count is not None}
        for stored, number in function.stores.items():
            target = stored.output if stored.output in counted else f"{stored.output}_{stored.index}"
            assert number in assigned[target]


def lines_that_assign(node: ast.FunctionDef) -> dict[str, set[int]]:
    """The first lines of assignments to each name or to elements of it."""
    found: dict[str, set[int]] = {}
    for child in ast.walk(node):
        if isinstance(child, ast.Assign):
            target = child.targets[0]
            base = target.value if isinstance(target, ast.Subscript) else target
            if isinstance(base, ast.Name):
                found.setdefault(base.id, set()).add(child.lineno)
    return found


def is_matrix_store(function: FunctionLines, line: SourceLine) -> bool:
    return isinstance(function.statement(line), MatrixStore)


@pytest.mark.parametrize("backend", [CBackend(), PythonBackend()], ids=lambda backend: backend.name)
def test_lines_know_their_statements(model: Model, backend: Backend) -> None:
    """Each statement stands in lines one after the other, in its section; matrices may be stored within products."""
    found, _ = emitted(backend, model)
    for kernel in model.kernels:
        function = found.functions[kernel.name]
        seen = [line for line in function.lines if line.statement is not None]
        places = [(line.section, line.statement) for line in seen]
        begun = list(dict.fromkeys(places))
        assert begun == sorted(begun)
        others = [place for place, line in zip(places, seen, strict=True) if not is_matrix_store(function, line)]
        assert others == sorted(others)
        for line in seen:
            section, statement = function.section(line), function.statement(line)
            assert section is not None and statement in section.body
            if isinstance(statement, Let) and line.defines:
                assert line.defines == statement.name
            if isinstance(statement, Store) and line.stores:
                assert line.stores == StoredValue(statement.output, statement.index)
        stored = [statement for statement in kernel.statements if isinstance(statement, Store)]
        assert {(s.output, s.index) for s in stored} <= {(s.output, s.index) for s in function.stores}


@pytest.mark.parametrize("backend", [CBackend(), PythonBackend()], ids=lambda backend: backend.name)
def test_lines_know_their_terms(model: Model, backend: Backend) -> None:
    """Each term of the equations is in the lines that store its values, and each line that stores M or h has terms."""
    found, _ = emitted(backend, model)
    of_h, of_m = (
        {(t.row, t.name) for line in found.functions[name].lines if line.stores for t in line.terms}
        for name in ("force", "mass")
    )
    assert of_h.isdisjoint(of_m) and of_h | of_m == {(t.row, t.name) for t in model.terms} != set()
    for line in found.functions["mass"].lines:
        assert bool(line.terms) == bool(line.stores and line.stores.output == "M")


def test_terms_of_the_lines_of_a_beam() -> None:
    """In a point frame, the translation of the first row couples with the rotation, (15)."""
    functions = source_map(beams.made("point", 2).files, "c").functions
    entries = beams.made("point", 2).model.pattern("mass", "M").entries
    rows = [row.name for row in beams.made("point", 2).equations.rows]
    for line in functions["mass"].lines:
        if line.stores:
            i, j = entries[line.stores.index]
            assert {t.row for t in line.terms} <= {rows[i], rows[j]}
    for line in functions["force"].lines:
        if line.stores:
            assert all(t.row == rows[line.stores.index] and t.name not in ("translation", "Euler") for t in line.terms)


def test_the_map_is_found_by_its_language() -> None:
    files = beams.made("mean", 2).files
    assert source_map(files, "c").path == "beam_mean_2/beam_mean_2.c"
    assert source_map(files, "python").path == "beam_mean_2/beam_mean_2.py"
    with pytest.raises(ValueError, match="cobol"):
        source_map(files, "cobol")


# A backend from outside the package


class Outline:
    """Lists what each kernel stores, as JSON that is easy to read line by line."""

    name = "outline"

    def file_names(self, model: str) -> tuple[str, ...]:
        return (f"{model}/{model}.json",)

    def files(self, model: Model, fingerprint: str) -> tuple[File, ...]:
        builder = SourceBuilder(model)
        builder.text(f'{{"generator": "{MARK}", "specification": "{fingerprint}",\n')
        for kernel in model.kernels:
            lines = plain(f'"{kernel.name}": [')
            for k, section in enumerate(kernel.sections):
                for n, statement in enumerate(section.body):
                    if isinstance(statement, Store):
                        text = f'    ["{statement.output}", {statement.index}],'
                        lines += [line.of(k, n) for line in storing([text], statement.output, statement.index)]
            builder.function(kernel, [*lines, *plain("    null],")])
        builder.text('"end": null}\n')
        (path,) = self.file_names(model.name)
        return (builder.file(self.name, path),)


@pytest.fixture
def outline() -> Iterator[Any]:
    BACKENDS.register("outline", Outline())
    yield
    BACKENDS.unregister("outline")


@pytest.mark.usefixtures("outline")
def test_a_backend_from_outside_emits_a_file_and_its_map() -> None:
    made = beams.made("mean", 2)
    *files, manifest = emit(made.model, made.spec, ("c", "outline"))
    (names,) = ([file.path for file in files],)
    assert names == [*CBackend().file_names("beam_mean_2"), *Outline().file_names("beam_mean_2")]
    assert set(json.loads(manifest.text)["files"]) == {*names}
    content = json.loads(files[-1].text)
    assert content["mass"] == [*(["M", k] for k in range(5)), None]
    function: FunctionLines = source_map(files, "outline").functions["force"]
    lines = files[-1].text.splitlines()
    assert function.stores == {StoredValue("h", k): function.first + 1 + k for k in range(len(function.stores))}
    assert (
        lines[function.first - 1] == '"force": [' and lines[function.stores[StoredValue("h", 3)] - 1] == '    ["h", 3],'
    )


def test_an_unknown_backend_is_an_error_that_names_the_known_ones() -> None:
    made = beams.made("mean", 2)
    with pytest.raises(UnknownNameError, match='there is no backend "fortran"; known: c, python'):
        emit(made.model, made.spec, ("fortran",))
