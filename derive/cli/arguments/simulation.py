"""The arguments of simulations, of the commands `simulate` and `run`. Only the standard library is imported here."""

from __future__ import annotations

import argparse

from derive.cli.arguments.types import (
    SPEC,
    add_folder,
    add_no_cache,
    add_set,
    count,
    integrator,
    names,
    seconds,
    spec_file,
    tolerance,
)


def add_simulation(command: argparse.ArgumentParser) -> None:
    """Add the specification and the options of a simulation."""
    command.add_argument("spec", type=spec_file, metavar="SPEC", help=f"{SPEC} with a [simulation] table")
    add_folder(command, "results")
    add_set(command)
    command.add_argument("--duration", type=seconds, metavar="S", help="duration, s, in place of the specified one")
    command.add_argument("--output", type=seconds, metavar="S", help="time between rows of the CSV file, s")
    command.add_argument(
        "--tolerance", type=tolerance, metavar="X", help="tolerance of the error of a step, relative and absolute"
    )
    command.add_argument(
        "--integrator",
        type=integrator,
        default="adaptive",
        metavar="NAME",
        help="in C: adaptive (default), rk4, generalised-alpha, c_ida; in Python: dop853 (or scipy), rk45, ida",
    )
    command.add_argument(
        "--step", type=seconds, metavar="S", help="step of integrators with fixed steps (rk4, generalised-alpha), s"
    )
    command.add_argument(
        "--resume", action="store_true", help="continue the run in the output folder from its last state"
    )
    command.add_argument(
        "--until", metavar="CONDITION", help='ends the simulation, such as "rod_phi > pi/2" or "slider_s = 0.2"'
    )
    command.add_argument(
        "--fields", type=names, metavar="BODIES", help="write the displacements and stresses of bodies for ParaView"
    )
    command.add_argument(
        "--instants", type=count, default=100, metavar="N", help="largest number of instants of --fields (default: 100)"
    )
    add_no_cache(command)
    command.add_argument("--json", action="store_true", help="print the summary as JSON")
