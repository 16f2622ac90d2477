"""`--to cmake`: configured, built and run by CTest with gcc and clang, shared and static, and on 32-bit ARM."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache, partial
from pathlib import Path

import pytest
from host_models import EVERYWHERE, PUSHED, STEERED, prepared, scene
from programs import program, run

import derive
from conftest import ROOT
from derive.backends.c.source import ABI
from derive.export.host_model import HostModel, host_model
from derive.export.interface import exported_files
from derive.export.registry import INTERFACES

pytestmark = pytest.mark.hosts


@cache
def thrown_block() -> HostModel:
    """The block of the scenes, which spins and vibrates."""
    start = derive.SpatialStart(angular_velocity=(10.0, 0.1, 20.0), amplitudes=(1e-4,))
    return host_model(replace(derive.read(ROOT / "scenes/block.toml"), start=start))


MODELS = {
    "crank_slider_3": lambda: scene("crank_slider_3"),
    "pushed": lambda: prepared(PUSHED),
    "steered": lambda: prepared(STEERED),
    "spinning_beam": lambda: scene("spinning_beam"),
    "block": thrown_block,
    **{name: partial(prepared, text) for name, text in EVERYWHERE.items()},
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
    """The output of the tests of a project, all of which have to pass."""
    output = run(program("ctest"), "--test-dir", build, "--verbose", "--no-tests=error")
    assert "100% tests passed" in output
    return output


COMPILERS = {"gcc": ("gcc", "g++"), "clang": ("clang", "clang++")}


@pytest.mark.parametrize("shared", ["ON", "OFF"], ids=["shared", "static"])
@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("name", MODELS)
def test_the_sample_has_the_motion_of_a_simulation(name: str, compiler: str, shared: str, tmp_path: Path) -> None:
    c, cpp = map(program, COMPILERS[compiler])
    source = export(MODELS[name](), tmp_path)
    options = [f"-DCMAKE_C_COMPILER={c}", f"-DCMAKE_CXX_COMPILER={cpp}", f"-DBUILD_SHARED_LIBS={shared}"]
    flags = [f"-DCMAKE_{language}_FLAGS=-Wall -Wextra -Wshadow -Werror" for language in ("C", "CXX")]
    output = ctest(configured(source, tmp_path / "build", *options, *flags))
    assert len(re.findall(rf"{name}: \d+ steps to t = .*; largest difference from Tisserand: \S+ of", output)) == 2
    assert (tmp_path / f"build/lib{name}.so").exists() == (shared == "ON")


USER = """
cmake_minimum_required(VERSION 3.14...3.30)
project(user LANGUAGES C)
{found}
add_executable(user user.c)
target_link_libraries(user PRIVATE pushed::pushed)
enable_testing()
add_test(NAME user COMMAND user)
"""
PROGRAM = """
#include "pushed.h"
#include <stdio.h>
int main(void)
{
    double p[PUSHED_NP], k[PUSHED_NK], q[PUSHED_NQ], v[PUSHED_NV], vdot[PUSHED_NV], u[PUSHED_NU] = {0.3};
    int code = pushed_defaults(p) || pushed_setup(p, k) || pushed_start(q, v) || pushed_accel(0.0, q, v, u, k, vdot);
    printf("%.17g\\n", vdot[PUSHED_V_rod_phidot]);
    return code;
}
"""


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the project of the pushed rod, `source`, and its installed library, `prefix`."""
    folder = tmp_path_factory.mktemp("installed")
    export(prepared(PUSHED), folder).rename(folder / "source")
    build = configured(folder / "source", folder / "build", f"-DCMAKE_INSTALL_PREFIX={folder / 'prefix'}")
    run(program("cmake"), "--install", build)
    return folder


def expected() -> float:
    """The angular acceleration in the start state by the same C, called from Python."""
    model = prepared(PUSHED)
    native = derive.load_scene(model.files)
    k = native.with_inputs(native.setup(), [u.start for u in model.inputs])
    vdot = native.accel(0.0, [x.start for x in model.coordinates], [x.start for x in model.velocities], k)
    return float(vdot[native.velocities.index("rod_phidot")])


WAYS = {
    "add_subdirectory": "add_subdirectory({source} pushed)",
    "FetchContent": "include(FetchContent)\nFetchContent_Declare(pushed SOURCE_DIR {source})\n"
    "FetchContent_MakeAvailable(pushed)",
    "find_package": f"find_package(pushed {ABI} REQUIRED)",
}


@pytest.mark.parametrize("way", WAYS)
def test_projects_take_the_library(way: str, installed: Path, tmp_path: Path) -> None:
    (tmp_path / "CMakeLists.txt").write_text(USER.format(found=WAYS[way].format(source=installed / "source")))
    (tmp_path / "user.c").write_text(PROGRAM)
    build = configured(tmp_path, tmp_path / "build", f"-DCMAKE_PREFIX_PATH={installed / 'prefix'}")
    assert float(run(build / "user")) == expected()
    assert "Total Tests: 1" in run(program("ctest"), "--test-dir", build, "--show-only")  # the sample is not built


def test_a_library_of_another_interface_is_not_found(installed: Path, tmp_path: Path) -> None:
    (tmp_path / "CMakeLists.txt").write_text(USER.format(found=f"find_package(pushed {ABI + 1} REQUIRED)"))
    (tmp_path / "user.c").write_text(PROGRAM)
    with pytest.raises(AssertionError, match=f"pushed-config.cmake, version: {ABI}.0.0"):
        configured(tmp_path, tmp_path / "build", f"-DCMAKE_PREFIX_PATH={installed / 'prefix'}")


def test_the_sample_finds_the_installed_library(installed: Path, tmp_path: Path) -> None:
    prefix = f"-DCMAKE_PREFIX_PATH={installed / 'prefix'}"
    assert "largest difference" in ctest(configured(installed / "source/sample", tmp_path / "build", prefix))


def test_pkg_config_has_the_flags(installed: Path, tmp_path: Path) -> None:
    (tmp_path / "user.c").write_text(PROGRAM)
    (folder,) = (installed / "prefix").rglob("pkgconfig")
    flags = run(program("pkg-config"), "--cflags", "--libs", "pushed", PKG_CONFIG_PATH=str(folder)).split()
    assert run(program("pkg-config"), "--modversion", "pushed", PKG_CONFIG_PATH=str(folder)).strip() == f"{ABI}.0.0"
    run(program("gcc"), "-std=c99", tmp_path / "user.c", *flags, "-o", tmp_path / "user")
    assert float(run(tmp_path / "user")) == expected()
