"""Dense bodies in space: their sums over the modes are rows of one table, which loops of the generated C compute."""

from __future__ import annotations

import random
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from clouds import write_cloud

import derive
from conftest import ROOT
from derive.backends.c import function_parts
from derive.backends.c.beginnings import repeated_functions
from derive.backends.c.linear_sums import NO_SUMS, TOGETHER, KernelSums, LinearSums, linear_sums
from derive.backends.c.source import CBackend
from derive.ir.analysis import expressions
from derive.ir.expressions import Element, Expr, Operation, Operator, walk
from derive.ir.interpreter import interpret
from derive.ir.kernel import Kernel
from derive.ir.linear_forms import Row
from derive.ir.model import Model
from derive.model_lowering import lower
from derive.runtime.loading import load_scene
from derive.spec.toml.read import parse

MODES, POINTS = 5, 8
BODY = """
[bodies.{name}]
nodes = "{folder}/{file}.npz"
units = "SI"
markers = {{ left = {{ nodes = [0, 1, 2] }}, right = {{ nodes = [5, 6, 7] }} }}
"""


def model_of(folder: Path, *files: str, explicit: bool = True) -> Model:
    """The model of free bodies with these files."""
    for seed, file in enumerate(dict.fromkeys(files)):
        write_cloud(folder / f"{file}.npz", seed, POINTS, MODES)
    bodies = (BODY.format(name=f"body{k}", folder=folder, file=file) for k, file in enumerate(files))
    head = ['name = "clouds"', "[scene]", "gravity = [0, 0, -9]", "[ground.markers]", "o = [0, 0, 0]"]
    text = "\n".join([*head, *bodies])
    return lower(derive.derive(parse(text)), explicit=explicit)


@dataclass(frozen=True)
class Summed:
    """A model and its sums."""

    model: Model
    sums: LinearSums

    def rows(self, kernel: str) -> set[Row]:
        """The rows that a kernel reads."""
        return {row for values in self.sums.kernels[kernel].parts.values for row in values.rows}


def summed(model: Model) -> Summed:
    return Summed(model, linear_sums(model))


@pytest.fixture(scope="module")
def single(tmp_path_factory: pytest.TempPathFactory) -> Summed:
    """All functions of a body."""
    return summed(model_of(tmp_path_factory.mktemp("one"), "a", explicit=False))


@pytest.fixture(scope="module")
def alike(tmp_path_factory: pytest.TempPathFactory) -> Summed:
    """Two bodies of one file."""
    return summed(model_of(tmp_path_factory.mktemp("alike"), "a", "a"))


def values(kernel: Kernel, seed: int) -> dict[str, Fraction | list[Fraction]]:
    """Random fractions for the arguments of a kernel."""
    rng = random.Random(seed)

    def number() -> Fraction:
        return Fraction(rng.randint(-9, 9), 7)

    return {a.name: number() if a.scalar else [number() for _ in range(a.size)] for a in kernel.arguments}


def test_values_are_exactly_those_of_straight_line_code(single: Summed) -> None:
    """In fractions, of all functions that have such sums, derivatives among them."""
    for seed, (name, of) in enumerate(single.sums.kernels.items()):
        given = values(of.kernel, seed)
        expected = interpret(single.model.kernel(name), given, number=Fraction, check=False)
        assert interpret(of.kernel, given, number=Fraction, check=False, nodes=of.nodes()) == expected
    rigid = {"setup", "rates", "poses"}
    bare = {"constraints", "constraint_rates", "constraint_jacobian", "constraint_bias"}
    at_markers = {f"{what}_body0_{end}" for what in ("marker", "load") for end in ("left", "right")}
    assert single.sums.kernels.keys() == {k.name for k in single.model.kernels} - rigid - bare - at_markers


def test_a_second_body_of_a_file_adds_no_rows(single: Summed, alike: Summed) -> None:
    """Both bodies and all functions read one table."""
    (table,) = alike.sums.tables
    assert table.columns == MODES
    assert single.rows("accel") == alike.rows("accel") <= {*table.rows}
    assert len(alike.rows("accel")) >= 9 * MODES  # S has six components, d3 three
    calls = alike.sums.kernels["accel"].calls
    of_first, of_second = ([c for c in calls if c.window.first == first] for first in (7, 14 + MODES))
    assert of_first and [(c.first, c.count) for c in of_first] == [(c.first, c.count) for c in of_second]


def test_the_static_function_is_written_once(alike: Summed) -> None:
    text = next(file.text for file in CBackend().files(alike.model, "a test") if file.path.endswith(".c"))
    assert text.count(f"TISSERAND_SHARED void clouds_sums_of_{MODES}(") == 1
    assert text.count("static const double clouds_sums") == 1
    again = repeated_functions(alike.model)  # whose functions call others
    calls = sum(len(of.calls) for name, of in alike.sums.kernels.items() if name not in again)
    assert text.count(f"    clouds_sums_of_{MODES}(") == calls


def test_blocks_without_needed_rows_are_not_computed(single: Summed) -> None:
    for name, of in single.sums.kernels.items():
        for array in of.parts.values:
            read = {k // TOGETHER for k in array.rows.values()}
            assert len(read) == sum(call.count for call in of.calls if call.array == array.array), name


def test_batches_have_the_bits_of_single_calls(alike: Summed) -> None:
    """Both add the products of a row in the order of its elements."""
    files = CBackend().files(alike.model, "a test")
    native = load_scene(files, ("-std=c99", "-O1", "-ftree-vectorize", "-ffp-contract=off"))
    rng = np.random.default_rng(2)
    q, v, k = rng.uniform(-1, 1, (11, native.nq)), rng.uniform(-1, 1, (11, native.nv)), native.setup()
    for name, given in {"mass": (q,), "force": (0.5, q, v), "accel": (0.5, q, v), "energy": (q, v)}.items():
        batch = getattr(native, f"{name}_batch")(*given, k)
        for b, row in enumerate(batch):
            single = getattr(native, name)(*(x if isinstance(x, float) else x[b] for x in given), k)
            assert row.tobytes() == single.tobytes(), name


def test_parts_of_a_function_read_the_sums(alike: Summed, monkeypatch: pytest.MonkeyPatch) -> None:
    """With the bits of the function in one part."""
    flags = ("-std=c99", "-O0", "-ffp-contract=off", "-DTISSERAND_WITHOUT_BATCHES")
    whole = load_scene(CBackend().files(alike.model, "a test"), flags)
    monkeypatch.setattr(function_parts, "LENGTH", 100)
    monkeypatch.setattr(function_parts, "LONG", 200)
    files = CBackend().files(alike.model, "a test")
    assert any("clouds_accel_part_3(" in file.text for file in files)
    parts = load_scene(files, flags)
    rng = np.random.default_rng(3)
    q, v, k = rng.uniform(-1, 1, whole.nq), rng.uniform(-1, 1, whole.nv), whole.setup()
    assert parts.accel(0.5, q, v, k).tobytes() == whole.accel(0.5, q, v, k).tobytes()


def test_bodies_with_few_integrals_keep_straight_line_code() -> None:
    """The modes of a symmetric rod have few factors in each sum."""
    model = lower(derive.derive(derive.read(ROOT / "examples" / "spatial_crank_slider.toml")), explicit=True)
    assert linear_sums(model) == NO_SUMS


def test_rows_have_the_signs_that_their_argument_needs(single: Summed) -> None:
    """Few values are negated; rows of velocities, whose signs differ from those of positions, share no block."""
    sums = single.sums.kernels["accel"]
    read = [leaf for leaf in leaves(sums) if isinstance(leaf, Element) and leaf.array.startswith("sums_")]
    negated = [
        part
        for part in parts_of(sums)
        if isinstance(part, Operation) and part.kind is Operator.NEG and part.args[0] in read
    ]
    assert len(negated) <= len(set(read)) // 10
    blocks = {
        name: {(call.first + n) for call in sums.calls if call.window.argument == name for n in range(call.count)}
        for name in ("q", "v")
    }
    assert not blocks["q"] & blocks["v"]
    assert [len(of) for of in blocks.values()] == [-(-len(v.rows) // TOGETHER) for v in sums.parts.values]


def parts_of(sums: KernelSums) -> list[Expr]:
    """All expressions of the statements of a kernel with sums, with those inside them."""
    statements = [statement for section in sums.parts.sections for _, statement in section]
    return [part for statement in statements for expr in expressions(statement) for part in walk(expr)]


def leaves(sums: KernelSums) -> list[Expr]:
    return [part for part in parts_of(sums) if not isinstance(part, Operation)]
