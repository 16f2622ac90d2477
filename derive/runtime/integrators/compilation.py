"""Sources of C integrators beside those of a model: files, flags, libraries, and the stand-alone program."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Collection, Sequence
from functools import cache
from pathlib import Path

from derive.artifacts import File, write
from derive.errors import TisserandError
from derive.rendering import render
from derive.runtime.compiler import FLAGS, CompilerError, compile_c

Flags = tuple[list[str], list[str]]
"""The flags of the compiler, and those of the linker."""


class LibraryMissing(TisserandError):
    """SUNDIALS or SuiteSparse is not installed; the text says how to install it."""


def write_sources(files: Sequence[File], integrators: Sequence[str], folder: Path) -> tuple[str, list[Path]]:
    """Write a model and C integrators of `templates/host` into a folder; returns the model's name and all C files.

    Raises ValueError unless `files` has exactly one C file.
    """
    write(files, folder)
    sources = [folder / file.path for file in files if file.path.endswith(".c")]
    if len(sources) != 1:
        raise ValueError(f"an integrator takes the files of one model; there are {len(sources)} C files among them")
    return sources[0].stem, [*sources, *host_sources(integrators, folder)]


def host_sources(names: Sequence[str], folder: Path) -> list[Path]:
    """Write parts of `templates/host` with these names into a folder; returns their C files."""
    for name in names:
        for ending in (".c",) if name == "simulate" else (".c", ".h"):
            (folder / f"{name}{ending}").write_text(render(f"host/{name}{ending}", {}), encoding="utf-8")
    return [folder / f"{name}.c" for name in names]


def header_flags(name: str, folder: Path) -> list[str]:
    """The flags that select the model of the integrators."""
    return [f"-I{folder}", f"-I{folder / name}", f'-DTISSERAND_HEADER="{name}.h"']


def klu() -> Flags:
    """The flags of KLU of SuiteSparse, see `sundials`. Raises LibraryMissing."""
    return _library_flags("SuiteSparse with KLU", "libsuitesparse-dev", "suite-sparse", "klu.h", ("-lklu",))


def sundials() -> Flags:
    """The flags of SUNDIALS with KLU, in $SUNDIALS_DIR if that is set. Raises LibraryMissing."""
    libraries = tuple(f"-lsundials_{part}" for part in ("ida", "sunlinsolklu", "sunmatrixsparse", "nvecserial"))
    library = ("SUNDIALS with KLU", "libsundials-dev libsuitesparse-dev", "sundials", "sunlinsol/sunlinsol_klu.h")
    try:
        return _library_flags(*library, libraries)
    except LibraryMissing:
        return _library_flags(*library, (*libraries, "-lsundials_core"))  # a library of its own since SUNDIALS 7


@cache
def _library_flags(name: str, debian: str, others: str, include: str, libraries: tuple[str, ...]) -> Flags:
    """The flags with which a program that includes a header compiles and links. Raises LibraryMissing."""
    prefix = os.environ.get("SUNDIALS_DIR", "").strip()
    folders = [Path(prefix) / "include"] if prefix else []
    folders += [root / "suitesparse" for root in (*folders, Path("/usr/include"), Path("/usr/local/include"))]
    flags = [flag for folder in folders if folder.is_dir() for flag in ("-isystem", str(folder))]
    link = [*([f"-L{prefix}/lib", f"-Wl,-rpath,{prefix}/lib"] if prefix else []), *libraries]
    with tempfile.TemporaryDirectory(prefix="tisserand-") as temporary:
        probe = Path(temporary) / "probe.c"
        probe.write_text(f"#include <{include}>\nint main(void) {{ return 0; }}\n", encoding="utf-8")
        try:
            compile_c([probe], Path(temporary) / "probe", [*FLAGS, *flags], link)
        except CompilerError as error:
            raise LibraryMissing(
                f"{name} was not found. Install it: `apt-get install {debian}` on Debian and Ubuntu, `brew install "
                f"{others}`, or `conda install {others}`; if it is elsewhere than the compiler looks, set SUNDIALS_DIR "
                f"to the folder that holds its include and lib. The compiler reports:\n{error}"
            ) from error
    return flags, link


def program(files: Sequence[File], target: Path, methods: Collection[str] = (), flags: Sequence[str] = ()) -> Path:
    """Compile the program `templates/host/simulate.c` of a model into `target`.

    methods: "ida" and "alpha" are added to "adaptive" and "rk4", which need no library.

    Raises CompilerError, LibraryMissing.
    """
    sources, options = ["simulate", "adaptive_rows", "adaptive", "dormand_prince", "fixed_step"], list(flags)
    link: list[str] = []
    alpha = ("rotations", "generalised_alpha")
    for method, own, library in (("ida", ("ida",), sundials), ("alpha", alpha, klu)):
        if method in methods:
            include, libraries = library()
            sources, link = [*sources, *own], [*link, *libraries]
            options += [*include, f"-DTISSERAND_{method.upper()}"]
    with tempfile.TemporaryDirectory(prefix="tisserand-") as folder:
        name, paths = write_sources(files, sources, Path(folder))
        options += [f"-DTISSERAND_MODEL={name}_model", *header_flags(name, Path(folder))]
        compile_c(paths, target, [*FLAGS, *options], link)
    return target
