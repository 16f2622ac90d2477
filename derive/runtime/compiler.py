"""The C compiler: which one, how it is called, and what it says when it refuses."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

from derive.errors import TisserandError

FLAGS = ("-std=c99", "-O2", "-ffp-contract=off")
"""No contraction into fused operations: compilers then agree bit for bit."""


class CompilerError(TisserandError):
    """No compiler was found, or it refused the code; the text says which and why."""


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


def _installed() -> list[str]:
    """The C compiler of this machine if CC is not set; empty if there is none."""
    for name in ("cc", "gcc", "clang"):
        if path := shutil.which(name):
            return [path]
    return [sys.executable, "-m", "ziglang", "cc"] if find_spec("ziglang") else []


def compile_shared(sources: Sequence[Path], library: Path, flags: Sequence[str] = FLAGS) -> Path:
    """Compile C files into a shared library. Raises CompilerError with what the compiler said."""
    compile_c(sources, library, [*flags, "-shared", "-fPIC"])
    return library


def compile_c(sources: Sequence[Path], target: Path, flags: Sequence[str], link: Sequence[str] = ()) -> None:
    """Compile C files and link them with `link`. Raises CompilerError with what the compiler said."""
    command = [*compiler(), *flags, "-o", str(target), *map(str, sources), *link, "-lm"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError as error:
        message = f"the C compiler {command[0]} cannot be run: {error.strerror}; set CC to a C compiler, or unset it"
        raise CompilerError(message) from error
    if done.returncode:
        raise CompilerError(f"{shlex.join(command)}\n{done.stderr}")
    if not target.exists():
        raise CompilerError(f"{shlex.join(command)}\nit made no {target.name}; is {command[0]} a C compiler?")
