"""Every command and every piece of code of the README, as printed, in a copy of the tree."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import derive
from conftest import ROOT

RUN_BY_CI = ("make test", ".venv/bin/pytest")
"""These two run this test."""
INSTALLS = ("python3 -m venv", ".venv/bin/pip install")
"""Run by tests/test_package.py in an environment of their own; here .venv is the one that runs the tests."""


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)


def commands() -> list[str]:
    lines = [line.split("  #")[0].strip() for block in blocks("sh") for line in block.splitlines()]
    return [line for line in lines if line and line not in RUN_BY_CI and not line.startswith(INSTALLS)]


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The tree without its environment, which is linked; `make` finds it up to date."""
    folder = tmp_path_factory.mktemp("readme") / "tree"
    ignore = shutil.ignore_patterns(".venv", ".git", "__pycache__", ".*_cache", "results")
    shutil.copytree(ROOT, folder, ignore=ignore)
    (folder / ".venv" / "bin").mkdir(parents=True)
    for tool in ("tisserand", "python"):
        found = Path(sys.executable).parent / tool
        script = folder / ".venv" / "bin" / tool
        script.write_text(f'#!/bin/sh\nexec "{found}" "$@"\n')
        script.chmod(0o755)
    (folder / ".venv" / "installed").touch()
    return folder


def test_commands_are_found() -> None:
    assert len(commands()) >= 6


@pytest.mark.parametrize("command", commands())
def test_command_runs(command: str, copy: Path) -> None:
    before = {p: p.read_bytes() for folder in ("generated", "docs") for p in (copy / folder).rglob("*") if p.is_file()}
    environment = {**os.environ, "PYTHONPATH": str(copy)}
    done = subprocess.run(command, shell=True, cwd=copy, capture_output=True, text=True, env=environment, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout and not done.stderr
    after = {p: p.read_bytes() for p in before}
    assert after == before  # what the README makes is what is committed


def test_python_runs(copy: Path) -> None:
    printed = []
    for block in blocks("python"):
        assert len([line for line in block.splitlines() if line and not line.startswith(("from", "import"))]) <= 10
        done = subprocess.run([sys.executable, "-c", block], cwd=copy, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        printed.append(done.stdout)
    beam, body, scene = printed
    assert "'steps': 1000" in scene
    assert "144*EI*alpha1/l**3" in beam
    inertia = 6.48 / 12 * np.array([0.1**2 + 0.06**2, 0.4**2 + 0.06**2, 0.4**2 + 0.1**2])
    omega = np.array([1.0, 2.0, 3.0])
    euler = -np.cross(omega, inertia * omega) / inertia
    assert np.allclose([float(x) for x in body.strip(" []\n").split()], euler, rtol=1e-6)


def test_specification_is_the_scene() -> None:
    from derive.backends.model_files import specification
    from derive.spec.toml.read import parse

    beam, body, scene = blocks("toml")
    assert parse(beam, "README.md") == derive.read(ROOT / "scenes/free_beam_mean.toml")
    read = parse(body, str(ROOT / "scenes/README.md"))
    assert specification(read) == specification(derive.read(ROOT / "scenes/block.toml"))
    found = parse(scene, "README.md")
    assert specification(found) == specification(derive.read(ROOT / "scenes/crank_slider_3.toml"))


def test_shown_c_is_the_generated_one() -> None:
    (block,) = blocks("c")
    assert block in (ROOT / "generated/free_beam_mean/free_beam_mean.c").read_text()
    assert block.startswith("int free_beam_mean_mass(") and block.endswith("}\n")


def test_links_lead_somewhere() -> None:
    for page in ("README.md", "CONTRIBUTING.md"):
        for target in re.findall(r"\]\(([^)#:]+)\)", (ROOT / page).read_text()):
            assert (ROOT / target).exists(), target
