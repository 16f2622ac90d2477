"""`--to petsc`: motion and events are those of simulations, Jacobians are exact, and failing steps are repeated."""

from __future__ import annotations

import os
import re
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from programs import program, run
from test_cmake import configured, ctest, thrown_block
from test_sundials import LINKAGE, SPECS
from toolchain import WARNINGS

import derive
from conftest import ROOT
from derive.export.host_model import HostModel, host_model
from derive.export.interface import exported_files
from derive.export.registry import INTERFACES
from derive.spec.toml.read import parse

pytestmark = pytest.mark.hosts


def petsc() -> str:
    """The version of PETSc; without it the test is skipped, and fails in CI."""
    command = [program("pkg-config"), "--modversion", "PETSc"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        (pytest.fail if os.environ.get("CI") else pytest.skip)("PETSc is missing: apt-get install petsc-dev")
    return done.stdout.strip()


FORMS = ("ggl", "index1", "index3")
FIRST = 40
"""Jacobians that are compared: where the form of index 3 repeats steps more often, it fails, far from the motion."""


def built(model: HostModel, folder: Path) -> Path:
    """The folder of the program of a model."""
    petsc()
    derive.write(exported_files(model, "petsc", INTERFACES["petsc"]), folder)
    flags = "-DCMAKE_C_FLAGS=-Wall -Wextra -Wshadow -Wconversion -Wpedantic -Werror"
    return configured(folder / f"{model.name}-petsc", folder / "build", flags)


def looped_block() -> HostModel:
    """The block of the scenes with loops over its modes, whose patterns are functions."""
    model = thrown_block()
    return host_model(replace(model.spec, lowering="loops"))


MODELS = {name: lambda make=make: host_model(make()) for name, make in SPECS.items()} | {
    "looped block": looped_block,
}


def jacobian_errors(folder: Path, *options: str) -> list[float]:
    """The errors of the Jacobian that PETSc computes by differences in the first steps, relative to the Jacobian."""
    command = [folder / "sample", "-snes_test_jacobian", "-ts_max_steps", "4", *options]
    said = subprocess.run(command, capture_output=True, text=True, check=False).stdout
    return [float(x) for x in re.findall(r"\|\|J\|\|_F = (\S+),", said)]


@pytest.mark.parametrize("name", MODELS)
def test_the_program_has_the_motion_of_a_simulation_and_exact_jacobians(name: str, tmp_path: Path) -> None:
    model = MODELS[name]()
    folder = built(model, tmp_path)
    said = ctest(folder)
    for method in ("bdf", "arkimex"):
        assert re.search(rf"{model.name}, {method}: [1-9]\d* steps, \d+ repeated; largest difference", said)
    if name == "spinning_beam":  # errors of Newton's method do not shorten the steps
        assert int(re.findall(r"arkimex: (\d+) steps", said)[0]) < 60
    for form in FORMS if model.model.bodies else ("ode",):
        errors = jacobian_errors(folder, "-form", form)[:FIRST]
        assert len(errors) >= 4 and max(errors) < 1e-7, form


def test_other_methods_matrices_and_solvers_are_options(tmp_path: Path) -> None:
    """Nothing that PETSc allocates is left at the end."""
    folder = built(host_model(SPECS["pushed"]()), tmp_path)
    for options in (
        ("-form", "index1", "-malloc_debug", "-malloc_dump"),
        ("-form", "index1", "-ts_type", "rosw", "-ts_rtol", "1e-7"),
        ("-form", "index1", "-ts_type", "cn", "-ts_adapt_type", "basic", "-ts_rtol", "1e-7"),
        ("-ts_type", "alpha", "-ts_dt", "1e-5"),
        ("-pc_factor_mat_solver_type", "petsc", "-pc_factor_mat_ordering_type", "natural"),
        ("-snes_mf_operator",),
    ):
        said = run(folder / "sample", *options)
        assert "largest difference" in said and "bytes" not in said and "unused" not in said.lower()
    said = subprocess.run([folder / "sample", "-form", "index2"], capture_output=True, text=True, check=False)
    assert said.returncode != 0 and "the model pushed has no form index2" in said.stderr


def test_events_are_those_of_a_simulation(tmp_path: Path) -> None:
    """The times at which the slider turns round."""
    spec = parse(LINKAGE.replace("duration = 3", "duration = 30"))
    folder = built(host_model(spec), tmp_path)
    times = [float(x) for x in re.findall(r"event at t = (\S+) s", run(folder / "sample"))]
    motion = derive.simulate(spec, duration=3.0, output=2e-4)
    velocities = derive.load_scene(host_model(spec).files).velocities
    speed, t = motion.solution.v[:, list(velocities).index("slider_sdot")], motion.solution.t
    turns = np.flatnonzero(speed[:-1] * speed[1:] < 0)
    expected = t[turns] - speed[turns] * (t[turns + 1] - t[turns]) / (speed[turns + 1] - speed[turns])
    assert len(times) == len(expected) >= 2
    assert np.abs(np.array(times) - expected).max() < 1e-5


FAILING = r"""
static int (*residual)(double t, const double *y, const double *ydot, const double *constants, double *F);
static int (*jacobian)(double t, const double *y, const double *ydot, double cj, const double *constants, double *jac);
static int calls[2], first[2], last[2];

/* Those of the model with a code in calls first, ..., last - 1. */
static int failing_residual(double t, const double *y, const double *ydot, const double *constants, double *F)
{
    calls[0]++;
    return calls[0] >= first[0] && calls[0] < last[0] ? 2 : residual(t, y, ydot, constants, F);
}

static int failing_jacobian(double t, const double *y, const double *ydot, double cj, const double *constants,
                            double *jac)
{
    calls[1]++;
    return calls[1] >= first[1] && calls[1] < last[1] ? 1 : jacobian(t, y, ydot, cj, constants, jac);
}

static void fail(tisserand_petsc *own)
{
    PetscInt two = 2;
    (void) PetscOptionsGetIntArray(NULL, NULL, "-first", first, &two, NULL);
    two = 2;
    (void) PetscOptionsGetIntArray(NULL, NULL, "-last", last, &two, NULL);
    residual = own->form.residual;
    jacobian = own->form.jacobian;
    own->form.residual = failing_residual;
    own->form.jacobian = failing_jacobian;
}

int main("""
NEVER = "1000000000"


def test_a_step_in_which_the_model_fails_is_repeated(tmp_path: Path) -> None:
    """The sample, in which the residual or the Jacobian fails for some calls, or for all from one on."""
    model = host_model(SPECS["linkage"]())
    (made,) = [file for file in exported_files(model, "petsc", INTERFACES["petsc"]) if file.path.endswith("sample.c")]
    folder = built(model, tmp_path)
    text = made.text.replace("\nint main(", FAILING, 1)
    path = tmp_path / "linkage-petsc/sample.c"
    path.write_text(text.replace("form, k, &own));", "form, k, &own));\n    fail(&own);", 1))
    run(program("cmake"), "--build", folder)
    methods = (("-form", "ggl"), ("-form", "index1", "-ts_type", "arkimex", "-ts_arkimex_type", "5"))
    for method in methods:
        plain = re.findall(r"\d+ steps, \d+ repeated", run(folder / "sample", *method))
        for first, last, function in (("300,0", "303,0", "residual"), ("0,200", "0,202", "Jacobian")):
            said = run(folder / "sample", "-first", first, "-last", last, *method, "-info", ":ts", "-ts_adapt_monitor")
            assert f"the {function} of linkage: code" in said and "largest difference" in said
            assert ("stage rejected (DIVERGED_FUNCTION_DOMAIN)" in said) == (function == "residual")
            assert re.findall(r"\d+ steps, \d+ repeated", said) != plain
    # The linearly implicit methods of PETSc 3.18 do not recover, but accept no such step either.
    command = [folder / "sample", "-form", "index1", "-ts_type", "rosw", "-first", "300,0", "-last", "303,0"]
    said = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    assert said.returncode != 0 and "PETSC ERROR" in said.stderr
    command = [folder / "sample", "-first", "300,0", "-last", f"{NEVER},0"]
    said = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    assert said.returncode != 0 and "DIVERGED_STEP_REJECTED" in said.stderr


def test_the_header_and_the_functions_are_also_cpp(tmp_path: Path) -> None:
    petsc()
    model = host_model(SPECS["pushed"]())
    derive.write(exported_files(model, "petsc", INTERFACES["petsc"]), tmp_path)
    includes = run(program("pkg-config"), "--cflags-only-I", "PETSc").split()
    includes += run(program("mpicxx"), "--showme:incdirs").split()
    flags = [part for folder in includes for part in ("-isystem", folder.removeprefix("-I"))]
    header = '-DTISSERAND_HEADER="pushed.h"'
    run(
        program("g++"),
        "-x",
        "c++",
        "-std=c++11",
        *WARNINGS,
        *flags,
        header,
        "-fsyntax-only",
        tmp_path / "pushed-petsc/petsc_ts.c",
    )


def test_the_version_is_the_one_that_is_stated() -> None:
    major, minor = petsc().split(".")[:2]
    assert f"Tried with PETSc {major}.{minor}." in (ROOT / "docs/hosts.md").read_text()
