"""The generated C on 32-bit ARM: the motion of a simulation, the functions it needs, its stack, and no allocation."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from host_models import PUSHED, prepared, scene
from programs import program, run
from test_cmake import configured, ctest, export

import derive
from derive.export.host_model import HostModel

pytestmark = pytest.mark.hosts

ARM = "arm-linux-gnueabihf"
MODELS = {
    "crank_slider_3": lambda: scene("crank_slider_3"),
    "pushed": lambda: prepared(PUSHED),
}


@pytest.mark.parametrize("name", MODELS)
def test_the_sample_has_the_motion_of_a_simulation(name: str, tmp_path: Path) -> None:
    system = ["-DCMAKE_SYSTEM_NAME=Linux", "-DCMAKE_SYSTEM_PROCESSOR=arm", "-DCMAKE_EXE_LINKER_FLAGS=-static"]
    compilers = [f"-DCMAKE_C_COMPILER={program(f'{ARM}-gcc')}", f"-DCMAKE_CXX_COMPILER={program(f'{ARM}-g++')}"]
    emulator = f"-DCMAKE_CROSSCOMPILING_EMULATOR={program('qemu-arm')}"
    build = configured(export(MODELS[name](), tmp_path), tmp_path / "build", *system, *compilers, emulator)
    said = ctest(build)
    assert said.count("largest difference from Tisserand") == 2
    assert "ELF32" in run(program("readelf"), "-h", build / f"sample/{name}_sample_c")


def compiled(model: HostModel, compiler: str, level: str, folder: Path) -> Path:
    """The object of a model, with a file of the stack use of each function beside it."""
    derive.write(model.files, folder)
    flags = ("-std=c99", level, "-ffp-contract=off", "-fstack-usage")
    run(program(compiler), *flags, "-c", folder / f"{model.name}/{model.name}.c", cwd=folder)
    return folder / f"{model.name}.o"


@pytest.mark.parametrize("compiler", ["gcc", "clang", f"{ARM}-gcc"])
@pytest.mark.parametrize("name", MODELS)
def test_it_needs_sine_cosine_and_root_alone(name: str, compiler: str, tmp_path: Path) -> None:
    """Compilers call sincos for the sine and the cosine of one angle, and memcpy, memmove and memset for loops."""
    file = compiled(MODELS[name](), compiler, "-O2", tmp_path)
    needed = {line.split()[-1] for line in run(program("nm"), "--undefined-only", file).splitlines()}
    assert needed <= {"sin", "cos", "sqrt", "sincos", "memcpy", "memmove", "memset", "_GLOBAL_OFFSET_TABLE_"}
    assert needed & {"sin", "sincos"}


@pytest.mark.parametrize("level", ["-O0", "-O1", "-O2", "-O3", "-Os"])
@pytest.mark.parametrize("compiler", ["gcc", "clang", f"{ARM}-gcc"])
def test_the_stack_is_within_what_the_manifest_states(compiler: str, level: str, tmp_path: Path) -> None:
    for model in (prepared(PUSHED), scene("spinning_beam"), scene("block")):
        file = compiled(model, compiler, level, tmp_path)
        stated = json.loads(model.manifest.text)["stack_bytes"]
        lines = [line.split("\t") for line in file.with_suffix(".su").read_text().splitlines()]
        taken = {line[0].split(":")[-1]: int(line[1]) for line in lines if line[2] == "static"}
        assert stated.keys() == {kernel.name for kernel in model.model.kernels}
        for kernel, limit in stated.items():
            assert taken[f"{model.name}_{kernel}"] <= limit, kernel
