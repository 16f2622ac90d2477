"""C programs that use generated models through their headers alone print what `derive.load` computes."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from toolchain import C99, CPP11, HERE, run, scene, tool, written

import derive
from conftest import QUICK, ROOT

Q = np.array([0.1, 0.2, 0.5, 0.02, -0.01])
V = np.array([1.0, -2.0, 3.0, 0.1, 0.2])
EXACT = ("-O2", "-ffp-contract=off")
LANGUAGES = pytest.mark.parametrize("language", [("gcc", *C99), ("g++", *CPP11)], ids=["C", "C++"])

TWO_MODELS = """
#include <stdio.h>
#include "free_beam_mean.h"
#include "free_beam_point.h"

int main(void)
{
    const tisserand_model *models[2];
    double k[FREE_BEAM_MEAN_NK + FREE_BEAM_POINT_NK], energy[2];
    const double q[] = {0.1, 0.2, 0.5, 0.02, -0.01}, v[] = {1.0, -2.0, 3.0, 0.1, 0.2}, p[] = {2.0, 1.5, 30.0};
    models[0] = free_beam_mean_model();
    models[1] = free_beam_point_model();
    for (int i = 0; i < 2; i++) {
        if (models[i]->setup(p, k) || models[i]->energy(q, v, k, energy)) {
            return 1;
        }
        printf("%s %.17g %.17g\\n", models[i]->name, energy[0], energy[1]);
    }
    return 0;
}
"""


def printed(text: str) -> dict[str, list[float]]:
    """Lines of a name and numbers."""
    return {line.split()[0]: [float(x) for x in line.split()[1:]] for line in text.splitlines() if "=" not in line}


def build_host(language: tuple[str, ...], folder: Path) -> Path:
    sources = written(scene("free_beam_mean").files, folder)
    program = folder / "host"
    include = f"-I{sources[0].parent}"
    run(tool(language[0]), *language[1:], *EXACT, "-g", include, HERE / "host.c", *sources, "-o", program, "-lm")
    return program


@LANGUAGES
def test_the_example_of_thirty_lines(language: tuple[str, ...], tmp_path: Path) -> None:
    """The example compiles without warnings as its comment states, and the energy of the pendulum is conserved."""
    source, generated, hosts = (ROOT / path for path in ("examples/double_pendulum.c", "generated", "templates/host"))
    assert len(source.read_text().splitlines()) <= 30
    folder, program = generated / "double_pendulum", tmp_path / "pendulum"
    flags = (f"-I{folder}", f"-I{hosts}", '-DTISSERAND_HEADER="double_pendulum.h"')
    level = "-O2" if language[0] == "gcc" else "-O0"  # as the comment states it, and as C++
    command = (tool(language[0]), *language[1:], level, *flags, source, hosts / "fixed_step.c")
    run(*command, folder / "double_pendulum.c", "-o", program, "-lm")
    rows = [[float(x) for x in re.findall(r"-?\d[\d.e+-]*", line)] for line in run(program).splitlines()]
    times, angles, rates, energies = np.array(rows).T
    assert np.array_equal(times, np.arange(6) / 10)
    assert (angles[0], rates[0], energies[0]) == (0, 0, 0)
    assert np.all(np.diff(angles) < 0) and -1.3 < angles[-1] < -1.0
    assert np.abs(energies).max() < 1e-8


@LANGUAGES
def test_host_prints_what_python_computes(language: tuple[str, ...], tmp_path: Path) -> None:
    text = run(build_host(language, tmp_path))
    native = derive.load(scene("free_beam_mean").files, QUICK)
    k = native.setup([2.0, 1.5, 30.0])
    expected = {
        "mass": native.mass(Q, k),
        "force": native.force(0.0, Q, V, k),
        "accel": native.accel(0.0, Q, V, k),
        "energy": native.energy(Q, V, k),
        "free_beam_mean": native.accel(0.0, Q, V, native.setup()),
    }
    assert printed(text) == {name: list(values) for name, values in expected.items()}
    assert [line for line in text.splitlines() if "=" in line] == ["m = 1 kg", "l = 1 m", "EI = 1 N m^2"]


def test_host_is_clean_under_valgrind(tmp_path: Path) -> None:
    program = build_host(("gcc", *C99), tmp_path)
    flags = (
        "--quiet",
        "--error-exitcode=9",
        "--leak-check=full",
        "--show-leak-kinds=all",
        "--errors-for-leak-kinds=all",
    )
    assert run(tool("valgrind"), *flags, program) == run(program)


def test_valgrind_would_see_a_leak(tmp_path: Path) -> None:
    leaky = (HERE / "host.c").read_text().replace("    free(p);\n", "")
    sources = written(scene("free_beam_mean").files, tmp_path)
    (tmp_path / "leaky.c").write_text(leaky)
    program = tmp_path / "leaky"
    run(tool("gcc"), "-std=c99", f"-I{sources[0].parent}", tmp_path / "leaky.c", *sources, "-o", program, "-lm")
    with pytest.raises(AssertionError, match="definitely lost"):
        run(tool("valgrind"), "--quiet", "--error-exitcode=9", "--leak-check=full", program)


@pytest.mark.parametrize(
    ("host", "models"),
    [
        ("g++", "gcc"),
        *(pytest.param(*of, marks=pytest.mark.long) for of in (("gcc", "gcc"), ("gcc", "g++"), ("g++", "g++"))),
    ],
)
def test_two_models_in_one_program(host: str, models: str, tmp_path: Path) -> None:
    """Models and host may be compiled as either language: names of functions stay those of C."""
    language = {"gcc": C99, "g++": CPP11}
    objects = []
    includes = []
    for name in ("free_beam_mean", "free_beam_point"):
        (source,) = written(scene(name).files, tmp_path)
        objects.append(source.with_suffix(".o"))
        includes.append(f"-I{source.parent}")
        run(tool(models), *language[models], "-O0", "-ffp-contract=off", "-c", source, "-o", objects[-1])
    (tmp_path / "two.c").write_text(TWO_MODELS)
    run(tool(host), *language[host], *includes, "-c", tmp_path / "two.c", "-o", tmp_path / "two.o")
    run(tool(host), tmp_path / "two.o", *objects, "-o", tmp_path / "two", "-lm")
    expected = {}
    for name in ("free_beam_mean", "free_beam_point"):
        native = derive.load(scene(name).files, QUICK)
        expected[name] = list(native.energy(Q, V, native.setup([2.0, 1.5, 30.0])))
    assert printed(run(tmp_path / "two")) == expected
