"""The arguments of `tisserand new`, `run` and `completion`. Only the standard library is imported here."""

from __future__ import annotations

from typing import Any

from derive.cli.arguments.simulation import add_simulation
from derive.cli.arguments.types import add_command, add_folder

KINDS = {
    "mechanism": "a crank-slider in the plane with a flexible rod",
    "beam": "a flexible beam that moves freely in the plane",
    "space": "a pendulum in space that carries a spinning disc",
}
"""The specifications that `new` writes, of which the first is the default; templates/new has a file for each."""

SHELLS = ("bash", "zsh", "fish")
"""The shells that `completion` has scripts for."""


def add_new(commands: Any) -> None:
    """Add the command `new`."""
    new = add_command(commands, "new", "write a commented specification that runs, to start from")
    new.add_argument("name", metavar="NAME", help="name of the model; the file is NAME.toml")
    default, *_ = KINDS
    kinds = ", ".join(f"{kind} ({text})" for kind, text in KINDS.items())
    new.add_argument(
        "--kind", choices=[*KINDS], default=default, help=f"what it specifies: {kinds} (default: {default})"
    )
    add_folder(new, ".")


def add_run(commands: Any) -> None:
    """Add the command `run`."""
    run = add_command(
        commands, "run", "simulate a specification and write the page of its results, or its report without motion"
    )
    add_simulation(run)
    run.add_argument("--open", action="store_true", help="open the page in the browser")


def add_completion(commands: Any) -> None:
    """Add the command `completion`."""
    completion = add_command(commands, "completion", "print a script that lets a shell complete commands")
    completion.add_argument("shell", choices=SHELLS, metavar="SHELL", help=f"the shell: {', '.join(SHELLS)}")
