"""Runs the code blocks of a Markdown page as printed, in a copy of the tree.

A comment before a block says what it is: `<!-- file: NAME -->` saves it, `<!-- fails -->` marks a command that must
fail, `<!-- output -->` is what the block before it prints.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from conftest import ROOT

RUN_BY_CI = "make test"
"""It runs this test."""
INSTALLS = ("python3 -m venv", ".venv/bin/pip install")
"""Run by tests/test_package.py in an environment of their own; here .venv is the one that runs the tests."""
BLOCK = re.compile(r"(?:<!-- (?P<comment>.*?) -->\n)?```(?P<language>\w+)\n(?P<text>.*?)```", re.DOTALL)


@dataclass(frozen=True)
class Block:
    """A code block of a page."""

    language: str
    text: str
    comment: str

    def commands(self) -> list[str]:
        """The command lines of a block of shell commands, without remarks and without those that run elsewhere."""
        lines = [line.split("  #")[0].strip() for line in self.text.splitlines()]
        return [line for line in lines if line and line != RUN_BY_CI and not line.startswith(INSTALLS)]


def blocks(page: Path, language: str | None = None) -> list[Block]:
    """The code blocks of a page, or those in one language."""
    found = [Block(m["language"], m["text"], m["comment"] or "") for m in BLOCK.finditer(page.read_text())]
    return [block for block in found if language in (None, block.language)]


def copy_tree(folder: Path) -> Path:
    """A copy of the tree whose .venv runs the interpreter of the tests; `make` finds it up to date."""
    tree = folder / "tree"
    ignore = shutil.ignore_patterns(".venv", ".git", "__pycache__", ".*_cache", "results")
    shutil.copytree(ROOT, tree, ignore=ignore)
    (tree / ".venv" / "bin").mkdir(parents=True)
    for tool in ("tisserand", "python"):
        script = tree / ".venv" / "bin" / tool
        script.write_text(f'#!/bin/sh\nexec "{Path(sys.executable).parent / tool}" "$@"\n')
        script.chmod(0o755)
    (tree / ".venv" / "installed").touch()
    return tree


def run(command: list[str] | str, tree: Path) -> subprocess.CompletedProcess[str]:
    """Run a command in the copy, with the package of the copy."""
    environment = {**os.environ, "PYTHONPATH": str(tree)}
    shell = isinstance(command, str)
    return subprocess.run(command, shell=shell, cwd=tree, capture_output=True, text=True, env=environment, check=False)


def run_page(page: Path, tree: Path) -> dict[Block, str]:
    """Run the blocks of a page in their order; what each of them prints."""
    outputs: dict[Block, str] = {}
    last = ""
    for block in blocks(page):
        if block.comment.startswith("file: "):
            (tree / block.comment.removeprefix("file: ")).write_text(block.text)
        elif block.comment == "output":
            assert block.text == last
        elif block.language == "python":
            done = run([sys.executable, "-c", block.text], tree)
            assert done.returncode == 0, done.stderr
            outputs[block] = last = done.stdout
        elif block.language == "sh":
            for command in block.commands():
                done = run(command, tree)
                assert (done.returncode != 0) == (block.comment == "fails"), f"{command}\n{done.stdout}{done.stderr}"
                assert bool(done.stderr) == (block.comment == "fails"), done.stderr
                outputs[block] = last = done.stdout + done.stderr
    return outputs
