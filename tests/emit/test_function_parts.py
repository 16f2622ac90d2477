"""Long functions in straight-line code are divided into static functions, with the bits of the whole function."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from toolchain import C99

import beams
import derive
from conftest import ROOT
from derive.artifacts import File
from derive.backends.c import function_parts
from derive.backends.c.function_parts import LENGTH, NumberedNodes, divided_function
from derive.backends.c.source import CBackend
from derive.backends.source_map import StoredValue, source_map
from derive.ir.expansion import expand
from derive.ir.kernel import Kernel
from derive.ir.model import Model
from derive.runtime.loading import load_scene

STRICT = (*C99, "-O0", "-ffp-contract=off")


@pytest.fixture(scope="module")
def model() -> Model:
    return beams.build(derive.read(ROOT / "scenes" / "double_pendulum.toml")).model


def divided(model: Model, monkeypatch: pytest.MonkeyPatch) -> tuple[File, ...]:
    """The C of a model with short parts."""
    monkeypatch.setattr(function_parts, "LENGTH", 15)
    monkeypatch.setattr(function_parts, "LONG", 30)
    return CBackend().files(model, "a test")


def statements(kernel: Kernel) -> list[NumberedNodes]:
    return [
        NumberedNodes(k, n, tuple(expand(statement)))
        for k, section in enumerate(kernel.sections)
        for n, statement in enumerate(section.body)
    ]


def test_parts_have_the_bits_and_the_codes_of_the_whole(model: Model, monkeypatch: pytest.MonkeyPatch) -> None:
    """Values that later parts need come through, and a requirement within a part ends the function."""
    whole = load_scene(CBackend().files(model, "a test"), STRICT)
    files = divided(model, monkeypatch)
    text = next(file.text for file in files if file.path.endswith(".c"))
    assert all(f"{model.name}_{name}_part_3(" in text for name in ("accel", "solve", "jacobian"))
    parts = load_scene(files, STRICT)
    rng = np.random.default_rng(0)
    for _ in range(3):
        q, v = rng.uniform(-1, 1, whole.nq), rng.uniform(-1, 1, whole.nv)
        k = whole.setup()
        assert parts.accel(0.5, q, v, k).tobytes() == whole.accel(0.5, q, v, k).tobytes()
        ours, theirs = parts.solve(0.5, q, v, k), whole.solve(0.5, q, v, k)
        assert [x.tobytes() for x in ours] == [x.tobytes() for x in theirs]
    with pytest.raises(derive.TisserandError) as failed:
        parts.accel(0.5, q * np.nan, v, k)
    with pytest.raises(type(failed.value)) as expected:
        whole.accel(0.5, q * np.nan, v, k)
    assert str(failed.value) == str(expected.value)


def test_lines_of_parts_are_those_of_their_statements(model: Model, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = source_map(CBackend().files(model, "a test"), "c").functions["accel"]
    files = divided(model, monkeypatch)
    parts = source_map(files, "c").functions["accel"]
    text = next(file.text for file in files if file.path.endswith(".c")).splitlines()
    assert all(text[number - 1] == line.text for number, line in parts.numbered)
    assert parts.stores.keys() == whole.stores.keys() >= {StoredValue("vdot", 0)}
    assert parts.definitions.keys() == whole.definitions.keys()
    by_statement = [{(n.section, n.statement) for _, n in of.numbered} - {(None, None)} for of in (parts, whole)]
    assert by_statement[0] == by_statement[1]


def test_only_long_functions_are_divided(model: Model) -> None:
    """Into parts of about equal length, which together have all statements in their order."""
    kernel = model.kernel("accel")
    body = statements(kernel)
    assert divided_function("f", kernel, body, ()) is None
    repeated = [replace(item, statement=n) for n in range(60) for item in body]
    function = divided_function("f", kernel, repeated, ())
    assert function
    assert [item for part in function.parts for item in part.body] == repeated
    assert all(0.8 * LENGTH < sum(item.length for item in part.body) < 1.2 * LENGTH for part in function.parts)


def test_places_are_used_again(model: Model, monkeypatch: pytest.MonkeyPatch) -> None:
    """A value keeps its place up to the last part that reads it, and no longer."""
    monkeypatch.setattr(function_parts, "LENGTH", 15)
    monkeypatch.setattr(function_parts, "LONG", 30)
    kernel = model.kernel("jacobian")
    function = divided_function("f", kernel, statements(kernel), ())
    assert function
    stored = [name for part in function.parts for name in part.stored]
    assert len(stored) == len(set(stored)) > function.places
