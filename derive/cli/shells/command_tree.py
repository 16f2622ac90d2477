"""The tree of commands with their options and values, read from an argument parser, as scripts of shells need it."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum, auto
from pathlib import Path

from derive.cli.arguments.types import export_kind, folder, integrator, page_file, spec_file


class Paths(Enum):
    """Which files a value may name."""

    SPECIFICATIONS = auto()
    FOLDERS = auto()
    FILES = auto()


Value = tuple[str, ...] | Paths
"""The completions of a value: words, of which there may be none, or files."""


@dataclass(frozen=True)
class Option:
    """An option with all its names. value: what completes its value, None if it takes none."""

    names: tuple[str, ...]
    doc: str
    metavar: str
    value: Value | None
    repeated: bool


@dataclass(frozen=True)
class Command:
    """A command with its options and its commands.

    path: with all words before it. argument: what completes its argument, None if it has none. several: whether there
    may be several arguments.
    """

    path: tuple[str, ...]
    doc: str
    options: tuple[Option, ...]
    argument: Value | None
    several: bool
    commands: tuple[Command, ...]

    def tree(self) -> Iterator[Command]:
        """This command and all below it."""
        yield self
        for command in self.commands:
            yield from command.tree()


def command_tree(parser: argparse.ArgumentParser, doc: str = "", path: tuple[str, ...] = ()) -> Command:
    """The commands of a parser; `doc` and `path` are those of the command whose parser it is."""
    path = path or (parser.prog,)
    options: list[Option] = []
    commands: list[Command] = []
    argument: Value | None = None
    several = False
    for action in parser._actions:  # argparse has no other way to them
        if isinstance(action, argparse._SubParsersAction):
            docs = {choice.dest: choice.help or "" for choice in action._choices_actions}
            commands += [command_tree(sub, docs[name], (*path, name)) for name, sub in action.choices.items()]
        elif action.option_strings:
            value = None if action.nargs == 0 else _value(action)
            repeated = isinstance(action, argparse._AppendAction)
            names = (*action.option_strings,)
            options.append(Option(names, action.help or "", str(action.metavar or "value"), value, repeated))
        else:
            argument, several = _value(action), action.nargs == argparse.ONE_OR_MORE
    return Command(path, doc, (*options,), argument, several, (*commands,))


def _value(action: argparse.Action) -> Value:
    """The completions of the value of an action: its choices, or what its type stands for."""
    if action.choices is not None:
        return tuple(map(str, action.choices))
    kind = action.type
    if kind in REGISTRIES:
        return REGISTRIES[kind]()
    return PATHS.get(kind, ())


PATHS: dict[object, Paths] = {
    spec_file: Paths.SPECIFICATIONS,
    folder: Paths.FOLDERS,
    Path: Paths.FILES,
    page_file: Paths.FILES,
}
"""The files that values of these types name."""


def _interfaces() -> tuple[str, ...]:
    from derive.export.registry import INTERFACES

    return (*INTERFACES,)


def _integrators() -> tuple[str, ...]:
    from derive.simulation.integration.registry import INTEGRATORS

    return (*INTEGRATORS,)


REGISTRIES: dict[object, Callable[[], tuple[str, ...]]] = {export_kind: _interfaces, integrator: _integrators}
"""The names that values of these types take from registries, which only scripts load, not the command line."""
