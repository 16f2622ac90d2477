"""Fixtures of all tests: golden files, which `pytest --update` accepts, and the flags of quick compilations."""

from __future__ import annotations

import gc
import os
import shutil
import tempfile
from collections.abc import Callable
from difflib import unified_diff
from pathlib import Path
from typing import Any

import pytest

# Matrices are small here, and threads of workers that share a processor wait for each other. NumPy reads this once.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# SymPy reads this once as well: of the results that it keeps, the thousand of its default are lost between two tests.
os.environ.setdefault("SYMPY_CACHE_SIZE", "200000")

ROOT = Path(__file__).parent.parent
QUICK = ("-std=c99", "-O0", "-ffp-contract=off")
"""Compiles in a fifth of the time of -O2, and gives the same bits: for tests that do not depend on the optimisation."""


_CACHES = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
os.environ.setdefault("MPLCONFIGDIR", str(_CACHES / "matplotlib"))  # matplotlib would search for all fonts again
# Zig would build the libraries of other systems again, which takes minutes.
os.environ.setdefault("ZIG_GLOBAL_CACHE_DIR", str(_CACHES / "zig"))
CACHE = None if "PYTEST_XDIST_WORKER" in os.environ else tempfile.TemporaryDirectory(prefix="tisserand-cache-")
COMPILER = """#!/bin/sh
case "$*" in
*-Wall*|*" -g "*) exec cc "$@" ;;
*TISSERAND_WITHOUT_*|*-O0*) ;;
*"{defaults} "*" -O"*) exec cc "$@" ;;
*"{defaults} "*) ;;
*) exec cc "$@" ;;
esac
sources=0
for argument; do
    case "$argument" in
    *.c) sources=$((sources + 1)) ;;
    -l?*) [ "$argument" = -lm ] || sources=2 ;;
    esac
    [ "$before" = -o ] && target=$argument
    before=$argument
done
case "$sources $*" in
"1 "*" -shared "*)
    {quick} "$@" -O0 -c -o "$target.o" || exit
    ld -shared -Bsymbolic -o "$target" "$target.o" -lm -lc && exec rm "$target.o" ;;
esac
exec {quick} "$@" -O0
"""
"""Does not optimise what simulations run, nor what is compiled without a word on flags, for QUICK's reason.

clang takes half the time of gcc for that, and calls of the linker itself spare the start of another compiler. Those who
ask for warnings get the compiler that they expect, and so do those who choose flags, if only the same level once more.
"""
if CACHE:  # that of the user is neither read nor written, nor by programs that tests run; workers share it
    os.environ["XDG_CACHE_HOME"] = CACHE.name
    if shutil.which("cc"):
        from derive.runtime.compiler import FLAGS

        script = Path(CACHE.name) / "cc"
        quick = "clang -Qunused-arguments" if shutil.which("clang") else "cc"
        script.write_text(COMPILER.format(quick=quick, defaults=" ".join(FLAGS)))
        script.chmod(0o700)
        os.environ.setdefault("CC", str(script))


def pytest_unconfigure() -> None:
    if CACHE:
        CACHE.cleanup()


def pytest_sessionstart() -> None:
    """Collect tests without searches for unreachable objects."""
    gc.disable()


def pytest_collection_finish() -> None:
    """Search for unreachable objects rarely: expressions are many small objects, which are freed by their counts.

    With the defaults of Python, a tenth of all time is spent on going through them.
    """
    gc.set_threshold(100_000, 20, 20)
    gc.enable()


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--update", action="store_true", help="write golden files instead of comparing with them")


def random_cases(first: int, long: int, further: int) -> list[Any]:
    """Parameters of a test of random cases: `long` seeds from the first one on with that mark, and `further` ones."""
    marks = [pytest.mark.long] * long + [pytest.mark.further] * further
    return [pytest.param(seed, marks=mark) for seed, mark in enumerate(marks, first)]


@pytest.fixture
def compare_or_update(request: pytest.FixtureRequest) -> Callable[[Path, str], None]:
    """Compare a text with a committed file; a failure shows the diff and the command that accepts it."""

    def compare(path: Path, text: str) -> None:
        if request.config.getoption("--update"):
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
            return
        found = path.read_text() if path.exists() else ""
        if found != text:
            diff = "\n".join(unified_diff(found.splitlines(), text.splitlines(), str(path), "now", lineterm=""))
            pytest.fail(f"{diff}\n\nto accept: pytest --update {request.node.nodeid}", pytrace=False)

    return compare
