"""Completion in the shells themselves: a line is typed, the Tab key pressed, and the command notes its words."""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
from pathlib import Path

import pytest

from derive.cli.arguments.command_line import parser
from derive.cli.main import main
from derive.cli.shells.command_tree import command_tree

SHELLS = {
    "bash": "bash --norc --noprofile -i",
    "zsh": "zsh -f -i",
    "fish": "fish --no-config -i",
}
SOURCED = {
    "bash": "tisserand() {{ printf '%s\\n' \"$@\" . >> words; }}; source {script}",
    "zsh": (
        "autoload -U compinit; compinit -u -d dump; tisserand() {{ printf '%s\\n' \"$@\" . >> words }}; source {script}"
    ),
    "fish": "function tisserand; printf '%s\\n' $argv . >> words; end; source {script}",
}
LINES = {
    "sim": ["simulate"],
    "study acc": ["study", "accuracy"],
    "new arm --kind sp": ["new", "arm", "--kind", "space"],
    "run ar": ["run", "arm.toml"],  # not arm.csv
    "run models/ro": ["run", "models/rod.toml"],
    "run tw": ["run", "two words.toml"],
    "build arm.toml models/ro": ["build", "arm.toml", "models/rod.toml"],
    "build arm.toml --sens": ["build", "arm.toml", "--sensitivities"],
    "export arm.toml --to fmu3-": ["export", "arm.toml", "--to", "fmu3-all"],
    "simulate --integrator=gen": ["simulate", "--integrator=generalised-alpha"],
    "study accuracy --own": ["study", "accuracy", "--own-reference"],
    "study frames --own": ["study", "frames", "--own"],  # an option of another study
    "build --out mod": ["build", "--out", "models"],
    "build --out ar": ["build", "--out", "ar"],  # no folder begins like this
    "run --duration ar": ["run", "--duration", "ar"],  # a number, which nothing completes
    "completion fi": ["completion", "fish"],
}
"""Lines typed behind `tisserand`, and the words that the command gets after the Tab key."""


@pytest.fixture(scope="module")
def scripts(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("scripts")
    for shell in SHELLS:
        with (folder / shell).open("w") as file, pytest.MonkeyPatch.context() as patch:
            patch.setattr("sys.stdout", file)
            assert main(["completion", shell]) == 0
    return folder


@pytest.mark.parametrize("shell", SHELLS)
def test_the_tab_key_completes_a_line(shell: str, scripts: Path, tmp_path: Path) -> None:
    if not (shutil.which(shell) and shutil.which("script")):
        assert not os.environ.get("CI"), f"{shell} or script is missing"
        pytest.skip(f"{shell} is not installed")
    (tmp_path / "models").mkdir()
    for name in ("arm.toml", "arm.csv", "two words.toml", "models/rod.toml", "models/rod.csv"):
        (tmp_path / name).touch()
    typed = [SOURCED[shell].format(script=scripts / shell), *(f"tisserand {line}\t" for line in LINES), "exit"]
    environment = {**os.environ, "TERM": "dumb", "HOME": str(tmp_path), "INPUTRC": "/dev/null"}
    subprocess.run(
        ["script", "-qec", SHELLS[shell], "/dev/null"],
        input="".join(f"{line}\n" for line in typed),
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    commands = [part.split("\n") for part in (tmp_path / "words").read_text().split("\n.\n")[:-1]]
    commands = [[word.rstrip("/") for word in words] for words in commands]  # which zsh removes behind a folder
    assert dict(zip(LINES, commands, strict=True)) == LINES


def test_every_option_is_in_every_script(scripts: Path) -> None:
    root = command_tree(parser())
    assert {"run", "new", "study"} <= {command.path[-1] for command in root.commands}
    texts = {shell: (scripts / shell).read_text() for shell in SHELLS}
    for command in root.tree():
        for option in command.options:
            for name in option.names:
                assert name in texts["bash"] and name in texts["zsh"], (command.path, name)
                assert f" {'-l' if name.startswith('--') else '-s'} {name.lstrip('-')} " in texts["fish"]


def test_a_new_command_is_completed_without_another_word() -> None:
    main_parser = argparse.ArgumentParser(prog="tool")
    commands = main_parser.add_subparsers()
    commands.add_parser("first", help="the 1st").add_argument("--size", choices=["big", "small"])
    (command,) = command_tree(main_parser).commands
    assert command.path == ("tool", "first") and command.doc == "the 1st"
    assert command.options[1].names == ("--size",) and command.options[1].value == ("big", "small")
