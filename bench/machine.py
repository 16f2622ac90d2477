"""The machine, compiler and versions on which the figures of a run depend, for the head of each table."""

from __future__ import annotations

import platform
import subprocess
from importlib.metadata import version
from pathlib import Path

from derive.runtime.compiler import compiler

NO_AVX512 = "-mno-avx512f"
OWN_OPTION = "-fno-tree-slp-vectorize"
"""Generated code is compiled with it besides the flags of a table, as docs/generated_code.md says; other code not."""


def cpu() -> str:
    """The name of the processor."""
    info = Path("/proc/cpuinfo")
    fields = dict(line.split(":", 1) for line in info.read_text().splitlines() if ":" in line) if info.exists() else {}
    details = {key.strip(): value.strip() for key, value in fields.items()}
    if "model name" not in details:
        return platform.processor() or platform.machine()
    return f"{details['model name']} (family {details.get('cpu family')}, model {details.get('model')})"


def first_line(*command: str) -> str:
    """The first line of the output of a command, such as a version."""
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()[0]
    except (OSError, subprocess.CalledProcessError, IndexError):
        return f"{command[0]}: none"


def native_flags() -> tuple[str, ...]:
    """-O3 -march=native, without AVX-512, which valgrind 3.19 cannot run; no -ffast-math.

    The compiler may fuse a product and a sum (its default in GNU C); derive.load forbids that, to get identical bits.
    """
    macros = subprocess.run(
        [*compiler(), "-march=native", "-dM", "-E", "-x", "c", "-"],
        input="", capture_output=True, text=True, check=True,
    ).stdout  # fmt: skip
    return ("-O3", "-march=native", *((NO_AVX512,) if "__AVX512F__" in macros else ()))


def described(*packages: str) -> list[str]:
    """Lines of text with the machine, the compiler, and the versions of Python and of packages."""
    libraries = ", ".join(f"{name} {version(name)}" for name in packages)
    return [
        f"machine   {cpu()}, {platform.system()} {platform.machine()}, {' '.join(platform.libc_ver())}",
        f"compiler  {first_line(*compiler(), '--version')}",
        f"python    {platform.python_version()}, {libraries}",
    ]
