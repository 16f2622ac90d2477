"""The command `tisserand`: arguments in, exit code out. Nothing heavy is imported before a command runs."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path

from derive.errors import TisserandError
from derive.version import VERSION

DESCRIPTION = "Equations of motion of deformable bodies: from a specification to C and Python kernels."
EPILOG = """\
examples:
  tisserand build scenes/free_beam_mean.toml
  tisserand build scenes/block.toml scenes/body_symbolic.toml
  tisserand compare scenes/free_beam_mean.toml scenes/free_beam_point.toml
  tisserand simulate scenes/crank_slider_3.toml
  tisserand study frames scenes/crank_slider_3.toml
  tisserand report scenes/free_beam_mean.toml --pdf
  tisserand check

exit codes: 0 done; 1 a check failed; 2 the input or the machine does not allow it
"""


def parser() -> argparse.ArgumentParser:
    """The arguments of every command."""
    main = argparse.ArgumentParser(
        prog="tisserand",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    main.add_argument("--version", action="version", version=f"tisserand {VERSION}")
    commands = main.add_subparsers(dest="command", metavar="COMMAND")

    build = commands.add_parser("build", help="generate C, Python and a manifest from specifications")
    build.add_argument("specs", nargs="+", type=Path, metavar="SPEC", help="specification file (.toml)")
    build.add_argument("--out", type=Path, default=Path("generated"), metavar="FOLDER", help="default: generated")
    build.add_argument("--json", action="store_true", help="print the stage table as JSON")

    compare = commands.add_parser("compare", help="compile models and show mass matrix and forces side by side")
    compare.add_argument("specs", nargs="+", type=Path, metavar="SPEC", help="specification file (.toml)")
    compare.add_argument("--json", action="store_true", help="print the numbers as JSON")
    compare.add_argument("--picture", type=Path, metavar="FILE", help="draw the sparsity patterns as SVG")

    simulate = commands.add_parser("simulate", help="simulate a scene: numbers, pictures, and a page that plays it")
    simulate.add_argument("spec", type=Path, metavar="SPEC", help="specification file (.toml) with a [simulation]")
    simulate.add_argument("--out", type=Path, default=Path("results"), metavar="FOLDER", help="default: results")
    simulate.add_argument("--duration", type=_seconds, metavar="S", help="seconds, instead of those of the file")
    simulate.add_argument("--json", action="store_true", help="print the numbers as JSON")

    _studies(commands.add_parser("study", help="what the frame of the beams of a scene costs, and does to pivots"))

    report = commands.add_parser("report", help="a page with every equation of a model, its reasons and its code")
    _report(report)

    check = commands.add_parser("check", help="regenerate everything in memory and compare with the files")
    check.add_argument("scenes", nargs="?", type=Path, default=Path("scenes"), help="default: scenes")
    check.add_argument("--out", type=Path, default=Path("generated"), metavar="FOLDER", help="default: generated")

    sid = commands.add_parser("sid", help="print a body of nodes as standard input data (SID)")
    sid.add_argument("spec", type=Path, metavar="SPEC", help="specification file (.toml) with a [body] of nodes")

    commands.add_parser("schema", help="print the JSON schema of specifications, for editors")
    return main


def _report(report: argparse.ArgumentParser) -> None:
    what = report.add_mutually_exclusive_group(required=True)
    what.add_argument("spec", nargs="?", type=Path, metavar="SPEC", help="specification file (.toml) of a body")
    what.add_argument("--paper", action="store_true", help="the audit of the paper instead")
    report.add_argument("--out", type=Path, metavar="FILE", help="default: results/NAME/NAME.report.html")
    report.add_argument("--pdf", action="store_true", help="write a PDF beside it")
    report.add_argument("--tex", action="store_true", help="write LaTeX beside it")
    report.add_argument("--markdown", action="store_true", help="write Markdown beside it")
    report.add_argument("--json", action="store_true", help="print what was written as JSON")


def _studies(study: argparse.ArgumentParser) -> None:
    studies = study.add_subparsers(dest="study", metavar="STUDY", required=True)
    frames = studies.add_parser("frames", help="non-zeros, operations and CPU time in two frames")
    pivots = studies.add_parser("pivots", help="pivots that vanish, growth and errors in two frames")
    for one in (frames, pivots):
        one.add_argument("spec", type=Path, metavar="SPEC", help="specification file (.toml) of a scene with a beam")
        one.add_argument("--frames", type=_frames, default=("mean", "point"), metavar="A,B", help="default: mean,point")
        one.add_argument("--json", action="store_true", help="print the numbers as JSON")
    every = (1, 2, 3, 10, 30)
    frames.add_argument("--pieces", type=_pieces, default=every, metavar="N,...", help="beams; default: 1,2,3,10,30")
    frames.add_argument("--runs", type=_count, default=15, metavar="N", help="measurements by turns; default: 15")
    frames.add_argument("--chart", type=Path, metavar="FILE", help="default: results/NAME/frames.svg")
    pivots.add_argument("--pieces", type=_pieces, metavar="N,...", help="beams; default: as in SPEC")
    pivots.add_argument("--states", type=_count, default=361, metavar="N", help="along the motion; default: 361")
    pivots.add_argument("--numberings", type=_count, default=100, metavar="N", help="of the unknowns; default: 100")


def _count(text: str) -> int:
    if not text.strip().isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"a positive whole number is needed, not {text}")
    return int(text)


def _pieces(text: str) -> tuple[int, ...]:
    numbers = tuple(dict.fromkeys(_count(part) for part in text.split(",")))
    if max(numbers) > 64:
        raise argparse.ArgumentTypeError(f"a rod is cut into at most 64 beams, not {max(numbers)}")
    return numbers


def _frames(text: str) -> tuple[str, ...]:
    names = tuple(text.split(","))
    if len(set(names)) != 2 or len(names) != 2 or not set(names) <= {"mean", "point", "chord"}:
        raise argparse.ArgumentTypeError(f"two of mean, point and chord are needed, such as mean,point, not {text}")
    return names


def _seconds(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"a positive number of seconds is needed, not {text}")
    return value


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; returns its exit code. Without a command, help."""
    options = parser().parse_args(arguments)
    if options.command is None:
        parser().print_help()
        return 0
    try:
        code: int = import_module(f"derive.cli.{options.command}").run(options)
        sys.stdout.flush()
        return code
    except BrokenPipeError:  # the reader of a pipe has had enough
        sys.stderr.close()
        return 0
    except KeyboardInterrupt:
        return 130
    except (TisserandError, OSError) as error:
        print(_message(error), file=sys.stderr)
        return 2


def _message(error: TisserandError | OSError) -> str:
    if isinstance(error, OSError) and error.filename is not None:
        return f"{error.filename}: {error.strerror}"
    return str(error)
