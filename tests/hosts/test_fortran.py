"""`--to fortran`: the module compiles without warnings, and calls the C with the same numbers as Python."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import pytest
from host_models import EVERYWHERE, PUSHED, STEERED, prepared, scene
from programs import program, run

import derive
from derive.errors import SpecError
from derive.export.fortran import fortran_files
from derive.spec.toml.read import parse

MODELS = {
    "pushed": lambda: prepared(PUSHED),
    "steered": lambda: prepared(STEERED),
    "block": lambda: scene("block"),
    **{name: partial(prepared, text) for name, text in EVERYWHERE.items()},
}


@pytest.mark.hosts
@pytest.mark.parametrize("name", MODELS)
def test_the_sample_has_the_motion_of_a_simulation(name: str, tmp_path: Path) -> None:
    model = MODELS[name]()
    derive.write(fortran_files(model), tmp_path)
    flags = f"FC={program('gfortran')}", "FFLAGS=-O1 -std=f2018 -Wall -Wextra -Werror"
    said = run(program("make"), "-C", tmp_path, "test", *flags)
    assert f"{name}: largest difference from Tisserand:" in said
    native = derive.load(model.files)
    k = native.setup()
    k = native.with_inputs(k, model.constant_inputs) if model.inputs else k
    vdot = native.accel(0.0, *([x.start for x in part] for part in (model.coordinates, model.velocities)), k)
    (line,) = (line.split()[1:] for line in said.splitlines() if line.startswith("vdot "))
    assert list(map(float, line)) == vdot.tolist()


@pytest.mark.hosts
def test_a_wrong_length_is_an_error_of_the_compiler(tmp_path: Path) -> None:
    derive.write(fortran_files(prepared(PUSHED)), tmp_path)
    sample = tmp_path / "sample.f90"
    sample.write_text(sample.read_text().replace("q(nq), v(nv), rows", "q(nq), v(nv - 1), rows"))
    with pytest.raises(AssertionError, match="Actual argument contains too few elements"):
        run(program("make"), "-C", tmp_path, "test", f"FC={program('gfortran')}")


def test_names_that_are_too_long_for_fortran_are_listed() -> None:
    body, marker = "b" * 30, "m" * 30
    text = PUSHED.replace("rod", body).replace("root", marker)
    with pytest.raises(SpecError, match=f"Fortran allows 63 characters.*: marker_{body}_{marker}, load_"):
        fortran_files(prepared(text))
    assert parse(text, "given.toml")


@pytest.mark.hosts
def test_long_names_fit_on_the_lines_of_fortran(tmp_path: Path) -> None:
    """A line has at most 132 characters; more of them are an error of the compiler."""
    name, body, marker = "n" * 40, "b" * 26, "m" * 29
    model = prepared(PUSHED.replace("pushed", name).replace("rod", body).replace("root", marker))
    assert max(len(kernel.name) for kernel in model.model.kernels) == 63
    derive.write(fortran_files(model), tmp_path)
    run(program("make"), "-C", tmp_path, "test", f"FC={program('gfortran')}", "FFLAGS=-std=f2018 -Wall -Werror")


def test_an_output_with_the_name_of_an_argument_gets_another_one() -> None:
    """Fortran takes f for F: load(q, F, k, f)."""
    (module,) = (file.text for file in fortran_files(prepared(PUSHED)) if file.path == "pushed_fortran.f90")
    assert "function load_rod_tip(q, F, k, f_out) result(code)" in module
    assert "function energy(q, v, k, energy_out) result(code)" in module
