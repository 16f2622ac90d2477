"""The reference of the command line, from the arguments that `tisserand` declares."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from textwrap import dedent

from derive.cli.arguments.command_line import parser
from website.docstrings import definitions, prose

WIDTH = 88
"""Characters of a line of usage."""


def page() -> str:
    """The Markdown of the page."""
    main = parser()
    parts = [
        "# Command line",
        f"What the commands are for, with examples of their output, is on the page [The commands](commands.md). "
        f"{prose(' '.join((main.description or '').split()), _code)}",
        f"```text\n{dedent(main.epilog or '').strip()}\n```",
    ]
    for name, command, text in commands(main):
        parts += [f"## `{name}`", prose(_sentence(text), _code), f"```text\n{_usage(command)}\n```"]
        own = [(_names(action), "", _help(command, action)) for action in command._actions if _is_shown(action)]
        parts += [definitions(own, _code)] if own else []
    return "\n\n".join(parts) + "\n"


def commands(of: argparse.ArgumentParser) -> Iterator[tuple[str, argparse.ArgumentParser, str]]:
    """The commands of a parser, and the commands of these: the name, the parser and the description of each."""
    for action in of._actions:
        if isinstance(action, argparse._SubParsersAction):
            texts = {choice.dest: choice.help or "" for choice in action._choices_actions}
            for name, command in action.choices.items():
                yield command.prog, command, command.description or texts.get(name, "")
                yield from commands(command)


def _code(text: str) -> str:
    return f"`{text}`"


def _sentence(text: str) -> str:
    text = " ".join(text.split())
    return text if not text or text.endswith((".", ":")) else f"{text[0].upper()}{text[1:]}."


def _usage(command: argparse.ArgumentParser) -> str:
    formatter = argparse.HelpFormatter(command.prog, width=WIDTH)
    formatter.add_usage(command.usage, command._actions, command._mutually_exclusive_groups)
    return formatter.format_help().removeprefix("usage: ").strip()


def _is_shown(action: argparse.Action) -> bool:
    groups = isinstance(action, argparse._HelpAction | argparse._SubParsersAction)
    return not groups and action.help is not argparse.SUPPRESS


def _names(action: argparse.Action) -> str:
    value = action.metavar if isinstance(action.metavar, str) else action.dest.upper()
    if not action.option_strings:
        return value
    return ", ".join(f"{name} {value}" if action.nargs != 0 else name for name in action.option_strings)


def _help(command: argparse.ArgumentParser, action: argparse.Action) -> str:
    return argparse.HelpFormatter(command.prog)._expand_help(action) if action.help else ""
