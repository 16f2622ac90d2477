"""The C compiler: its choice, its options, its calls, and the errors that it reports."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Collection, Sequence
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory

from derive.backends.c.optional_parts import OptionalPart
from derive.errors import TisserandError

FLAGS = ("-std=c99", "-O2", "-ffp-contract=off", "-fno-tree-slp-vectorize")
"""The options of the compiler. Operations are not contracted into fused ones, so that compilers agree bit for bit.
Neighbouring statements are not vectorised: gcc takes longer to gather their elements than vectors save, and it fuses
operations there in spite of the other option."""

WITHOUT_BATCHES = f"-D{OptionalPart.BATCHES.value}"

ESSENTIAL = (WITHOUT_BATCHES, f"-D{OptionalPart.REDUCED_FORMS.value}")
"""Options for callers of neither batches nor forms of reduced index, such as explicit integrators: they halve the time
of the compiler."""

RUN_FLAGS = (*FLAGS, *ESSENTIAL)

QUICK_FLAGS, UNOPTIMISED = (
    (*(flag if flag != "-O2" else level for flag in FLAGS), *ESSENTIAL) for level in ("-O1", "-O0")
)
"""Compiler options of models whose runs are not timed: the compiler takes two thirds of the time, and runs take about
the same; and of models with short runs, or that are evaluated a few times: the compiler takes a third of the time, and
runs take twice as long. All options give the same bits."""

OWN_SYMBOLS = () if sys.platform in ("darwin", "win32", "cygwin") else ("-Wl,-Bsymbolic",)
"""Options of the linker of ELF: a library calls its own functions even if the process has opened another one globally
with functions of the same names, such as another model of the same name. Other systems do so by default."""

VECTORS = {
    "avx512f avx512dq avx512vl": ("-mavx512f", "-mavx512dq", "-mavx512vl", "-mprefer-vector-width=512"),
    "avx2": ("-mavx2",),
}
"""The features that a processor must have, and the compiler options for its vectors, the widest first."""


class CompilerError(TisserandError):
    """No compiler was found, or it refused the code; the text says which and why.

    A function that a library does not have, such as one of sensitivities, raises it as well.

    Examples:
        >>> import derive
        >>> beam = derive.planar_beam("beam")
        >>> native = derive.load(derive.model_files(derive.lower(derive.derive(beam)), beam))
        >>> try:
        ...     native.solve_kkt(0.0, [0] * 5, native.setup(), [0] * 5)
        ... except derive.CompilerError as error:
        ...     print(error)
        beam has no solve_kkt; generate it with sensitivities
    """


def compiler() -> list[str]:
    """The C compiler to call: $CC, cc, gcc, clang, or the one in the Python package `ziglang`."""
    if chosen := os.environ.get("CC", "").strip():
        try:
            command = shlex.split(chosen)
        except ValueError as error:
            raise CompilerError(f"CC={chosen}: this is no command line: {error}") from error
        if not shutil.which(command[0]):
            other = _installed()
            instead = f"unset it, and {shlex.join(other)} is used" if other else "unset it and install gcc or clang"
            raise CompilerError(
                f"CC={chosen}: there is no command {command[0]}; set the environment variable CC to a C compiler, such "
                f"as gcc or clang, or {instead}"
            )
        return command
    if installed := _installed():
        return installed
    raise CompilerError("no C compiler found: set CC, install gcc or clang, or `pip install tisserand[compiler]`")


def vector_flags(features: Collection[str] | None = None) -> tuple[str, ...]:
    """Compiler options for the vectors of this processor that keep the bits of FLAGS.

    Arguments:
        features: those of another processor, by their names in /proc/cpuinfo of Linux; by default those of this one.
            Other processors than those of x86, and systems without that file, have FLAGS.

    Returns:
        The options, for `derive.load(files, flags)`.

    Examples:
        >>> import derive
        >>> derive.vector_flags([])
        ('-std=c99', '-O2', '-ffp-contract=off', '-fno-tree-slp-vectorize')
    """
    available = _features() if features is None else features
    for needed, options in VECTORS.items():
        if all(feature in available for feature in needed.split()):
            return (*FLAGS, "-O3", *options)
    return FLAGS


@cache
def _features() -> frozenset[str]:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return frozenset()
    return frozenset(next((line.split(":", 1)[1].split() for line in lines if line.startswith("flags")), []))


def _installed() -> list[str]:
    """The C compiler of this machine if CC is not set; empty if there is none."""
    for name in ("cc", "gcc", "clang"):
        if path := shutil.which(name):
            return [path]
    return [sys.executable, "-m", "ziglang", "cc"] if find_spec("ziglang") else []


def compiler_identity() -> str:
    """The C compiler and the version that it prints, by which the cache distinguishes the libraries of compilers.

    Raises CompilerError.
    """
    return _identity(tuple(compiler()))


@cache
def _identity(command: tuple[str, ...]) -> str:
    try:
        done = subprocess.run([*command, "--version"], capture_output=True, text=True, check=False)
    except OSError as error:
        raise _cannot_run(command[0], error) from error
    file = Path(shutil.which(command[0]) or command[0]).stat()  # a script may have changed, and print the same version
    return f"{shlex.join(command)}\n{file.st_size} {file.st_mtime_ns}\n{done.stdout}"


def _cannot_run(command: str, error: OSError) -> CompilerError:
    message = f"the C compiler {command} cannot be run: {error.strerror}; set CC to a C compiler, or unset it"
    return CompilerError(message)


FAST = frozenset({"-ffast-math", "-Ofast", "-funsafe-math-optimizations"})
"""Options for which gcc before 13 and clang link code that makes threads that load a library round denormals to 0."""


def compile_shared(
    sources: Sequence[Path], library: Path, flags: Sequence[str] = FLAGS, link: Sequence[str] = ()
) -> Path:
    """Compile C files into a shared library. Raises CompilerError with the output of the compiler.

    Loading it leaves the arithmetic of the process alone, whatever the flags: options among `FAST` are not for linkers.
    """
    of_library = ["-shared", "-fPIC", *OWN_SYMBOLS]
    if FAST.isdisjoint(flags):
        compile_c(sources, library, [*flags, *of_library], link)
        return library
    with TemporaryDirectory() as folder:
        objects = [Path(folder) / f"{number}.o" for number in range(len(sources))]
        for source, target in zip(sources, objects, strict=True):
            compile_c([source], target, [*flags, "-c", "-fPIC"])
        compile_c(objects, library, [*(flag for flag in flags if flag not in FAST), *of_library], link)
    return library


def compile_c(sources: Sequence[Path], target: Path, flags: Sequence[str], link: Sequence[str] = ()) -> None:
    """Compile C files and link them with `link`. Raises CompilerError with the output of the compiler."""
    command = [*compiler(), *flags, "-o", str(target), *map(str, sources), *link, "-lm"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError as error:
        raise _cannot_run(command[0], error) from error
    if done.returncode:
        raise CompilerError(f"{shlex.join(command)}\n{done.stderr}")
    if not target.exists():
        raise CompilerError(f"{shlex.join(command)}\nit made no {target.name}; is {command[0]} a C compiler?")
