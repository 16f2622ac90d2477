"""The same pages give the same site, byte by byte."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from built_site import PAGES, SITE, missing

from conftest import ROOT

pytestmark = pytest.mark.docs


def contents(folder: Path) -> dict[str, bytes]:
    return {file.relative_to(folder).as_posix(): file.read_bytes() for file in folder.rglob("*") if file.is_file()}


def test_a_second_build_gives_the_same_bytes(tmp_path: Path) -> None:
    """Built anew in another folder, with sets in another order."""
    if not PAGES:
        missing("there is no site: make docs")
    environment = {**os.environ, "PYTHONHASHSEED": "7", "PYTHONPATH": str(ROOT)}
    source, site = tmp_path / "source", tmp_path / "site"
    for command in (
        [ROOT / "docs/website/assemble.py", source],
        ["-m", "sphinx", "-q", "-W", "-c", ROOT / "docs", "-d", tmp_path / "doctrees", source, site],
    ):
        subprocess.run([sys.executable, *map(str, command)], env=environment, cwd=ROOT, check=True)
    first, second = contents(SITE), contents(site)
    assert first.keys() == second.keys()
    assert [name for name in first if first[name] != second[name]] == []
