"""The programs that exports are for: where one is missing, its tests are skipped, and fail in CI with its package."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Mapping
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

import pytest

PACKAGES: Mapping[str, str] = dict(
    line.split()
    for line in (Path(__file__).parent / "packages.txt").read_text().splitlines()
    if line and not line.startswith("#")
)
"""The Debian packages of the programs."""


def program(name: str) -> str:
    """The path of a program of `packages.txt`."""
    if path := shutil.which(name):
        return path
    message = f"{name} is missing: apt-get install {PACKAGES[name]}"
    if os.environ.get("CI"):
        pytest.fail(message, pytrace=False)
    pytest.skip(message)


def package(name: str) -> ModuleType:
    """A Python package of the extra `hosts`."""
    if find_spec(name):
        return import_module(name)
    message = f"{name} is missing: pip install tisserand[hosts]"
    if os.environ.get("CI"):
        pytest.fail(message, pytrace=False)
    pytest.skip(message)


def run(*command: str | Path, cwd: Path | None = None, **environment: str) -> str:
    """All that a command says that has to succeed; `environment` are further variables."""
    done = subprocess.run(
        list(map(str, command)),
        cwd=cwd,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
        env={**os.environ, **environment},
    )
    assert done.returncode == 0, f"{' '.join(map(str, command))}\n{done.stdout}"
    return done.stdout


def version(name: str) -> str:
    """The first number with a dot in what a program says of its version."""
    (number,) = re.findall(r"\d+\.\d+(?:\.\d+)?", run(program(name), "--version"))[:1]
    return str(number)
