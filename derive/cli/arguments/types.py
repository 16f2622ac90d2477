"""Kinds of values of arguments, which several commands share. Only light modules are imported here."""

from __future__ import annotations

import argparse
import difflib
import math
from pathlib import Path
from typing import Any

from derive.function_names import ON_REQUEST
from derive.study.study_options import MAX_PIECES

SPEC = "specification file (.toml)"


def add_command(commands: Any, name: str, text: str) -> argparse.ArgumentParser:
    """Add a command; `text` is its line in the list of commands and the description in its own help."""
    command: argparse.ArgumentParser = commands.add_parser(name, help=text, description=f"{text[0].upper()}{text[1:]}.")
    return command


def add_no_cache(command: argparse.ArgumentParser) -> None:
    """Add the option `--no-cache`."""
    command.add_argument(
        "--no-cache", action="store_true", help="derive and compile anew, and keep nothing in the cache folder"
    )


def count(text: str) -> int:
    """A positive integer."""
    if not text.strip().isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"expected a positive integer, not {text!r}")
    return int(text)


def pieces(text: str) -> tuple[int, ...]:
    """Numbers of beams that a rod is divided into."""
    numbers = tuple(dict.fromkeys(count(part) for part in text.split(",")))
    if max(numbers) > MAX_PIECES:
        raise argparse.ArgumentTypeError(f"a rod is divided into at most {MAX_PIECES} beams, not {max(numbers)}")
    return numbers


def among(text: str, known: tuple[str, ...]) -> tuple[str, ...]:
    """Names among those that are known."""
    names = tuple(dict.fromkeys(text.split(",")))
    for name in names:
        if name not in known:
            close = difflib.get_close_matches(name, known, n=1)
            hint = f"did you mean {close[0]}?" if close else f"choose from {', '.join(known)}"
            raise argparse.ArgumentTypeError(f"unknown: {name!r}; {hint}")
    return names


def names(text: str) -> tuple[str, ...]:
    """Names between commas, each once."""
    result = tuple(dict.fromkeys(part.strip() for part in text.split(",")))
    if "" in result:
        raise argparse.ArgumentTypeError(f"expected names between commas, such as left,right, not {text!r}")
    return result


def function_names(text: str) -> tuple[str, ...]:
    """Names of functions that a model has on request, or `all`."""
    names = among(text, (*ON_REQUEST, "all"))
    return ON_REQUEST if "all" in names else names


def tolerance(text: str) -> float:
    """A number between 0 and 1."""
    value = number(text)
    if not 0 < value < 1:
        raise argparse.ArgumentTypeError(f"expected a small positive number, such as 1e-9, not {text!r}")
    return value


def error_fraction(text: str) -> float:
    """An error between 0 and 1."""
    value = number(text)
    if not 0 < value < 1:
        percent = number(text.strip().removesuffix("%"))
        as_fraction = f"; {percent:g} % is {percent / 100:g}" if 0 < percent < 100 else ""
        raise argparse.ArgumentTypeError(f"an error is a fraction such as 0.01, not {text!r}{as_fraction}")
    return value


def number(text: str) -> float:
    """A number; NaN if the text is not a number."""
    try:
        return float(text)
    except ValueError:
        return math.nan


def add_set(command: argparse.ArgumentParser) -> None:
    """Add the option `--set`."""
    command.add_argument(
        "--set",
        action="append",
        type=assignment,
        default=[],
        metavar="NAME=VALUE",
        help="another value of a parameter (EI=30) or of a key (bodies.rod.bending_stiffness=30); may be repeated",
    )


def assignment(text: str) -> tuple[str, str]:
    """A name and its value."""
    name, equals, value = (part.strip() for part in text.partition("="))
    if not (name and equals and value):
        raise argparse.ArgumentTypeError(f"expected NAME=VALUE, such as EI=30, not {text!r}")
    return name, value


def seconds(text: str) -> float:
    """A positive number of seconds."""
    value = number(text)
    if not 0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"expected a positive number of seconds, not {text!r}")
    return value


def add_folder(command: argparse.ArgumentParser, default: str) -> None:
    """Add the option `--out` with the folder of all files."""
    command.add_argument(
        "--out", type=folder, default=Path(default), metavar="FOLDER", help=f"output folder (default: {default})"
    )


def spec_file(text: str) -> Path:
    """The path of a specification. Like the types below it tells completions what a value is."""
    return Path(text)


def folder(text: str) -> Path:
    """The path of a folder."""
    return Path(text)


def page_file(text: str) -> Path:
    """The path of an HTML page."""
    if not text.endswith(".html"):
        raise argparse.ArgumentTypeError(
            f"expected an HTML file, such as report.html, not {text!r}; --pdf, --tex and --markdown write others too"
        )
    return Path(text)


def export_kind(text: str) -> str:
    """The name of an interface to other programs, which the command looks up in its registry."""
    return text


def integrator(text: str) -> str:
    """The name of an integrator, which the command looks up in its registry."""
    return text
