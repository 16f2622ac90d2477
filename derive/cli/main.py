"""The command `tisserand`: dispatches to one module per command and prints errors in one place.

Only the module of the command is imported, so that `--help` answers at once.
"""

from __future__ import annotations

import argparse
import gc
import io
import os
import sys
from collections.abc import Sequence
from importlib import import_module

from derive.cache import no_cache
from derive.cli.arguments.command_line import parser
from derive.errors import TisserandError, printable
from derive.progress_line import show_progress, timed_stages

MODULES = {"import": "importing"}
"""The modules of commands whose names are words of Python."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command and return its exit code; without a command print the help.

    `arguments` are those of the command line if omitted. The exit code is 0 after success, 1 after a failed `check`, 2
    after an error, whose message goes to standard error, and 130 after an interruption by Ctrl-C.
    """
    # As on standard error, a console without Greek letters shows their numbers, and stops nothing.
    if isinstance(sys.stdout, io.TextIOWrapper) and sys.stdout.errors == "strict":
        sys.stdout.reconfigure(errors="backslashreplace")
    options = parser().parse_args(arguments)
    if options.command is None:
        parser().print_help()
        return 0
    # Dense matrices are small: threads would wait for each other, for a sixth of the time of a simulation, and the last
    # digits may depend on their number. NumPy reads this when it is loaded; what the user has set stays.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # Derivations return to more expressions than SymPy keeps by default, for a tenth of their time.
    os.environ.setdefault("SYMPY_CACHE_SIZE", "10000")
    # Models are millions of objects that live to the end: the garbage collector looks through them less often.
    gc.set_threshold(100_000)
    if options.command == "sweep":  # its workers share the processors, where threads of linear algebra only wait
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        with no_cache(getattr(options, "no_cache", False)), timed_stages(_task(options)):
            show_progress("loading ...")  # the first import of SymPy and CasADi takes seconds
            command = import_module(f"derive.cli.{MODULES.get(options.command, options.command)}")
            show_progress()
            code: int = command.run(options)
        sys.stdout.flush()
        return code
    except BrokenPipeError:  # the reader of the pipe, such as `head`, has closed it
        sys.stderr.close()
        return 0
    except KeyboardInterrupt:
        show_progress()
        print("interrupted", file=sys.stderr)
        return 130
    except (TisserandError, OSError) as error:
        show_progress()
        print("\n".join(map(printable, _message(error).split("\n"))), file=sys.stderr)
        return 2


def _task(options: argparse.Namespace) -> str:
    """The command and its specifications, which take about the same time again."""
    specifications = getattr(options, "specs", None) or [getattr(options, "spec", None)]
    return " ".join(map(str, [options.command, *specifications]))


def _message(error: TisserandError | OSError) -> str:
    """Return the text of an error; an error of the operating system names its file."""
    if isinstance(error, OSError) and error.filename is not None:
        return f"{error.filename}: {error.strerror}"
    return str(error)
