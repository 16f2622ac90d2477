"""`--to octave`: the MEX function has the motion of a simulation and the numbers of Python, and explains its errors."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from host_models import EVERYWHERE, PUSHED, STEERED, prepared
from programs import program, run

import derive
from derive.export.octave import octave_files

pytestmark = pytest.mark.hosts

MODELS = {"pushed": PUSHED, "steered": STEERED} | EVERYWHERE


@pytest.fixture(scope="module", params=MODELS)
def built(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("octave") / str(request.param)
    derive.write(octave_files(prepared(MODELS[request.param])), folder)
    program("mkoctfile")
    octave(folder, "build.m")
    return folder


def octave(folder: Path, *arguments: str) -> str:
    return run(program("octave-cli"), "--no-history", "--quiet", *arguments, cwd=folder)


def test_the_sample_has_the_motion_of_a_simulation(built: Path) -> None:
    name = built.name
    said = octave(built, "sample.m")
    assert f"{name}: largest difference of {name}_mex from Tisserand:" in said
    assert f"{name}: largest difference of ode45 from Tisserand:" in said
    model = prepared(MODELS[name])
    native = derive.load_scene(model.files)
    k = native.with_inputs(native.setup(), model.constant_inputs)
    vdot = native.accel(0.0, *([x.start for x in part] for part in (model.coordinates, model.velocities)), k)
    (line,) = (line.split()[1:] for line in said.splitlines() if line.startswith("vdot "))
    assert list(map(float, line)) == vdot.tolist()


def test_the_names_units_and_start_values_are_those_of_the_model(built: Path) -> None:
    name, model = built.name, prepared(MODELS[built.name])
    ask = "i = {0}_info(); printf('%s|', i.states.names{{:}}, i.inputs.units{{:}}); printf('%.17g|', i.states.start)"
    said = octave(built, "--eval", ask.format(name)).strip("|\n").split("|")
    names, units = [x.name for x in model.states], [u.unit for u in model.inputs]
    assert said[: len(names) + len(units)] == names + units
    assert list(map(float, said[len(names) + len(units) :])) == [x.start for x in model.states]


def test_the_first_step_of_ode45_is_given() -> None:
    """The one that it chooses itself left the model of a stiff scene at rest, where no pivot remained."""
    (sample,) = (file.text for file in octave_files(prepared(PUSHED)) if file.path == "sample.m")
    assert "'InitialStep', times(2) / 1000)" in sample


@pytest.mark.parametrize("name", MODELS)
def test_the_scripts_keep_to_the_syntax_of_matlab(name: str) -> None:
    """In MATLAB "text" is no array of characters, `!` no operator, and the result of a call has no index behind it."""
    for file in octave_files(prepared(MODELS[name])):
        if file.path.endswith(".m"):
            code = "\n".join(line for line in file.text.splitlines() if not line.startswith("%"))
            for foreign in ('"', "!", ")(", "){", "printf (", " printf(", "\nprintf(", "end_", "endif", "#"):
                assert foreign not in code, f"{file.path}: {foreign}"


def test_the_c_calls_what_matlab_documents_too() -> None:
    """Functions of the C matrix and MEX API of MATLAB, by its documentation."""
    (source,) = (file.text for file in octave_files(prepared(PUSHED)) if file.path == "pushed_mex.c")
    documented = {"mexErrMsgIdAndTxt", "mexFunction", "mxGetNumberOfElements", "mxGetPr", "mxGetString"}
    documented |= {"mxCreateDoubleMatrix", "mxREAL", "mxArray", "mxMalloc", "mxFree"}
    documented |= {f"mxIs{kind}" for kind in ("Char", "Complex", "Double", "Sparse")}
    assert set(re.findall(r"\bm(?:e?)x[A-Z]\w+", source)) == documented
    assert re.findall(r"#include <(\S+)>", source) == ["mex.h", "string.h"]


ERRORS = {
    "pushed_mex('setup', -1)": "tisserand:not_finite setup: a value is not finite or not positive",
    "pushed_mex('setup', [1, 2])": "tisserand:arguments setup: p has to be a real vector of 1 doubles",
    "pushed_mex('setup', 1i)": "tisserand:arguments setup: p has to be a real vector of 1 doubles",
    "pushed_mex('setup')": "tisserand:arguments setup takes 1 arguments and has 1 results",
    "pushed_mex('motion', 2, '01', 1, k, 0, q, v)": "tisserand:arguments motion: times has to be a real vector of do",
    "pushed_mex('acel')": "tisserand:arguments pushed has no function acel; see pushed.h",
    "pushed_mex('motion', 3, [0, 1], 1e-9, k, 0, q, v)": "tisserand:arguments motion: count has to be",
    "pushed_mex('motion', 2, [0, -1], 1e-9, k, 0, q, v)": "tisserand:integrator motion: code 4 of adaptive.h",
}


@pytest.mark.parametrize("built", ["pushed"], indirect=True)
@pytest.mark.parametrize("call", ERRORS)
def test_errors_say_what_is_wrong(call: str, built: Path) -> None:
    start = "x = pushed_info().states.start; q = x(1:5); v = x(6:10); k = pushed_mex('setup', 10);"
    said = octave(built, "--eval", f"{start} try; {call}; catch e; disp([e.identifier ' ' e.message]); end")
    identifier, message = ERRORS[call].split(" ", 1)
    assert said.startswith(f"{identifier} pushed_mex: {message}")
