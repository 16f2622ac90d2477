"""Completion for fish: a line for each option, command and argument, under the condition that its command is given."""

from __future__ import annotations

from collections.abc import Iterator

from derive.cli.shells.command_tree import Command, Option, Paths, Value

HEAD = """\
# Completes the commands of {program} in fish: source this file, or save it as
# ~/.config/fish/completions/{program}.fish. Written by `{program} completion fish`.
function __{program}_at --description 'Whether the words before the cursor give this command'
    set -l command {program}
    for word in (commandline -opc)[2..-1]
        contains -- "$command $word" {commands}
        and set command "$command $word"
    end
    test "$command" = "$argv[1]"
end

function __{program}_specifications --description 'Specifications and folders'
    __fish_complete_path (commandline -ct) | string match --regex '^[^\\t]*(?:/|\\.toml)(?:\\t.*)?$'
end

complete -c {program} -f
"""
ACTIONS = {
    Paths.SPECIFICATIONS: "(__{program}_specifications)",
    Paths.FOLDERS: "(__fish_complete_directories)",
    Paths.FILES: "(__fish_complete_path (commandline -ct))",
}


def script(root: Command) -> str:
    """The script for all commands below a root."""
    commands = [_quoted(" ".join(command.path)) for command in root.tree() if command is not root]
    head = HEAD.format(program=root.path[0], commands=" ".join(commands))
    return head + "\n".join(line for command in root.tree() for line in _lines(command)) + "\n"


def _lines(command: Command) -> Iterator[str]:
    program, path = command.path[0], " ".join(command.path)
    condition = _quoted(f'__{program}_at "{path}"')
    where = f"complete -c {program} -n {condition}"
    for sub in command.commands:
        yield f"{where} -a {_quoted(sub.path[-1])} -d {_quoted(sub.doc)}"
    if command.argument:
        yield f"{where} -a {_quoted(_candidates(command.argument, program))}"
    for option in command.options:
        yield f"{where} {_names(option)} -d {_quoted(option.doc)}{_value(option, program)}"


def _names(option: Option) -> str:
    return " ".join(f"-l {name[2:]}" if name.startswith("--") else f"-s {name[1:]}" for name in option.names)


def _value(option: Option, program: str) -> str:
    if option.value is None:
        return ""
    return f" -x -a {_quoted(_candidates(option.value, program))}" if option.value != () else " -x"


def _candidates(value: Value, program: str) -> str:
    return ACTIONS[value].format(program=program) if isinstance(value, Paths) else " ".join(value)


def _quoted(text: str) -> str:
    return "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'"
