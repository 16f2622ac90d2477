"""Docstrings of the public interface: each has an example, which runs, names what it takes, and errors that exist."""

import builtins
import dataclasses
import doctest
import inspect
import pydoc
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import derive
from conftest import ROOT
from derive.registry import Registry
from derive.runtime.batched_functions import BatchedFunctions
from derive.runtime.implicit_functions import ImplicitFunctions
from derive.runtime.marker_functions import MarkerFunctions
from derive.spec.model.documentation import SECTIONS

LONG = {
    *("GeneralisedAlpha", "Ida", "casadi_function", "sweep", "SweepResult", "choose", "Choice"),
    *("study_accuracy", "LadderChart", "study_methods", "MethodStudy", "study_stability", "LadderStability"),
    *("study_frames", "FrameStudy", "study_pivots", "PivotStudy"),
}
"""Names whose examples take more than half a second of a processor."""
PUBLIC = [name for name in derive.__all__ if name != "__version__"]
RUN = [pytest.param(name, marks=[pytest.mark.long] if name in LONG else []) for name in PUBLIC]
FLAGS = doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS


PARTS = (ImplicitFunctions, BatchedFunctions, MarkerFunctions)
"""The bases of `Native` that are not public, whose examples continue its own."""


def methods(of: type) -> Iterator[tuple[str, Any]]:
    """The methods that a class defines and users call, without those that it inherits from public ones."""
    for name, member in (item for base in (of, *PARTS * (of is derive.Native)) for item in vars(base).items()):
        function = member.__func__ if isinstance(member, (staticmethod, classmethod)) else member
        if not name.startswith("_") and inspect.isfunction(function):
            yield name, function


def documented() -> Iterator[tuple[str, Any]]:
    """All public names and the methods of classes, with their objects."""
    for name in PUBLIC:
        shown = getattr(derive, name)
        yield name, shown
        if inspect.isclass(shown):
            yield from ((f"{name}.{method}", function) for method, function in methods(shown))
    yield from ((f"Registry.{name}", function) for name, function in methods(Registry))


DOCUMENTED = dict(documented())


def entries(docstring: str, section: str) -> dict[str, str]:
    """The entries of a section by their names, such as "q, v: the state (nq,), (nv,)", without indentation."""
    blocks = (block for block in docstring.split("\n\n") if block.startswith(f"{section}:\n"))
    lines = [line[4:] for block in blocks for line in block.splitlines()[1:]]
    heads = [line.partition(":") for line in lines if not line.startswith(" ")]
    return {name.strip(): text for names, _, text in heads for name in names.split(",")}


def example(name: str, docstring: str) -> doctest.DocTest:
    return doctest.DocTestParser().get_doctest(docstring, {}, name, None, None)


def parameters(function: Any) -> list[str]:
    return [name for name in inspect.signature(function).parameters if name not in ("self", "args")]


@pytest.mark.parametrize("name", DOCUMENTED)
def test_every_public_name_has_an_example_with_a_result(name: str) -> None:
    docstring = inspect.getdoc(DOCUMENTED[name]) or ""
    assert any(part.want for part in example(name, docstring).examples)
    assert docstring.count("Examples:\n    >>> ") == 1
    if "." not in name:
        assert "Examples:\n    >>> import derive\n" in docstring


@pytest.mark.parametrize("name", DOCUMENTED)
def test_every_argument_is_described(name: str) -> None:
    shown = DOCUMENTED[name]
    docstring = inspect.getdoc(shown) or ""
    if dataclasses.is_dataclass(shown):
        taken = [field.name for field in dataclasses.fields(shown) if field.init]
        assert set(taken) <= set(entries(docstring, "Attributes"))
    elif "." in name and inspect.isfunction(shown):
        holder = name.partition(".")[0]
        of = Registry if holder == "Registry" else getattr(derive, holder)
        common = {entry for base in of.__mro__ for entry in entries(inspect.getdoc(base) or "", "Arguments")}
        assert [p for p in parameters(shown) if p not in common and not re.search(rf"\b{p}\b", docstring)] == []
    elif inspect.isfunction(shown):
        assert set(parameters(shown)) == set(entries(docstring, "Arguments"))


@pytest.mark.parametrize("name", DOCUMENTED)
def test_documented_errors_exist_and_sections_have_their_order(name: str) -> None:
    docstring = inspect.getdoc(DOCUMENTED[name]) or ""
    for error in entries(docstring, "Raises"):
        known = getattr(builtins, error, None) or derive.__dict__.get(error) or _error(error)
        assert issubclass(known, Exception)
    heads = [block.partition(":\n")[0] for block in docstring.split("\n\n")]
    known_heads = [head for head in heads if head in SECTIONS]
    assert known_heads == sorted(known_heads, key=SECTIONS.index)
    assert len(known_heads) == len(set(known_heads))


def _error(name: str) -> Any:
    """The class of errors of the package with a name, wherever it is."""
    remaining = [derive.TisserandError]
    while remaining:
        of = remaining.pop()
        if of.__name__ == name:
            return of
        remaining += of.__subclasses__()
    raise AssertionError(f"there is no error {name}")


@pytest.mark.parametrize("name", [name for name in PUBLIC if dataclasses.is_dataclass(getattr(derive, name))])
def test_signatures_show_types_without_the_declarations_of_keys(name: str) -> None:
    assert "Annotated" not in str(inspect.signature(getattr(derive, name)))


def test_the_schema_describes_tables_without_sections_of_docstrings() -> None:
    schema = (ROOT / "scenes/schema.json").read_text(encoding="utf-8")
    assert "A rigid body in the plane" in schema
    assert [section for section in SECTIONS if f"{section}:" in schema] == []


@pytest.mark.parametrize("name", [name for name in PUBLIC if isinstance(getattr(derive, name), Registry)])
def test_help_of_a_registry_is_its_own(name: str) -> None:
    text = pydoc.render_doc(getattr(derive, name), renderer=pydoc.plaintext)
    assert f"derive.{name}.register(name, member)" in text
    assert "in the order of their registration" not in text


@pytest.mark.parametrize("name", RUN)
def test_examples(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The examples of methods continue that of their class, and those of the registries do as well."""
    monkeypatch.chdir(tmp_path)
    shown = getattr(derive, name)
    names = run(name, inspect.getdoc(shown) or "", {})
    if inspect.isclass(shown):
        for method, function in methods(shown):
            run(f"{name}.{method}", inspect.getdoc(function) or "", dict(names))
    if name == "JOINTS":
        for method, function in methods(Registry):
            run(f"Registry.{method}", inspect.getdoc(function) or "", dict(names))


def run(name: str, docstring: str, names: dict[str, Any]) -> dict[str, Any]:
    """Run the example of a docstring, and return the names that it defines. Failures are those of a test."""
    test = example(name, docstring)
    test.globs.update(names)
    report: list[str] = []
    with np.printoptions(legacy=False):
        result = doctest.DocTestRunner(optionflags=FLAGS).run(test, out=report.append, clear_globs=False)
    assert not result.failed, "".join(report)
    return test.globs
