"""The description of a unit states what the unit does: sizes of states, dependencies, names, and its sources."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import pytest
from fmus import VERSIONS, fmpy, model_of, prepared, unit
from host_models import PUSHED
from programs import program, run
from test_fmi_derivatives import Exchange

from derive.errors import SpecError
from derive.export.fmi.description import dependencies
from derive.export.fmi.variables import Causality, fmi_variables
from derive.export.host_model import host_model
from derive.export.registry import exported
from derive.spec.toml.read import parse

pytestmark = pytest.mark.hosts

SMALL = PUSHED.replace("length = 1.0", "length = 0.01").replace('"pushed"', '"small"')


@pytest.mark.parametrize("version", VERSIONS)
def test_states_have_the_sizes_that_are_described(version: int, tmp_path: Path) -> None:
    path = unit(prepared(SMALL), version, tmp_path)
    description = fmpy().read_model_description(str(path))
    instance = fmpy().instantiate_fmu(fmpy().extract(str(path)), description, "ModelExchange")
    described = [x for x in description.modelVariables if x.initial == "approx"]
    sizes = np.empty(len(described))
    instance.getNominalsOfContinuousStates(
        sizes.ctypes.data_as(fmpy().fmi2.POINTER(fmpy().fmi2.c_double)), len(described)
    )
    assert [float(x.nominal) for x in described] == sizes.tolist()
    assert 0 < min(sizes) < 0.1
    text = zipfile.ZipFile(path).read("modelDescription.xml").decode()
    assert text.count('reinit="true"') == len(described)  # events project the states


@pytest.mark.parametrize("name", ["crank_slider_3", "pushed", "steered", "block"])
def test_nothing_depends_on_what_is_not_listed(name: str, tmp_path: Path) -> None:
    """Every derivative that is not zero is of a dependency, of those that are listed some are needed."""
    exchange, listed = Exchange(name, 3, tmp_path), dependencies(model_of(name))
    exchange.at(exchange.point)
    knowns = [x.reference for x in exchange.knowns if x.causality is not Causality.PARAMETER]
    matrix = np.column_stack(
        [exchange.directional(seed) for seed, x in zip(np.eye(len(exchange.knowns)), exchange.knowns, strict=True)]
    )
    columns = [exchange.knowns.index(x) for x in exchange.knowns if x.causality is not Causality.PARAMETER]
    for row, unknown in zip(matrix[:, columns], exchange.unknowns, strict=True):
        needed = {known for known, value in zip(knowns, row, strict=True) if value != 0}
        assert needed <= set(listed.get(unknown.reference, knowns)), unknown.name
    positions = {x.reference for x in exchange.unknowns if x.derivative_of is not None} & listed.keys()
    assert len(positions) == len(model_of(name).coordinates)
    text = zipfile.ZipFile(tmp_path / f"{name}3.fmu").read("modelDescription.xml").decode()
    for reference, others in listed.items():
        assert f'valueReference="{reference}" dependencies="{" ".join(map(str, others))}"/>' in text


@pytest.mark.parametrize("version", VERSIONS)
def test_positions_do_not_depend_on_inputs(version: int, tmp_path: Path) -> None:
    """Importers thus see no algebraic loop through positions."""
    variables = {x.name: x for x in fmi_variables(prepared(PUSHED))}
    listed = dependencies(prepared(PUSHED))
    assert variables["push"].reference not in listed[variables["tip[1]"].reference]
    assert variables["rod.phi"].reference in listed[variables["tip[1]"].reference]
    assert variables["support[1]"].reference not in listed
    shift = 1 if version == 2 else 0
    text = zipfile.ZipFile(unit(prepared(PUSHED), version, tmp_path)).read("modelDescription.xml").decode()
    assert f'dependencies="{" ".join(str(x + shift) for x in listed[variables["tip[1]"].reference])}"' in text


def test_two_variables_of_one_name_are_refused() -> None:
    angle = '[outputs.push]\nkind = "rotation"\nmarker = "rod.tip"\n'
    model = host_model(parse(PUSHED.replace("[outputs.tip]", angle + "[outputs.tip]")), sensitivities=True)
    with pytest.raises(SpecError, match="push is the name of the input and of the output"):
        fmi_variables(model)


@pytest.mark.parametrize(("kind", "name"), [("fmu2", "instance"), ("fmu3", "model"), ("casadi", "ode")])
def test_a_name_of_another_file_is_refused(kind: str, name: str) -> None:
    with pytest.raises(SpecError, match="choose another name"):
        exported(parse(PUSHED.replace('"pushed"', f'"{name}"')), kind)


@pytest.mark.parametrize("version", VERSIONS)
def test_functions_have_the_prefix_of_an_importer(version: int, tmp_path: Path) -> None:
    """Programs that link the sources of a unit need the prefix; compilers have no warnings."""
    with zipfile.ZipFile(unit(prepared(PUSHED), version, tmp_path)) as archive:
        archive.extractall(tmp_path)
    flags = ("-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror", "-O0")
    names: dict[str, set[str]] = {}
    for define in ("FMI{}_FUNCTION_PREFIX=pushed_", "FMI{}_OVERRIDE_FUNCTION_PREFIX=pushed_", "FMI{}_FUNCTION_PREFIX="):
        for compiler in ("gcc", "clang"):
            sources = sorted((tmp_path / "sources").glob("*.c"))
            library = tmp_path / "unit.so"
            flag = f"-D{define.format(version)}"
            run(
                program(compiler),
                *flags,
                "-fvisibility=hidden",
                "-shared",
                "-fPIC",
                flag,
                *sources,
                "-o",
                library,
                "-lm",
            )
            names[define] = set(run(program("nm"), "-D", "--defined-only", "-j", library).split())
    plain = names.pop("FMI{}_FUNCTION_PREFIX=")
    assert len(plain) > 40 and all(name.startswith(f"fmi{version}") for name in plain)
    assert all(found == {f"pushed_{name}" for name in plain} for found in names.values())
