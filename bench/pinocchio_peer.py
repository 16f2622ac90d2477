"""Pinocchio as a peer of generated C: its C++ in the timed program, or its Python with the time of a call subtracted.

The C++ is that of the headers in the package `pin`, with Eigen of the package `cmeel-eigen`, compiled with the flags of
the other code; its model is written as numbers. Compiling it takes minutes, so that a folder may keep the object.
"""

from __future__ import annotations

import shlex
import shutil
import time
from collections.abc import Callable, Sequence
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import Any

import numpy as np
from limited import limited
from numpy.typing import NDArray
from timed_program import Program

Array = NDArray[np.float64]

SOURCE = Path(__file__).with_suffix(".cpp")
DEFINED = ("FUSION_INVOKE_MAX_ARITY=12", "MPL_CFG_NO_PREPROCESSED_HEADERS", "MPL_LIMIT_LIST_SIZE=30")
OPTIONS = (
    "-std=c++17",
    "-DNDEBUG",
    "-w",
    *(f"-DBOOST_{name}" for name in (*DEFINED, "MPL_LIMIT_VECTOR_SIZE=30")),
)
"""As its users compile it: the limits of Boost are those of its own build."""
KINDS = ("FreeFlyer", "RX", "RY", "RZ", "RevoluteUnaligned", "PX", "PY", "PZ", "PrismaticUnaligned")
STATE = "const double *, const double *, const double *, double *"
DECLARED = f"""\
int pinocchio_load(const char *);
void pinocchio_aba_local({STATE}), pinocchio_aba_world({STATE}), pinocchio_rnea({STATE});
void pinocchio_crba_local(const double *, double *), pinocchio_crba_world(const double *, double *);"""


def include_folders() -> list[Path]:
    """The folders of the headers of Pinocchio, Boost and Eigen; empty if they are not installed."""
    try:
        found = [
            Path(str(distribution("libpinocchio").locate_file("cmeel.prefix/include"))),
            Path(str(distribution("cmeel-eigen").locate_file("cmeel.prefix/include/eigen3"))),
        ]
    except PackageNotFoundError:
        return []
    return found if all(folder.is_dir() for folder in found) else []


def compiled(folder: Path, flags: str, kept: Path | None = None) -> Path | None:
    """The object file of the C++; None without a compiler of C++ or the headers. kept: a folder of earlier objects."""
    headers = include_folders()
    if not headers or not shutil.which("g++"):
        return None
    target = (kept or folder) / f"pinocchio_{'_'.join(flags.split())}.o"
    if not target.exists():
        limited(
            ["g++", *shlex.split(flags), *OPTIONS, *(f"-I{x}" for x in headers), "-c", str(SOURCE), "-o", str(target)]
        )
    return target


def add_model(program: Program, robot: Any, compiled_peer: Path) -> None:
    """Add the functions of the C++, and its model, to a timed program."""
    numbers = np.concatenate([_joint(robot, i) for i in range(1, robot.njoints)])
    numbers.tofile(program.folder / "robot.bin")
    program.objects.append(compiled_peer)
    program.libraries.append("-lstdc++")
    program.declare.append(DECLARED)
    program.once.append('if (pinocchio_load("robot.bin")) return 6;')


def _joint(robot: Any, i: int) -> Array:
    """The numbers of a joint and its body, as the C++ reads them."""
    joint, place, body = robot.joints[i], robot.jointPlacements[i], robot.inertias[i]
    kind = joint.shortname().removeprefix("JointModel")
    axis = joint.extract().axis if kind.endswith("Unaligned") else np.zeros(3)
    numbers = [[robot.parents[i], KINDS.index(kind)], axis, place.translation, place.rotation.ravel()]
    numbers += [[body.mass], body.lever, body.inertia.ravel()]
    return np.concatenate(numbers)


def python_times(pin: Any, robot: Any, states: Sequence[tuple[Array, Array, Array]], repeats: int) -> dict[str, float]:
    """The least times (ns) of its functions from Python, less that of a call with a model without joints."""
    data, none, nothing = robot.createData(), pin.Model(), np.zeros(0)
    no_data = none.createData()
    calls: dict[str, Callable[[Array, Array, Array], Any]] = {
        "accel": lambda q, v, tau: pin.aba(robot, data, q, v, tau),
        "inverse_dynamics": lambda q, v, tau: pin.rnea(robot, data, q, v, tau),
        "mass": lambda q, v, tau: pin.crba(robot, data, q),
        "call": lambda q, v, tau: pin.aba(none, no_data, nothing, nothing, nothing),
    }
    best = dict.fromkeys(calls, np.inf)
    for _ in range(repeats):
        for name, call in calls.items():
            start = time.process_time_ns()
            for _ in range(10):
                for state in states:
                    call(*state)
            best[name] = min(best[name], (time.process_time_ns() - start) / (10 * len(states)))
    call = best.pop("call")
    return {name: ns - call for name, ns in best.items()}
