"""The arguments of the command `tisserand` and their help texts. Only the standard library is imported here."""

from __future__ import annotations

import argparse
import difflib
import math
from pathlib import Path
from typing import Any

from derive.cli.arguments.first_steps import add_completion, add_new, add_run
from derive.cli.arguments.simulation import add_simulation
from derive.cli.arguments.study import add_study
from derive.cli.arguments.sweep import add_sweep
from derive.cli.arguments.types import (
    SPEC,
    add_command,
    add_folder,
    add_no_cache,
    add_set,
    count,
    error_fraction,
    export_kind,
    function_names,
    names,
    number,
    page_file,
    spec_file,
)
from derive.function_names import ON_REQUEST
from derive.study.study_options import ERROR
from derive.version import VERSION

DESCRIPTION = """\
Tisserand compiles flexible multibody dynamics in the floating frame of reference: it derives the equations of motion
of flexible bodies and of mechanisms, in the plane and in space, and generates C and Python code with explicit sparsity.
"""
EPILOG = """\
examples:
  tisserand new arm --kind mechanism
  tisserand run arm.toml --open
  tisserand build scenes/free_beam_mean.toml
  tisserand build scenes/block.toml scenes/body_symbolic.toml
  tisserand compare scenes/free_beam_mean.toml scenes/free_beam_point.toml
  tisserand simulate scenes/crank_slider_3.toml
  tisserand sweep scenes/four_bar.toml --set EI=50:150:11 --output peak:lambda_motor
  tisserand modes scenes/four_bar.toml
  tisserand study accuracy scenes/crank_slider_3.toml
  tisserand study stability examples/pinned_column.toml --parameter P=0:30:31
  tisserand choose scenes/crank_slider_3.toml --error 0.01
  tisserand study frames scenes/crank_slider_3.toml
  tisserand report scenes/free_beam_mean.toml --pdf
  tisserand export scenes/crank_slider_3.toml --to cmake
  tisserand check

`tisserand COMMAND --help` lists the options of a command. Results go to standard output, errors to standard error.

exit codes:
  0  success
  1  `check` has found a file that differs from its specification
  2  an error in the arguments, the specification or the environment; the message says where and what to do
"""


class CommandParser(argparse.ArgumentParser):
    """An argument parser that suggests the command which an unknown one resembles."""

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        """Refuse a value that is not among the choices of an argument."""
        if action.choices is not None and value not in action.choices:
            choices = [str(choice) for choice in action.choices]
            close = difflib.get_close_matches(str(value).lower(), choices, n=1)
            hint = f"did you mean {close[0]!r}?" if close else f"choose from {', '.join(choices)}"
            raise argparse.ArgumentError(action, f"unknown: {value!r}; {hint}")


def parser() -> argparse.ArgumentParser:
    """Return the parser with all commands."""
    main = CommandParser(
        prog="tisserand",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    main.add_argument("--version", action="version", version=f"tisserand {VERSION}")
    commands = main.add_subparsers(dest="command", metavar="COMMAND", title="commands")
    add_new(commands)
    add_run(commands)
    _add_build(commands)
    _add_compare(commands)
    _add_simulate(commands)
    add_sweep(commands)
    _add_modes(commands)
    add_study(commands)
    _add_choose(commands)
    _add_report(commands)
    _add_export(commands)
    _add_import(commands)
    _add_check(commands)
    _add_sid(commands)
    _add_schema(commands)
    add_completion(commands)
    return main


def _add_build(commands: Any) -> None:
    build = add_command(commands, "build", "generate C, Python and a manifest from specifications")
    build.add_argument("specs", nargs="+", type=spec_file, metavar="SPEC", help=SPEC)
    add_folder(build, "generated")
    build.add_argument(
        "--sensitivities", action="store_true", help="with the derivatives of the equations by parameters and inputs"
    )
    build.add_argument(
        "--functions",
        type=function_names,
        default=(),
        metavar="NAMES",
        help=f"with functions that few users need, separated by commas: {', '.join(ON_REQUEST)}; or all",
    )
    build.add_argument("--json", action="store_true", help="print the table of stages as JSON")


def _add_compare(commands: Any) -> None:
    compare = add_command(commands, "compare", "compile models and print their mass matrices and forces in one state")
    compare.add_argument("specs", nargs="+", type=spec_file, metavar="SPEC", help=SPEC)
    add_no_cache(compare)
    compare.add_argument("--json", action="store_true", help="print the numbers as JSON")
    compare.add_argument("--picture", type=Path, metavar="FILE", help="write a drawing of the sparsity patterns (SVG)")


def _add_simulate(commands: Any) -> None:
    simulate = add_command(
        commands, "simulate", "simulate a scene: trajectory (CSV), plots (SVG) and an animation (HTML)"
    )
    add_simulation(simulate)


def _add_modes(commands: Any) -> None:
    modes = add_command(commands, "modes", "natural frequencies, damping ratios and mode shapes about the equilibrium")
    modes.add_argument("spec", type=spec_file, metavar="SPEC", help=f"{SPEC} of a body or a scene")
    add_folder(modes, "results")
    add_set(modes)
    modes.add_argument(
        "--at", type=_instant, metavar="S", help="time in seconds of a state of the motion, in place of the equilibrium"
    )
    modes.add_argument(
        "--count",
        type=count,
        default=9,
        metavar="N",
        help="modes of non-zero frequency that are printed and drawn (default: 9)",
    )
    add_no_cache(modes)
    modes.add_argument("--json", action="store_true", help="print all modes as JSON")


def _add_report(commands: Any) -> None:
    report = add_command(
        commands, "report", "write a page with every equation of a model, its terms, zeros and code (HTML)"
    )
    subject = report.add_mutually_exclusive_group(required=True)
    subject.add_argument("spec", nargs="?", type=spec_file, metavar="SPEC", help=f"{SPEC} of a body or a scene")
    subject.add_argument("--paper", action="store_true", help="write the audit of the paper instead")
    report.add_argument(
        "--out", type=page_file, metavar="FILE", help="the page (default: results/NAME/NAME.report.html)"
    )
    add_no_cache(report)
    report.add_argument("--pdf", action="store_true", help="write a PDF beside the page")
    report.add_argument("--tex", action="store_true", help="write LaTeX beside the page")
    report.add_argument("--markdown", action="store_true", help="write Markdown beside the page")
    report.add_argument("--json", action="store_true", help="print the names of the files as JSON")


def _add_choose(commands: Any) -> None:
    choose = add_command(
        commands, "choose", "select, explain and write the cheapest model of a scene that is accurate enough"
    )
    choose.add_argument(
        "spec", type=spec_file, metavar="SPEC", help=f"{SPEC} of a scene with a flexible body and a plot"
    )
    choose.add_argument(
        "--error", "--tolerance", type=error_fraction, default=ERROR, metavar="X",
        help=f"largest error (rms) that is allowed, relative to the peak of a curve (default: {ERROR})",
    )  # fmt: skip
    choose.add_argument(
        "--plot",
        action="append",
        metavar="NAME",
        help="a plot whose curves have to be accurate; may be repeated (default: the first one)",
    )
    choose.add_argument(
        "--out", type=Path, metavar="FILE", help="the specification to write (default: SPEC_chosen.toml)"
    )
    choose.add_argument("--json", action="store_true", help="print the search as JSON")
    add_no_cache(choose)


def _add_export(commands: Any) -> None:
    export = add_command(
        commands, "export", "write a model as another program takes it, with inputs and outputs as ports"
    )
    export.add_argument("spec", type=spec_file, metavar="SPEC", help=f"{SPEC} of a body or a scene")
    export.add_argument(
        "--to",
        type=export_kind,
        required=True,
        metavar="KIND",
        help="the interface: cmake (C and C++ by CMake and pkg-config), fortran (a module by iso_c_binding), "
        "rust (a crate), octave (a MEX function), fmu2 (FMI 2.0), fmu3 (FMI 3.0), "
        "fmu2-all (FMI 2.0, with binaries for all platforms), fmu3-all (likewise), "
        "casadi (CasADi, with exact derivatives), "
        "acados (an AcadosModel), jax (a Python module for JAX), sundials (CVODE, CVODES, ARKODE and IDA in C), "
        "exudyn (an object of Exudyn with user functions in C), exudyn-ffrf (integrals for its floating-frame body), "
        "petsc (TS of PETSc in C), urdf (the description of a robot)",
    )
    add_folder(export, "exported")
    add_set(export)
    add_no_cache(export)
    export.add_argument("--json", action="store_true", help="print ports, start values and files as JSON")


def _add_import(commands: Any) -> None:
    text = "write the specification of a robot (URDF), or of a part from a finite-element program"
    importing = add_command(commands, "import", text)
    importing.add_argument(
        "file",
        type=Path,
        metavar="FILE",
        help="robot (.urdf), or part with its matrices: "
        "CalculiX, Abaqus (.inp), Nastran (.bdf, .nas), ANSYS (.cdb), MBDyn (.fem)",
    )
    importing.add_argument(
        "--base",
        choices=("fixed", "free"),
        help="how the root link of a robot is held: fixed to the ground, or free (default: fixed)",
    )
    importing.add_argument(
        "--lock",
        type=names,
        default=(),
        metavar="JOINTS",
        help="joints of a robot that stay in their zero positions, separated by commas",
    )
    importing.add_argument(
        "--repair-inertia",
        action="store_true",
        help="replace tensors of inertia that no body has by the nearest possible ones",
    )
    importing.add_argument(
        "--keep-angles",
        action="store_true",
        help="take angles such as 1.57079632679 as they are written, and not for right angles",
    )
    importing.add_argument(
        "--interface", type=names, metavar="SETS", help="sets of nodes of a part to which joints attach: left,right"
    )
    importing.add_argument(
        "--modes",
        type=count,
        metavar="N",
        help="modes of a part (default: 6, besides the static modes of the interface)",
    )
    importing.add_argument(
        "--error",
        type=error_fraction,
        metavar="E",
        help="in place of --modes: the relative error of frequencies and deflections within which modes are chosen",
    )
    importing.add_argument("--up-to", type=number, metavar="HZ", help="the frequency up to which the error is kept, Hz")
    importing.add_argument(
        "--component-modes",
        choices=("free", "craig_bampton", "attachment"),
        metavar="KIND",
        help="free, craig_bampton or attachment (default: craig_bampton with an interface, and free without)",
    )
    importing.add_argument(
        "--second-order",
        action="store_true",
        help="a part of order 2, whose geometric stiffness comes from the stresses of its elements",
    )
    importing.add_argument(
        "--units",
        metavar="UNITS",
        help="length, mass and time of the numbers of a part, such as mm,t,s (default: m,kg,s)",
    )
    importing.add_argument(
        "--scene",
        action="store_true",
        help="write a scene with the part as a body, held at the first set of its interface",
    )
    importing.add_argument(
        "--out", type=Path, metavar="FILE", help="specification to write (default: the name of the model, .toml)"
    )
    importing.add_argument("--json", action="store_true", help="print the notes as JSON")


def _add_check(commands: Any) -> None:
    check = add_command(commands, "check", "regenerate all models in memory and compare them with the generated files")
    check.add_argument(
        "scenes",
        nargs="?",
        type=spec_file,
        default=Path("scenes"),
        help="folder of specifications, or one specification (default: scenes)",
    )
    add_folder(check, "generated")


def _add_sid(commands: Any) -> None:
    sid = add_command(commands, "sid", "print a finite-element body as standard input data (SID)")
    sid.add_argument("spec", type=spec_file, metavar="SPEC", help=f"{SPEC} with a body given by nodes")
    sid.add_argument("--body", metavar="NAME", help="the body of a scene with several bodies given by nodes")


def _add_schema(commands: Any) -> None:
    schema = add_command(
        commands, "schema", "print the JSON schema of specifications, with which editors check TOML files"
    )
    schema.add_argument("--markdown", action="store_true", help="print docs/reference_toml.md instead")


def _instant(text: str) -> float:
    value = number(text)
    if not 0 <= value < math.inf:
        raise argparse.ArgumentTypeError(f"expected a time of at least 0 seconds, not {text!r}")
    return value
