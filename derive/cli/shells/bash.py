"""Completion for bash 3.2 and newer: one function that finds the command among the words of the line."""

from __future__ import annotations

import shlex

from derive.cli.shells.command_tree import Command, Paths, Value

SCRIPT = """\
# Completes the commands of {program} in bash: source this file, or save it as
# ~/.local/share/bash-completion/completions/{program}. Written by `{program} completion bash`.
_{program}() {{
    local cur=${{COMP_WORDS[COMP_CWORD]}} prev=${{COMP_WORDS[COMP_CWORD - 1]}}
    local command={program} word line options= words= paths=
    [[ $cur == "=" ]] && cur=
    [[ $prev == "=" ]] && prev=${{COMP_WORDS[COMP_CWORD - 2]}}
    for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
        case "$command $word" in
        {commands}) command="$command $word" ;;
        esac
    done
    case "$command $prev" in
{values}
    *)
        case "$command" in
{arguments}
        esac
        ;;
    esac
    [[ $cur == -* || -z $words$paths ]] && words=$options paths=
    COMPREPLY=()
    while IFS= read -r line; do
        COMPREPLY+=("$line")
    done < <(
        [[ -z $words ]] || compgen -W "$words" -- "$cur"
        case "$paths" in
        specifications) compgen -f -X '!*.toml' -- "$cur"; compgen -d -- "$cur" ;;
        folders) compgen -d -- "$cur" ;;
        files) compgen -f -- "$cur" ;;
        esac
    )
    [[ -z $paths ]] || compopt -o filenames 2>/dev/null
}}
complete -F _{program} {program}
"""


def script(root: Command) -> str:
    """The script for all commands below a root."""
    commands = [*root.tree()]
    below = [_pattern(command) for command in commands if command is not root]
    return SCRIPT.format(
        program=root.path[0],
        commands=" | ".join(below),
        values="\n".join(line for command in commands for line in _values(command)),
        arguments="\n".join(map(_argument, commands)),
    )


def _values(command: Command) -> list[str]:
    """A line for the values of each option that takes one."""
    return [
        f"    {' | '.join(_pattern(command, name) for name in option.names)}) {_set(option.value)} ;;"
        for option in command.options
        if option.value is not None
    ]


def _pattern(command: Command, word: str = "") -> str:
    """A command as the script knows it, with a word behind it."""
    return shlex.quote(" ".join((*command.path, word) if word else command.path))


def _argument(command: Command) -> str:
    """A line for the options and the arguments of a command."""
    options = " ".join(name for option in command.options for name in option.names)
    argument = tuple(sub.path[-1] for sub in command.commands) or command.argument or ()
    return f"        {_pattern(command)}) options={shlex.quote(options)} {_set(argument)} ;;"


def _set(value: Value) -> str:
    return f"paths={value.name.lower()}" if isinstance(value, Paths) else f"words={shlex.quote(' '.join(value))}"
