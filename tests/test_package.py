"""The wheel, in an environment of its own: it brings its templates and builds a model. tools/release.py tries more."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

from conftest import ROOT
from markdown_pages import INSTALLS, README, TISSERAND, blocks


def run(*command: str, cwd: Path) -> str:
    environment = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "VIRTUAL_ENV")}
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False, env=environment)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def distributions(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("dist")
    run(sys.executable, "-m", "build", "--outdir", str(folder), str(ROOT), cwd=folder)
    return folder


@pytest.mark.long
def test_the_install_commands_of_the_readme(tmp_path: Path) -> None:
    """`python3 -m venv` and `pip install -e` as printed, in a copy, then the first command after them."""

    ignore = shutil.ignore_patterns(".venv", ".git", "__pycache__", ".*_cache")
    shutil.copytree(ROOT, tmp_path / "tree", ignore=ignore)
    (block,) = (block for block in blocks(README, "sh") if block.text.startswith(INSTALLS))
    create, install, first, *_ = block.text.splitlines()
    assert install.startswith(INSTALLS) and first.startswith(f"{TISSERAND} build scenes/")
    for line in (create, install, first):
        run("sh", "-c", line, cwd=tmp_path / "tree")


@pytest.mark.long
def test_wheel_builds_a_model_in_an_environment_of_its_own(distributions: Path, tmp_path: Path) -> None:
    """The dependencies are those of this environment; that they are complete, the commands of the README show."""
    (wheel,) = distributions.glob("*.whl")
    run(sys.executable, "-m", "venv", "env", cwd=tmp_path)
    bin_folder = tmp_path / "env" / "bin"
    run(str(bin_folder / "pip"), "install", "--quiet", "--no-deps", str(wheel), cwd=tmp_path)
    (packages,) = (tmp_path / "env").glob("lib/python*/site-packages")
    (packages / "dependencies.pth").write_text(sysconfig.get_path("purelib"))
    where = run(str(bin_folder / "python"), "-c", "import derive; print(derive.__file__)", cwd=tmp_path)
    assert where.startswith(str(packages))
    scene = ROOT / "scenes/free_beam_mean.toml"
    said = run(str(bin_folder / "tisserand"), "build", str(scene), cwd=tmp_path)
    assert "free_beam_mean" in said
    made = tmp_path / "generated/free_beam_mean/free_beam_mean.c"
    assert made.read_bytes() == (ROOT / "generated/free_beam_mean/free_beam_mean.c").read_bytes()
