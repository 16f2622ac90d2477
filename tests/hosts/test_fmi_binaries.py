"""Binaries of units for other platforms, inspected: their processor, and exactly the functions of FMI."""

from __future__ import annotations

import re
import zipfile
from io import BytesIO
from pathlib import Path

import pytest
from fmus import VERSIONS, fmpy, model_of
from programs import program, run

from derive import cache
from derive.export import fmi_binaries
from derive.export.fmi import fmu
from derive.export.fmi_binaries import PLATFORMS, CompilerError, Platform, compiled, this_platform

FORMATS = {
    ("Linux", "x86_64"): "elf64-x86-64",
    ("Linux", "aarch64"): "elf64-littleaarch64",
    ("Windows", "x86_64"): "COFF-x86-64",
    ("Darwin", "x86_64"): "Mach-O 64-bit x86-64",
    ("Darwin", "aarch64"): "Mach-O arm64",
}
"""What llvm-readobj says of each."""


def zig() -> None:
    pytest.importorskip("ziglang", reason="Zig is missing: make test-hosts installs it")


def functions(version: int) -> set[str]:
    """The functions of FMI, as the header with which FMPy compiles units declares them."""
    header = Path(fmpy().__file__).parent / f"c-code/fmi{version}FunctionTypes.h"
    return {name.removesuffix("TYPE") for name in re.findall(rf"\bfmi{version}\w+TYPE\b", header.read_text())}


def exported(library: Path, platform: Platform) -> set[str]:
    """The functions that others can call."""
    match platform.ending:
        case "dll":
            return set(re.findall(r"Name: (\w+)\n", run(program("llvm-readobj"), "--coff-exports", library)))
        case "dylib":
            names = run(program("llvm-nm"), "--extern-only", "--defined-only", "--just-symbol-name", library).split()
            return {name[1:] for name in names} - {"__dso_handle", "_mh_dylib_header"}
        case _:
            return set(run(program("llvm-nm"), "-D", "--defined-only", "--just-symbol-name", library).split())


WINDOWS = "Windows", "x86_64"


def inspect(key: tuple[str, str], version: int, folder: Path) -> None:
    """The unit of a model with the binary of one platform."""
    zig()
    platform = PLATFORMS[key]
    with zipfile.ZipFile(BytesIO(fmu(model_of("pushed"), version, [platform]))) as archive:
        archive.extractall(folder)
    library = folder / f"binaries/{platform.folder(version)}/pushed.{platform.ending}"
    assert f"Format: {FORMATS[key]}\n" in run(program("llvm-readobj"), "--file-headers", library)
    assert exported(library, platform) == functions(version)


@pytest.mark.hosts
@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("key", [key for key in PLATFORMS if key != WINDOWS], ids="-".join)
def test_a_binary_has_its_processor_and_functions(key: tuple[str, str], version: int, tmp_path: Path) -> None:
    inspect(key, version, tmp_path)


@pytest.mark.long  # Zig builds the libraries of Windows, which takes minutes
def test_a_binary_for_windows_has_its_processor_and_functions(tmp_path: Path) -> None:
    inspect(WINDOWS, 3, tmp_path)


@pytest.mark.hosts
def test_zig_makes_equal_bytes_in_every_folder() -> None:
    """Without the cache. A library for macOS has a name in it, which must not be that of a temporary folder."""
    zig()
    sources = {"unit.c": '__attribute__((visibility("default"))) double value(double x)\n{\n    return 2.0 * x;\n}\n'}
    target = PLATFORMS["Darwin", "aarch64"]
    with cache.no_cache():
        assert compiled(sources, target) == compiled(sources, target)


@pytest.mark.hosts
def test_without_zig_a_message_says_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fmi_binaries, "find_spec", lambda name: None)
    other = next(platform for platform in PLATFORMS.values() if platform != this_platform())
    with pytest.raises(CompilerError, match=r"need Zig: `pip install tisserand\[compiler\]`"):
        compiled({"unit.c": ""}, other)
