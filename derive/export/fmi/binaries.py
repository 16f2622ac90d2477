"""The binaries of functional mock-up units: for this platform, and through Zig for others."""

from __future__ import annotations

import platform
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

from derive import cache
from derive.errors import TisserandError
from derive.runtime.compiler import FLAGS, WITHOUT_BATCHES, CompilerError
from derive.runtime.loading import library_data

FMU_FLAGS = (*FLAGS, WITHOUT_BATCHES, "-fvisibility=hidden")
"""The flags of the compiler; only the functions of FMI are visible, so that a program can load several units."""


@dataclass(frozen=True)
class Platform:
    """A processor with a system: names of its folder in FMI 2.0 and 3.0, ending of libraries, target of Zig."""

    fmi2: str
    fmi3: str
    ending: str
    target: str

    def folder(self, fmi: int) -> str:
        """The name of the platform's folder below `binaries` in a version of FMI."""
        return self.fmi2 if fmi == 2 else self.fmi3


PLATFORMS = {
    ("Linux", "x86_64"): Platform("linux64", "x86_64-linux", "so", "x86_64-linux-gnu.2.17"),
    ("Linux", "aarch64"): Platform("aarch64-linux", "aarch64-linux", "so", "aarch64-linux-gnu.2.17"),
    ("Windows", "x86_64"): Platform("win64", "x86_64-windows", "dll", "x86_64-windows-gnu"),
    ("Darwin", "x86_64"): Platform("darwin64", "x86_64-darwin", "dylib", "x86_64-macos"),
    ("Darwin", "aarch64"): Platform("aarch64-darwin", "aarch64-darwin", "dylib", "aarch64-macos"),
}
"""The platforms by system and processor. FMI 2.0 has no names for 64-bit ARM, whose folders are named as in FMI 3.0."""

SAME = {"AMD64": "x86_64", "arm64": "aarch64"}
"""Other names of processors."""


class UnknownPlatform(TisserandError):
    """FMI has no name for this platform, or there is none here."""


def this_platform() -> Platform:
    """The platform on which this runs. Raises UnknownPlatform."""
    system, machine = platform.system(), platform.machine()
    known = PLATFORMS.get((system, SAME.get(machine, machine)))
    if known is None:
        raise UnknownPlatform(f"there are no binaries of functional mock-up units for {system} on {machine}")
    return known


def c_files(names: Iterable[str]) -> list[str]:
    """The names of the files that are compiled: the C sources."""
    return [name for name in names if name.endswith(".c")]


def compiled(unit: str, sources: Mapping[str, str], target: Platform) -> bytes:
    """The library of a unit from its sources, which are texts by file names, for a platform.

    The C compiler of simulations makes that of this platform, Zig those of others. Raises CompilerError.
    """
    with tempfile.TemporaryDirectory(prefix="tisserand-") as temporary:
        folder = Path(temporary)
        for file, text in sources.items():
            (folder / file).write_text(text, encoding="utf-8")
        if target == this_platform():
            return library_data([folder / file for file in c_files(sources)], folder, FMU_FLAGS)
        return _crossed(unit, sources, folder, target)


def _crossed(unit: str, sources: Mapping[str, str], folder: Path, target: Platform) -> bytes:
    if find_spec("ziglang") is None:
        raise CompilerError("binaries for other platforms need Zig: `pip install tisserand[compiler]`")
    library = f"{unit}.{target.ending}"  # Windows and macOS keep this name in the file, which must not have a folder
    flags = ["-target", target.target, *FMU_FLAGS, "-s", "-shared", "-fPIC", "-o", library]
    flags += ["-Wl,-Bsymbolic"] if target.ending == "so" else []
    flags += [f"-Wl,-install_name,@rpath/{library}"] if target.ending == "dylib" else []
    key = cache.key("library", "ziglang", version("ziglang"), *flags, *(f"{n}\0{text}" for n, text in sources.items()))
    data = cache.read(key)
    if data is None:
        command = [sys.executable, "-m", "ziglang", "cc", *flags, *c_files(sources), "-lm"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode:
            raise CompilerError(f"zig for {target.target}:\n{done.stderr}")
        data = (folder / library).read_bytes()
        cache.write(key, data)
    return data
