"""Windows, as far as Linux can tell: encodings of files and consoles, and paths in specifications."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from pathlib import Path, PureWindowsPath

import pytest

from conftest import ROOT
from derive.cli.new import _name_problem

TEXT = ("read_text", "write_text")


def without_encoding(text: str) -> list[int]:
    """The lines that read or write a text in the encoding of the system, which is not UTF-8 everywhere."""
    return [
        node.lineno
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.Call)
        and isinstance(node.func, ast.Attribute)
        and node.func.attr in TEXT
        and "encoding" not in {keyword.arg for keyword in node.keywords}
    ]


def test_texts_are_utf_8_on_every_system() -> None:
    assert without_encoding("p.read_text()\np.write_text(x, encoding='utf-8')") == [1]
    files = (ROOT / "derive").rglob("*.py")
    assert {str(p): lines for p in files if (lines := without_encoding(p.read_text(encoding="utf-8")))} == {}


def test_a_console_without_greek_letters_stops_nothing(tmp_path: Path) -> None:
    environment = {**os.environ, "PYTHONIOENCODING": "cp1252", "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-m", "derive", "new", "arm", "--out", "ξ"]
    done = subprocess.run(command, capture_output=True, env=environment, cwd=tmp_path, check=False)
    assert done.returncode == 0, done.stderr
    assert rb"wrote \u03be/arm.toml" in done.stdout and (tmp_path / "ξ/arm.toml").exists()


def test_names_with_the_folders_of_windows_get_advice(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("derive.cli.new.Path", PureWindowsPath)
    problem = _name_problem(r"models\arm.toml")
    assert problem is not None and problem.endswith(r"tisserand new arm --out models")
