"""`--to cmake`: configured, built and run by CTest with gcc and clang, shared and static, and on 32-bit ARM."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from host_models import PUSHED, STEERED, prepared, scene
from programs import program, run

import derive
from derive.export.host_model import HostModel
from derive.export.interface import exported_files
from derive.export.registry import INTERFACES

pytestmark = pytest.mark.hosts

MODELS = {
    "crank_slider_3": lambda: scene("crank_slider_3"),
    "pushed": lambda: prepared(PUSHED),
    "steered": lambda: prepared(STEERED),
    "spinning_beam": lambda: scene("spinning_beam"),
    "block": lambda: scene("block"),
}
"""A scene without ports, with a force, with a prescribed motion, a body in the plane and one in space."""


def export(model: HostModel, folder: Path) -> Path:
    """The folder of the CMake project of a model."""
    derive.write(exported_files(model, "cmake", INTERFACES["cmake"]), folder)
    return folder / f"{model.name}-cmake"


def configured(source: Path, build: Path, *options: str) -> Path:
    run(
        program("cmake"), "-G", "Ninja", f"-DCMAKE_MAKE_PROGRAM={program('ninja')}", *options, "-S", source, "-B", build
    )
    run(program("cmake"), "--build", build)
    return build


def ctest(build: Path) -> str:
    """What the tests of a project say, all of which have to pass."""
    said = run(program("ctest"), "--test-dir", build, "--verbose", "--no-tests=error")
    assert "100% tests passed" in said
    return said


COMPILERS = {"gcc": ("gcc", "g++"), "clang": ("clang", "clang++")}


@pytest.mark.parametrize("shared", ["ON", "OFF"], ids=["shared", "static"])
@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("name", MODELS)
def test_the_sample_has_the_motion_of_a_simulation(name: str, compiler: str, shared: str, tmp_path: Path) -> None:
    c, cpp = map(program, COMPILERS[compiler])
    source = export(MODELS[name](), tmp_path)
    options = [f"-DCMAKE_C_COMPILER={c}", f"-DCMAKE_CXX_COMPILER={cpp}", f"-DBUILD_SHARED_LIBS={shared}"]
    said = ctest(configured(source, tmp_path / "build", *options, "-DCMAKE_C_FLAGS=-Wall -Wextra -Werror"))
    assert (
        len(re.findall(rf"{name}: \d+ steps to t = .*; largest difference from Tisserand: \S+ of the toler", said)) == 1
    )
    assert (tmp_path / f"build/lib{name}.so").exists() == (shared == "ON")
