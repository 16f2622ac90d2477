"""Host sources beside a model, compiled and linked; where SUNDIALS is."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from derive.artifacts import File, write
from derive.errors import TisserandError
from derive.rendering import render
from derive.runtime.compiler import FLAGS, CompilerError, compile_c

Flags = tuple[list[str], list[str]]
"""To compile, and to link."""


class LibraryMissing(TisserandError):
    """SUNDIALS or SuiteSparse is not there; the text says how to install it."""


def written(files: Sequence[File], hosts: Sequence[str], folder: Path) -> tuple[str, list[Path]]:
    """Write a model and hosts into a folder. The name of the model, and all C files."""
    write(files, folder)
    sources = [folder / file.path for file in files if file.path.endswith(".c")]
    if len(sources) != 1:
        raise ValueError(f"a host takes the files of one model; there are {len(sources)} C files among them")
    for part in [f"{host}{ending}" for host in hosts for ending in ((".c",) if host == "simulate" else (".c", ".h"))]:
        (folder / part).write_text(render(f"host/{part}", {}))
    return sources[0].stem, [*sources, *(folder / f"{host}.c" for host in hosts)]


def header(name: str, folder: Path) -> list[str]:
    """The flags that say which model a host is for."""
    return [f"-I{folder}", f"-I{folder / name}", f'-DTISSERAND_HEADER="{name}.h"']


def klu() -> Flags:
    """Flags to compile and to link with KLU of SuiteSparse, see `sundials`. Raises LibraryMissing."""
    return _found("SuiteSparse with KLU", "libsuitesparse-dev", "suite-sparse", "klu.h", ("-lklu",))


def sundials() -> Flags:
    """Flags to compile and to link with SUNDIALS with KLU, in $SUNDIALS_DIR if that is set. Raises LibraryMissing."""
    libraries = tuple(f"-lsundials_{part}" for part in ("ida", "sunlinsolklu", "sunmatrixsparse", "nvecserial"))
    wanted = ("SUNDIALS with KLU", "libsundials-dev libsuitesparse-dev", "sundials", "sunlinsol/sunlinsol_klu.h")
    try:
        return _found(*wanted, libraries)
    except LibraryMissing:
        return _found(*wanted, (*libraries, "-lsundials_core"))  # a library of its own since SUNDIALS 7


@cache
def _found(name: str, debian: str, others: str, include: str, libraries: tuple[str, ...]) -> Flags:
    """Flags with which a program that includes a header can be linked."""
    prefix = os.environ.get("SUNDIALS_DIR", "").strip()
    places = [Path(prefix) / "include"] if prefix else []
    places += [root / "suitesparse" for root in (*places, Path("/usr/include"), Path("/usr/local/include"))]
    flags = [flag for place in places if place.is_dir() for flag in ("-isystem", str(place))]
    link = [*([f"-L{prefix}/lib", f"-Wl,-rpath,{prefix}/lib"] if prefix else []), *libraries]
    with tempfile.TemporaryDirectory(prefix="tisserand-") as folder:
        probe = Path(folder) / "probe.c"
        probe.write_text(f"#include <{include}>\nint main(void) {{ return 0; }}\n")
        try:
            compile_c([probe], Path(folder) / "probe", [*FLAGS, *flags], link)
        except CompilerError as error:
            raise LibraryMissing(
                f"{name} was not found. Install it: `apt-get install {debian}` on Debian and Ubuntu, `brew install "
                f"{others}`, or `conda install {others}`; if it is elsewhere than the compiler looks, set SUNDIALS_DIR "
                f"to the folder that holds its include and lib. The compiler said:\n{error}"
            ) from error
    return flags, link
