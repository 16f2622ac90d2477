"""Binaries of units for all platforms, inspected: their processor, the functions of FMI alone, and what they load."""

from __future__ import annotations

import re
import zipfile
from pathlib import Path

import pytest
from fmus import VERSIONS, fmpy, simulated
from host_models import PUSHED
from programs import program, run

import derive
from derive import cache
from derive.export.fmi import binaries
from derive.export.fmi.binaries import PLATFORMS, CompilerError, Platform, compiled, this_platform
from derive.export.registry import exported
from derive.spec.toml.read import parse

FORMATS = {
    ("Linux", "x86_64"): "elf64-x86-64",
    ("Linux", "aarch64"): "elf64-littleaarch64",
    ("Windows", "x86_64"): "COFF-x86-64",
    ("Darwin", "x86_64"): "Mach-O 64-bit x86-64",
    ("Darwin", "aarch64"): "Mach-O arm64",
}
"""The format that llvm-readobj prints of the binary for each platform."""


def zig() -> None:
    pytest.importorskip("ziglang", reason="Zig is missing: make test-hosts installs it")


def functions(version: int) -> set[str]:
    """The functions of FMI, as the header with which FMPy compiles units declares them."""
    header = Path(fmpy().__file__).parent / f"c-code/fmi{version}FunctionTypes.h"
    return {name.removesuffix("TYPE") for name in re.findall(rf"\bfmi{version}\w+TYPE\b", header.read_text())}


def visible(library: Path, platform: Platform) -> set[str]:
    """The functions that others can call."""
    match platform.ending:
        case "dll":
            return set(re.findall(r"Name: (\w+)\n", run(program("llvm-readobj"), "--coff-exports", library)))
        case "dylib":
            names = run(program("llvm-nm"), "--extern-only", "--defined-only", "--just-symbol-name", library).split()
            return {name[1:] for name in names} - {"__dso_handle", "_mh_dylib_header"}
        case _:
            return set(run(program("llvm-nm"), "-D", "--defined-only", "--just-symbol-name", library).split())


def needed(library: Path) -> set[str]:
    """The libraries that a system loads with it."""
    (names,) = re.findall(r"NeededLibraries \[\n(.*?)\]", run(program("llvm-readobj"), "--needed-libs", library), re.S)
    return set(names.split())


SYSTEM = {
    "so": r"libc\.so\.6|libm\.so\.6",
    "dll": r"KERNEL32\.dll|api-ms-win-crt-[a-z]+-l1-1-0\.dll",
    "dylib": r"/usr/lib/libSystem\.B\.dylib|@rpath/pushed\.dylib",
}
"""The libraries that every system has: on Windows those of its C runtime since version 10; macOS adds its own name."""


@pytest.mark.hosts
@pytest.mark.parametrize("version", VERSIONS)
def test_a_unit_for_all_platforms(version: int, tmp_path: Path) -> None:
    """The unit is that of the command. It takes minutes if Zig builds the libraries of Windows for the first time."""
    zig()
    fmpy()
    derive.write(exported(parse(PUSHED), f"fmu{version}-all"), tmp_path)
    path = tmp_path / f"pushed-fmu{version}-all/pushed.fmu"
    with zipfile.ZipFile(path) as archive:
        archive.extractall(tmp_path / "unit")
        binaries = {name for name in archive.namelist() if name.startswith("binaries/")}
    libraries = {key: f"binaries/{x.folder(version)}/pushed.{x.ending}" for key, x in PLATFORMS.items()}
    assert binaries == set(libraries.values())
    for key, platform in PLATFORMS.items():
        library = tmp_path / "unit" / libraries[key]
        assert f"Format: {FORMATS[key]}\n" in run(program("llvm-readobj"), "--file-headers", library)
        assert visible(library, platform) == functions(version)
        assert needed(library) and all(re.fullmatch(SYSTEM[platform.ending], name) for name in needed(library))
    assert fmpy().validation.validate_fmu(str(path)) == []
    assert simulated(path, "CoSimulation", ["tip[1]"], stop_time=0.01).shape[1] == 1


@pytest.mark.hosts
def test_zig_makes_equal_bytes_in_every_folder() -> None:
    """Without the cache. A library for macOS has a name in it, which must not be that of a temporary folder."""
    zig()
    sources = {"unit.c": '__attribute__((visibility("default"))) double value(double x)\n{\n    return 2.0 * x;\n}\n'}
    target = PLATFORMS["Darwin", "aarch64"]
    with cache.no_cache():
        assert compiled("unit", sources, target) == compiled("unit", sources, target)


@pytest.mark.hosts
def test_without_zig_a_message_says_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(binaries, "find_spec", lambda name: None)
    other = next(platform for platform in PLATFORMS.values() if platform != this_platform())
    with pytest.raises(CompilerError, match=r"need Zig: `pip install tisserand\[compiler\]`"):
        compiled("unit", {"unit.c": ""}, other)
