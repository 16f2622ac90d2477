"""`tisserand completion`: print the script with which a shell completes commands, options, kinds and files."""

from __future__ import annotations

import argparse

from derive.cli.arguments.command_line import parser
from derive.cli.shells import bash, fish, zsh
from derive.cli.shells.command_tree import command_tree

SCRIPTS = {"bash": bash.script, "zsh": zsh.script, "fish": fish.script}


def run(options: argparse.Namespace) -> int:
    """Print the script for a shell."""
    print(SCRIPTS[options.shell](command_tree(parser())), end="")
    return 0
