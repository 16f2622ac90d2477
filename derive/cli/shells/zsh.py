"""Completion for zsh: a function for each command, which describes its options and arguments to `_arguments`."""

from __future__ import annotations

from derive.cli.shells.command_tree import Command, Option, Paths, Value

HEAD = """\
#compdef {program}
# Completes the commands of {program} in zsh: save this file as _{program} in a folder of fpath, or source it after
# compinit. Written by `{program} completion zsh`.
"""
ENDING = """\
if [[ $funcstack[1] == _{program} ]]; then
    _{program} "$@"
else
    compdef _{program} {program}
fi
"""
ACTIONS = {
    Paths.SPECIFICATIONS: '_files -g "*.toml"',
    Paths.FOLDERS: "_path_files -/",
    Paths.FILES: "_files",
}


def script(root: Command) -> str:
    """The script for all commands below a root; it works as a file `_tisserand` of `fpath` and by `source`."""
    program = root.path[0]
    return "\n".join([HEAD.format(program=program), *map(_function, root.tree()), ENDING.format(program=program)])


def _function(command: Command) -> str:
    specs = [_option(name, option) for option in command.options for name in option.names]
    if command.commands:
        return _dispatch(command, specs)
    if command.argument is not None:
        specs.append(_quoted(f"{'*' if command.several else '1'}:argument:{_action(command.argument)}"))
    lines = " \\\n        ".join(specs)
    return f"{_name(command)}() {{\n    _arguments \\\n        {lines}\n}}\n"


def _dispatch(command: Command, specs: list[str]) -> str:
    """The function of a command that has commands: their names, or the function of the one that is on the line."""
    names = "\n            ".join(_quoted(f"{_escaped(sub.path[-1])}:{_escaped(sub.doc)}") for sub in command.commands)
    branches = "\n        ".join(f"{sub.path[-1]}) {_name(sub)} ;;" for sub in command.commands)
    lines = " \\\n        ".join([*specs, "'1: :->command'", "'*:: :->rest'"])
    return f"""\
{_name(command)}() {{
    local curcontext=$curcontext state line
    typeset -A opt_args
    _arguments -C \\
        {lines}
    case $state in
    command)
        local -a commands=(
            {names}
        )
        _describe command commands
        ;;
    rest)
        case $line[1] in
        {branches}
        esac
        ;;
    esac
}}
"""


def _option(name: str, option: Option) -> str:
    others = "" if option.repeated else f"({' '.join(option.names)})"
    value = "" if option.value is None else f":{_escaped(option.metavar)}:{_action(option.value)}"
    equals = "=" if value and name.startswith("--") else ""  # the value may follow in the same word
    return _quoted(f"{'*' if option.repeated else ''}{others}{name}{equals}[{_escaped(option.doc)}]{value}")


def _action(value: Value) -> str:
    """The action of zsh that completes a value; a space stands for nothing."""
    if isinstance(value, Paths):
        return ACTIONS[value]
    return f"({' '.join(value)})" if value else " "


def _name(command: Command) -> str:
    return f"_{'_'.join(command.path)}"


def _escaped(text: str) -> str:
    return "".join(f"\\{c}" if c in "\\[]:" else c for c in text)


def _quoted(text: str) -> str:
    return "'" + text.replace("'", "'\\''") + "'"
