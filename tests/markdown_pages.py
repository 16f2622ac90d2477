"""Runs the code blocks of a Markdown page as printed, in a copy of the tree.

A comment before a block says what it is: `<!-- file: NAME -->` saves it, `<!-- fails -->` marks a command that must
fail, `<!-- output -->` is what the block before it prints.

`make run` of the README, which builds and compares, its `new` and its Python run in processes of their own, and so does
the first command of each kind that the README does not have. All others run in the process of the tests, which spares
them the start of an interpreter. The blocks of Python of a page continue each other.
"""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable
from contextlib import chdir, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from io import StringIO
from pathlib import Path

from conftest import ROOT
from derive.cli.main import main

README = ROOT / "README.md"
TISSERAND = ".venv/bin/tisserand"
RUN_BY_CI = "make test"
"""The command that runs this test in CI."""
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
    ignore = shutil.ignore_patterns(".venv", ".git", ".*_cache", "results")  # bytecode of the same sources is used
    shutil.copytree(ROOT, tree, ignore=ignore)
    (tree / ".venv" / "bin").mkdir(parents=True)
    for tool in ("tisserand", "python", "fmpy"):
        script = tree / ".venv" / "bin" / tool
        script.write_text(f'#!/bin/sh\nexec "{Path(sys.executable).parent / tool}" "$@"\n')
        script.chmod(0o755)
    (tree / ".venv" / "installed").touch()
    return tree


@dataclass(frozen=True)
class Result:
    """The output of a command, and its exit code."""

    code: int
    out: str
    err: str


def run(command: list[str] | str, tree: Path) -> Result:
    """Run a command in a process of its own in the copy, with the package of the copy."""
    environment = {**os.environ, "PYTHONPATH": str(tree)}
    shell = isinstance(command, str)
    done = subprocess.run(command, shell=shell, cwd=tree, capture_output=True, text=True, env=environment, check=False)
    return Result(done.returncode, done.stdout, done.stderr)


def run_here(call: Callable[[], int | None], tree: Path) -> Result:
    """Call a function in the copy, in this process."""
    out, err = StringIO(), StringIO()
    with chdir(tree), redirect_stdout(out), redirect_stderr(err):
        code = call()
    return Result(code or 0, out.getvalue(), err.getvalue())


def kind(command: str) -> str | None:
    """The command of `tisserand` that a line is, such as `build`; None if it needs a shell, or another program."""
    program, *words = shlex.split(command)
    shell = any(character in command for character in ">|;(")
    return words[0] if words and program == TISSERAND and not shell else None


def run_command(command: str, tree: Path, known: set[str]) -> Result:
    """Run a command line in this process if its kind is known, which it is from then on."""
    if (of := kind(command)) in known:
        return run_here(lambda: main(shlex.split(command)[1:]), tree)
    if of is not None:
        known.add(of)
    return run(command, tree)


def run_python(text: str, tree: Path, namespace: dict[str, object] | None) -> Result:
    """Run Python in this process with the names of earlier blocks, or as a script if there is no namespace."""
    if namespace is None:
        return run([sys.executable, "-c", text], tree)
    return run_here(lambda: exec(text, namespace), tree)


RUN = {"build", "compare", "run", "simulate", "modes", "report"}
"""The kinds of commands that run here on any page: `make run` runs two of them in processes of their own."""

REPORTING = re.compile(r"tisserand (study (accuracy|stability)|choose)")
"""Commands that report their progress on standard error where that is no terminal."""


def run_page(page: Path, tree: Path) -> dict[Block, str]:
    """Run the blocks of a page in their order; what each of them prints."""
    outputs: dict[Block, str] = {}
    last = ""
    here = page != README
    namespace: dict[str, object] | None = {"__name__": "__main__"} if here else None
    known = (
        {of for block in blocks(README, "sh") for line in block.commands() if (of := kind(line))} if here else {*RUN}
    )
    for block in blocks(page):
        if block.comment.startswith("file: "):
            (tree / block.comment.removeprefix("file: ")).write_text(block.text)
        elif block.comment == "output":
            assert block.text == last, f"shown:\n{block.text}\nprinted:\n{last}"
        elif block.language == "python":
            done = run_python(block.text, tree, namespace)
            assert done.code == 0, done.err
            outputs[block] = last = done.out
        elif block.language == "sh":
            for command in block.commands():
                done = run_command(command, tree, known)
                assert (done.code != 0) == (block.comment == "fails"), f"{command}\n{done.out}{done.err}"
                assert done.err or block.comment != "fails"
                assert block.comment == "fails" or REPORTING.search(command) or not done.err, done.err
                outputs[block] = last = done.out + done.err
    return outputs
