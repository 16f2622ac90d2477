"""The text of loops over instances: besides tables of numbers it does not depend on how many instances there are."""

import re
import subprocess
from functools import cache
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import derive
from conftest import QUICK
from derive.backends.c.source import CBackend
from derive.backends.model_files import emit
from derive.ir.model import Model
from derive.lowering.instances.lower import lower_instances
from derive.mechanics.multibody.mechanism import Mechanism
from derive.runtime.interpreted_scene import InterpretedScene
from derive.runtime.loading import load_scene
from derive.runtime.native_scene import NativeScene
from derive.spec.model.instances import instance_parts
from derive.spec.model.specification import Specification
from derive.spec.toml.read import parse

CHAIN = (Path(__file__).parents[2] / "examples" / "chain_100.toml").read_text()
FEW, MANY = 20, 100
SAME = 0.02
"""The largest relative difference of the texts."""
BYTES_OF_A_BODY = 250
"""The most bytes that a body adds to the tables of numbers of a language."""
TABLE = re.compile(r"^static const [^;(){}]* = \{\n.*?^\};\n", re.MULTILINE | re.DOTALL)
"""The definition of a constant table in C, as in bench/chains.py."""
NUMBERS = re.compile(r"[\s\d.,e+-]+\n")


def specification(count: int) -> Specification:
    text = CHAIN.replace("count = 100", f"count = {count}").replace("count = 99", f"count = {count - 1}")
    return parse(text.replace("chain_100", "chain"))


def mechanism(count: int) -> Mechanism:
    result = derive.derive(specification(count))
    assert isinstance(result, Mechanism)
    return result


@cache
def chain(count: int) -> tuple[Model, tuple[derive.File, ...]]:
    model = derive.lower(mechanism(count))
    return model, emit(model, specification(count))


@cache
def scene(count: int) -> NativeScene:
    return load_scene(chain(count)[1], QUICK)


@cache
def module(count: int) -> ModuleType:
    (file,) = (file for file in chain(count)[1] if file.path.endswith(".py"))
    result = ModuleType("generated")
    exec(compile(file.text, file.path, "exec"), result.__dict__)
    return result


@cache
def sizes(count: int, ending: str) -> tuple[int, int]:
    """The bytes of a file, without lines of numbers and of these lines."""
    (file,) = (file for file in chain(count)[1] if file.path.endswith(ending))
    lines = file.text.splitlines(keepends=True)
    numbers = sum(len(line) for line in lines if NUMBERS.fullmatch(line))
    return len(file.text) - numbers, numbers


@pytest.mark.parametrize("ending", [".h", ".c", ".py"])
def test_the_text_besides_numbers_does_not_depend_on_the_number_of_bodies(ending: str) -> None:
    (few, few_numbers), (many, many_numbers) = sizes(FEW, ending), sizes(MANY, ending)
    assert many <= (1 + SAME) * few
    assert many_numbers - few_numbers <= BYTES_OF_A_BODY * (MANY - FEW)


@cache
def text_without_tables(count: int) -> int:
    """The bytes of the C of a chain in loops over instances, without the definitions of constant tables."""
    (_, source) = CBackend().files(lower_instances(mechanism(count)), "")
    return len(TABLE.sub("", source.text))


@pytest.mark.parametrize("count", [3, 4, 5, 6, 7, 11, 73, 77, 101, pytest.param(1000, marks=pytest.mark.long)])
def test_the_text_of_a_chain_does_not_depend_on_its_length(count: int) -> None:
    """For all remainders by four, whose bodies blocks of four leave, and by two, which leave a joint between the ends.

    The shortest is that of three, as the indices of its one inner body are numbers; the longest that of 73: it is the
    last one of 4 k + 1 beams before a vector more is little enough work for a class less.
    """
    assert abs(text_without_tables(count) / text_without_tables(10) - 1) <= SAME


@pytest.mark.parametrize("language", ["c", "python"])
def test_composed_names_are_those_of_the_model(language: str) -> None:
    model = chain(FEW)[0]
    names = [tuple(v.title for v in of) for of in (model.coordinates, model.velocities, model.multipliers)]
    if language == "c":
        of = scene(FEW)
        found = [of.coordinates, of.velocities, of.multipliers, of.bodies, of.markers]
    else:
        given = module(FEW)
        classes = (given.LINK_LEFT_MARKERS, given.LINK_RIGHT_MARKERS)
        markers = tuple(name for of_class in classes for name in of_class.names)
        found = [given.COORDINATES, given.VELOCITIES, given.MULTIPLIERS, given.BODIES, markers]
    markers_of_model = tuple(m.title for of_class in model.marker_classes for m in of_class.markers)
    assert found == [*names, model.bodies, markers_of_model]
    assert model.coordinates[12].name == "link_2_phi" and model.coordinates[12].title == "link[2]_phi"


def test_units_and_roles_of_instances_are_in_the_descriptor() -> None:
    model, of = chain(FEW)[0], scene(FEW)
    assert of.roles == tuple(q.role for q in model.coordinates)


def test_patterns_of_columns_that_repeat_are_those_of_the_model() -> None:
    model, of, given = chain(FEW)[0], scene(FEW), module(FEW)
    every = {
        "mass": of.mass_pattern,
        "jacobian": of.jacobian_pattern,
        "constraint_jacobian": of.constraint_pattern,
        "jacobian_ggl": of.dae["ggl"].pattern,
        "jacobian_index1": of.dae["index1"].pattern,
    }
    for name, pattern in every.items():
        (output,) = (o for o in model.kernel(name).outputs if o.pattern)
        assert pattern == output.pattern
        in_python = getattr(given, name.upper())
        assert (in_python.colptr, in_python.rowidx) == (pattern.colptr, pattern.rowidx)


@pytest.mark.parametrize("name", ["link[0]_left", "link[9]_right", "link[19]_right"])
def test_all_markers_have_functions_of_their_number(name: str) -> None:
    of, given, rng = scene(FEW), module(FEW), np.random.default_rng(0)
    assert len(of.markers) == 2 * FEW
    q, v, k = *rng.normal(size=(2, of.nq)), of.setup()
    x, xdot, values = of.marker(name, q, v, k)
    jacobian = of.marker_pattern(name).dense(values)
    np.testing.assert_allclose(jacobian @ v, xdot, rtol=1e-12)
    force = np.array([1.0, -2.0])
    np.testing.assert_allclose(of.load(name, q, force, k), jacobian.T @ force, rtol=1e-12, atol=1e-15)
    np.testing.assert_array_equal(of.marker_positions(name, np.array([q, q]), np.array([v, v]), k), [x, x])
    of_name = instance_parts(name)
    in_python = getattr(given, f"marker_link_{of_name.ending}")(of_name.index, q, v, k)
    interpreted = InterpretedScene(chain(FEW)[0])
    for a, b, c in zip(in_python, interpreted.marker(name, q, v, k), (x, xdot, values), strict=True):
        np.testing.assert_allclose(a, c, rtol=1e-13, atol=1e-15)
        np.testing.assert_allclose(b, c, rtol=1e-13, atol=1e-15)
    assert interpreted.marker_pattern(name) == of.marker_pattern(name)


MIXED = """
name = "mixed"
[scene]
gravity = [0, "-981/100"]
[ground.markers]
hook = [0, 0]
[bodies.rod]
count = 3
{beam}
ansatz = ["1", "xi", "xi^2"]
[bodies.mass]
mass = 1
inertia = 1
markers = {{ pin = [0, 0] }}
[bodies.arm]
count = 6
{beam}
ansatz = ["1", "xi", "xi^2", "xi^3"]
[joints.first]
kind = "revolute"
between = ["ground.hook", "rod[0].left"]
[joints.pin]
count = 2
kind = "revolute"
between = ["rod[i].right", "rod[i+1].left"]
[joints.middle]
kind = "revolute"
between = ["rod[2].right", "mass.pin"]
[joints.root]
kind = "revolute"
between = ["mass.pin", "arm[0].left"]
[joints.elbow]
count = 5
kind = "revolute"
between = ["arm[i].right", "arm[i+1].left"]
[outputs.tip]
count = 6
kind = "position"
marker = "arm[i].right"
"""
BEAM = "frame = 'mean'\nmass = 1\nlength = 1\nbending_stiffness = 1\nmarkers = { left = -1, right = 1 }"


def test_the_header_counts_the_variables_of_instances(tmp_path: Path) -> None:
    """Single bodies keep their names; those of instances are functions of the index, and both are as in the model."""
    model = derive.lower(derive.derive(parse(MIXED.format(beam=BEAM))))
    for file in CBackend().files(model, ""):
        (tmp_path / Path(file.path).name).write_text(file.text)
    tables = {"Q": model.coordinates, "V": model.velocities, "LAMBDA": model.multipliers, "OUT": model.outputs}
    lines = ['#include "mixed.h"', "#include <stdio.h>", "int main(void) {"]
    for prefix, variables in tables.items():
        for v in variables:
            parts = instance_parts(v.shown or v.name)
            call = f"{parts.table}_{parts.ending}({parts.index})" if parts.table else v.name
            lines.append(f'printf("%d ", MIXED_{prefix}_{call});')
    (tmp_path / "main.c").write_text("\n".join([*lines, "return 0; }"]))
    subprocess.run(["cc", "main.c", "-o", "main"], cwd=tmp_path, check=True)
    numbers = subprocess.run([tmp_path / "main"], check=True, capture_output=True, text=True).stdout.split()
    assert [int(n) for n in numbers] == [k for variables in tables.values() for k in range(len(variables))]
    assert len(model.outputs) == 12
