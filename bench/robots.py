"""Forward dynamics, inverse dynamics and mass matrices of robots and chains, beside Pinocchio, MuJoCo and C by hand.

python bench/robots.py [--only NAME ...] [--yardsticks FOLDER] [--coordinates NAME] [--kept FOLDER] [--json]

Robots are those of the package example-robot-data, in one URDF that all read; chains have 3 to 100 revolute bodies with
numbers of their own. Makers run alternately in one process, one call after the other for random states, with the same
flags; each time is the least of many slices, and values are compared first: accelerations, forces and mass matrices
agree to 1e-12 of the largest number in the coordinates of Pinocchio.

Pinocchio is compiled from the headers of its package with Eigen from `cmeel-eigen`, and takes its faster convention in
each row (kept: a folder for its object, whose compilation takes minutes). Without these headers it is timed from Python
in a process of its own, less the time of a call; the head of the table says which. MuJoCo is its C library, of whose
steps those alone are called that a result needs, without contacts, limits and passive forces. FOLDER has aba1.c, C by
hand for chains, with `eval(n, class, tables, q, v, vdot, work)`.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio_peer
from interleaved import TimedCall, interleaved
from machine import OWN_OPTION, described
from mujoco_peer import MujocoPeer
from numpy.typing import NDArray
from robot_coordinates import RobotCoordinates
from robot_files import ROBOTS, chain_tables, chain_text, has_robots, robot_text
from rows import Row, row
from timed_program import Program

from derive.backends.c.source import CBackend
from derive.derivation import derive, lower
from derive.ir.model import Model
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.toml.read import parse
from derive.urdf.read import read_robot
from derive.urdf.written_scene import written_scene

Array = NDArray[np.float64]

FLAGS = "-O3 -march=x86-64-v3"
STATES = 64
"""The random states, a multiple of those of a batch: so many that no predictor of branches learns them by heart."""
BATCH = 8
REPEATS = 41
TOLERANCE = 1e-12
"""The largest difference, relative to the largest number of a state."""
COUNTS = (3, 10, 30, 100)
LABELS = {"accel": "forward dynamics", "inverse_dynamics": "inverse dynamics", "mass": "mass matrix"}
GOALS = {"accel": 0.3, "inverse_dynamics": 0.3, "mass": None}
HAND_GOAL, BATCH_GOAL = 1.2, 0.5
CASES = (*ROBOTS, *(f"chain_{n}" for n in COUNTS))
QUICK = "chain_3"
"""The case of a quick run, which needs no package of robots."""


@dataclass(frozen=True)
class Figures:
    """The times of a function (ns) by maker, and what ours costs besides: operations, bytes of text, seconds."""

    case: str
    function: str
    ns: dict[str, float]
    joints: int
    operations: int
    text: int
    derive_seconds: float
    compile_seconds: float
    notes: tuple[str, ...]


def scene_of(case: str, folder: Path, coordinates: str) -> tuple[Path, SpatialScene]:
    """The description of a case, and the scene that is imported from it; chains have no inputs, as those by hand."""
    chain = case.startswith("chain_")
    path = folder / f"{case}.urdf"
    path.write_text(chain_text(_count(case)) if chain else robot_text(case, ROBOTS[case]))
    scene = parse(written_scene(read_robot(path), "fixed").text)
    assert isinstance(scene, SpatialScene)
    if chain:
        scene = replace(scene, inputs=(), torques=())
    changed: Any = {"coordinates": coordinates, "outputs": ()}
    return path, replace(scene, **changed)


def _count(case: str) -> int:
    return int(case.removeprefix("chain_"))


class Comparison:
    """The makers of one case, in one program: their calls, and their values in the coordinates of Pinocchio."""

    def __init__(self, case: str, folder: Path, flags: str, coordinates: str, states: int) -> None:
        import pinocchio

        self.pin, self.case, self.count = pinocchio, case, states
        self.path, self.scene = scene_of(case, folder, coordinates)
        self.robot: Any = pinocchio.buildModelFromUrdf(str(self.path))
        start = time.perf_counter()
        self.model = lower(derive(self.scene), explicit=True)
        self.derive_seconds = time.perf_counter() - start
        self.program = Program(folder, flags)
        elements = [[name for v in part for name in v.elements] for part in (self.model.coordinates, self.model.velocities)]
        self.map = RobotCoordinates(self.pin, self.robot, self.scene, *elements)
        self.states = self.map.states(states)
        forces = self.states[0][2] * bool(self.model.inputs)
        self.states = [(q, v, forces) for q, v, _ in self.states]  # the states of a batch share their inputs
        self.truth = self._truth()
        self.notes: list[str] = []
        self.functions = [name for name in LABELS if name in {kernel.name for kernel in self.model.kernels}]
        self.calls: dict[str, list[TimedCall]] = {name: [] for name in self.functions}
        self.mujoco: MujocoPeer | None = None

    def _truth(self) -> list[tuple[Array, Array, Array]]:
        """Accelerations, forces and mass matrices of Pinocchio from Python."""
        data, result = self.robot.createData(), []
        for q, v, tau in self.states:
            a = self.pin.aba(self.robot, data, q, v, tau).copy()
            mass = np.triu(self.pin.crba(self.robot, data, q))
            result.append((a, tau, mass + np.triu(mass, 1).T))
        return result

    def add_ours(self) -> None:
        """Add the generated code, single calls and a batch."""
        model, program = self.model, self.program
        files = CBackend().files(model, "a benchmark")
        for file in files:
            (program.folder / Path(file.path).name).write_text(file.text)
        done = program.compile(program.folder / f"{model.name}.c", f"{OWN_OPTION} -ffunction-sections")
        assert done
        self.compile_seconds = done.seconds
        program.declare.append(f'#include "{(program.folder / model.name).resolve()}.h"')
        program.once.append(f"if ({model.name}_setup(p, k)) return 5;")
        motions = [
            self.map.motion(q, v, a) for (q, v, _), (a, _, _) in zip(self.states, self.truth, strict=True)
        ]
        q, v, vdot = (np.array(x) for x in zip(*motions, strict=True))
        u = np.array([self.inputs(tau) for _, _, tau in self.states]).reshape(len(q), -1)
        program.arrays |= {"q": q, "v": v, "vdot": vdot, "p": np.append(np.array(model.defaults), 0.0)}
        program.arrays |= {"Q": _blocks(q), "V": _blocks(v)}
        if model.inputs:
            program.arrays["u"] = u
            program.scratch["no_u"] = u.shape[1]
        program.scratch["k"] = sum(constant.size for constant in model.constants) + 1
        sizes = {"q": q.shape[1], "v": v.shape[1], "vdot": v.shape[1], "u": u.shape[1]}
        places = {name: f"{name} + s * {size}" for name, size in sizes.items()}
        many = {"q": f"Q + s * {sizes['q']}", "v": f"V + s * {sizes['v']}"}
        batches = {kernel for kernel in ("accel",) if f"int {model.name}_{kernel}_batch(" in files[0].text}
        for function in self.functions:
            kernel = model.kernel(function)
            size = kernel.outputs[0].size
            given = {"t": "0.0", "k": "k", **places}
            if function == "inverse_dynamics":  # forces in place of the inputs
                given["u"] = "no_u"
            names = _arguments(function, bool(model.inputs))
            text = ", ".join(given[name] for name in names)
            self.calls[function].append(TimedCall("ours", f"{model.name}_{function}({text}, out);", size))
            if function in batches:
                text = ", ".join({**given, **many}[name] for name in names)
                call = f"{model.name}_{function}_batch({BATCH}, {text}, out);"
                self.calls[function].append(TimedCall("batch", call, size * BATCH, BATCH))

    def inputs(self, tau: Array) -> list[float]:
        """The inputs of the scene: the forces of its joints."""
        named = {f"{kind}_{name}": joint for name, joint in zip(self.robot.names, self.robot.joints, strict=True)
                 for kind in ("torque", "force")}  # fmt: skip
        return [float(tau[named[variable.name].idx_v]) for variable in self.model.inputs]

    def add_pinocchio(self, peer: Path) -> None:
        """Add the C++ of Pinocchio in both conventions."""
        pinocchio_peer.add_model(self.program, self.robot, peer)
        q, v, tau = (np.array(x) for x in zip(*self.states, strict=True))
        self.program.arrays |= {"pin_q": q, "pin_v": v, "pin_tau": tau, "pin_a": np.array([a for a, _, _ in self.truth])}
        nq, nv = self.robot.nq, self.robot.nv
        at, speed = f"pin_q + s * {nq}", f"pin_v + s * {nv}"
        texts = {
            "accel": [(f"aba_{form}", f"{at}, {speed}, pin_tau + s * {nv}", nv) for form in ("local", "world")],
            "inverse_dynamics": [("rnea", f"{at}, {speed}, pin_a + s * {nv}", nv)],
            "mass": [(f"crba_{form}", at, nv * nv) for form in ("local", "world")],
        }
        for function in self.functions:
            for name, given, size in texts[function]:
                call = f"pinocchio_{name}({given}, timing ? 0 : out);"
                self.calls[function].append(TimedCall(f"Pinocchio {name}", call, size))

    def add_mujoco(self) -> None:
        """Add the C of MuJoCo, if it reads the description."""
        peer = MujocoPeer(self.path, self.robot)
        if peer.refused:
            self.notes.append(f"MuJoCo: {peer.refused}")
            return
        self.mujoco = peer
        peer.add_to(self.program)
        q = [peer.coordinates(q) for q, _, _ in self.states]
        bases = [peer.basis(q) for q, _, _ in self.states]
        v = [basis @ v for basis, (_, v, _) in zip(bases, self.states, strict=True)]
        a = [b @ a + peer.bias(q, v) for b, (q, v, _), (a, _, _) in zip(bases, self.states, self.truth, strict=True)]
        tau = [np.linalg.solve(basis.T, tau) for basis, (_, _, tau) in zip(bases, self.states, strict=True)]
        arrays = {"mj_q": q, "mj_v": v, "mj_a": a, "mj_tau": tau}
        self.program.arrays |= {name: np.array(values) for name, values in arrays.items()}
        nq, nv = peer.model.nq, peer.model.nv
        at, speed = f"mj_q + s * {nq}", f"mj_v + s * {nv}"
        texts = {
            "accel": ("forward", f"{at}, {speed}, mj_tau + s * {nv}", nv),
            "inverse_dynamics": ("inverse", f"{at}, {speed}, mj_a + s * {nv}", nv),
            "mass": ("mass", at, nv * nv),
        }
        for function in self.functions:
            name, given, size = texts[function]
            self.calls[function].append(TimedCall("MuJoCo", f"mujoco_{name}({given}, timing ? 0 : out);", size))

    def add_hand(self, yardsticks: Path) -> None:
        """Add the accelerations of a chain by hand."""
        n = _count(self.case)
        self.program.compile(yardsticks / "aba1.c", "", "hand")
        self.program.arrays["tables"] = chain_tables(n)
        self.program.scratch["work"] = 400 * n + 64
        classes = ", ".join(map(str, range(n)))
        self.program.declare.append(
            "int eval(int, const int *, const void *, const double *, const double *, double *, void *);"
            f" static const int classes[] = {{{classes}}};"
        )
        call = f"eval({n}, classes, tables, pin_q + s * {n}, pin_v + s * {n}, out, work);"
        q, v, _ = (np.array(x) for x in zip(*self.states, strict=True))
        self.program.arrays |= {"pin_q": q, "pin_v": v}
        self.calls["accel"].append(TimedCall("hand", call, n))

    def times(self, repeats: int) -> Iterator[Figures]:
        """The figures of each function. Raises ArithmeticError if values differ."""
        program = self.program
        for function, calls in self.calls.items():
            found, values = interleaved(
                calls,
                declare="\n".join(program.declare),
                once=" ".join(program.once),
                arrays=program.arrays,
                scratch=program.scratch,
                objects=program.objects,
                libraries=program.libraries,
                folder=program.folder,
                states=self.count,
                repeats=repeats,
                statistic=np.min,
            )
            for call, result in zip(calls, values, strict=True):
                self.compare(function, call, result)
            ns = {call.name: t for call, t in zip(calls, found, strict=True)}
            model = self.model
            yield Figures(
                self.case,
                function,
                ns,
                self.robot.nv,
                model.kernel(function).operations,
                text_bytes(program.objects[0], f"{model.name}_{function}"),
                self.derive_seconds,
                self.compile_seconds,
                tuple(self.notes),
            )

    def compare(self, function: str, call: TimedCall, values: Array) -> None:
        """Compare the values of a call with those of Pinocchio from Python. Raises ArithmeticError if they differ."""
        if call.name == "batch":
            values = values.reshape(-1, call.size // BATCH, BATCH).transpose(0, 2, 1).reshape(self.count, -1)
        for (q, v, _), truth, found in zip(self.states, self.truth, values, strict=True):
            wanted = truth[list(LABELS).index(function)]
            if function == "inverse_dynamics":
                scale = abs(truth[2] @ truth[0]).max()
            given = self.in_pinocchio(function, call.name, q, v, found)
            if function != "inverse_dynamics":
                scale = abs(wanted).max()
            error = abs(given.ravel() - wanted.ravel()).max() / scale
            if not error < TOLERANCE:
                raise ArithmeticError(f"{self.case}: {function} of {call.name} is off by {error:.1e}")

    def in_pinocchio(self, function: str, maker: str, q: Array, v: Array, values: Array) -> Array:
        """Values of a maker in the coordinates of Pinocchio."""
        if maker in ("ours", "batch"):
            basis, bias = self.map.basis(q), self.map.motion(q, v, np.zeros_like(v)).vdot
        elif maker == "MuJoCo":
            assert self.mujoco
            basis, bias = self.mujoco.basis(q), self.mujoco.bias(q, v)
        else:
            return values
        if function == "accel":
            return np.asarray(np.linalg.lstsq(basis, values - bias, rcond=None)[0])
        if function == "inverse_dynamics":
            return np.asarray(basis.T @ values)
        if maker == "MuJoCo":
            M = values.reshape(len(bias), -1)
        else:
            M = np.zeros((len(bias), len(bias)))
            i, j = zip(*self.model.pattern("mass", "M").entries, strict=True)
            M[i, j] = M[j, i] = values
        return np.asarray(basis.T @ M @ basis)


def _blocks(values: Array) -> Array:
    """The states of batches, as structures of arrays, one batch after the other."""
    return values.reshape(-1, BATCH, values.shape[1]).transpose(0, 2, 1)


def _arguments(function: str, inputs: bool) -> list[str]:
    """The arguments of a function of a model."""
    if function == "mass":
        return ["q", "k"]
    given = ["t", "q", "v", *(["vdot"] if function == "inverse_dynamics" else [])]
    return [*given, *(["u"] if inputs else []), "k"]


def text_bytes(compiled: Path, function: str) -> int:
    """The bytes of code of a function with those that it calls: what a linker keeps of an object for it alone."""
    kept = compiled.with_suffix(".kept.o")
    subprocess.run(["ld", "-r", "--gc-sections", "-u", function, "-o", kept, compiled], check=True)
    lines = subprocess.run(["size", "-A", kept], check=True, capture_output=True, text=True).stdout.splitlines()
    return sum(int(line.split()[1]) for line in lines if line.startswith(".text"))


@dataclass(frozen=True)
class Options:
    """How a run measures: flags and repeats, folders, and the coordinates of our scenes."""

    flags: str = FLAGS
    repeats: int = REPEATS
    states: int = STATES
    coordinates: str = "relative"
    yardsticks: Path | None = None
    kept: Path | None = None
    compiled_peers: bool = True


def figures(case: str, options: Options) -> list[Figures]:
    """The figures of a case. Raises ArithmeticError if values differ."""
    with tempfile.TemporaryDirectory(prefix="tisserand-bench-") as name:
        folder = Path(name)
        comparison = Comparison(case, folder, options.flags, options.coordinates, options.states)
        comparison.add_ours()
        peer = pinocchio_peer.compiled(folder, options.flags, options.kept) if options.compiled_peers else None
        if peer:
            comparison.add_pinocchio(peer)
        if options.compiled_peers:
            comparison.add_mujoco()
        if case.startswith("chain_") and options.yardsticks:
            comparison.add_hand(options.yardsticks)
        result = list(comparison.times(options.repeats))
        if not peer:
            python = pinocchio_peer.python_times(
                comparison.pin, comparison.robot, comparison.states, options.repeats
            )
            result = [replace(f, ns={**f.ns, "Pinocchio from Python": python[f.function]}) for f in result]
        return result


def rows_of(found: Figures) -> list[Row]:
    """The rows of a function of a case, see `rows.py`: beside Pinocchio, MuJoCo and code by hand; of a batch."""
    peers = {name: t for name, t in found.ns.items() if name not in ("ours", "batch", "hand")}
    ours, hand = found.ns["ours"], found.ns.get("hand")
    note = (
        f"{found.operations} operations, {found.text / 1000:.1f} kB of text, derived in {found.derive_seconds:.1f} s, "
        f"compiled in {found.compile_seconds:.1f} s"
    )
    name = f"{LABELS[found.function]}, {found.case}, {found.joints} velocities"
    goal = HAND_GOAL if hand else GOALS[found.function]
    more = {"all_ns": found.ns, "operations": found.operations, "text": found.text}
    more |= {"derive_s": found.derive_seconds, "compile_s": found.compile_seconds, "notes": found.notes}
    result = [{**row(name, ours, peers=peers, hand=hand, goal=goal, note=note), **more}]
    if batch := found.ns.get("batch"):
        result.append(row(f"{name}, batch of {BATCH}, per state", batch, peers={"single calls": ours}, goal=BATCH_GOAL))
    return result


def rows(options: Options = Options(), only: Sequence[str] = (), quick: bool = False) -> list[Row]:
    """The rows of all cases, or `only` some; quick: the smallest case, once, beside Pinocchio from Python."""
    if quick:
        only = (QUICK,)
        options = replace(options, flags="-O1", repeats=1, states=BATCH, compiled_peers=False)
    wanted = only or (CASES if has_robots() else [case for case in CASES if case not in ROBOTS])
    return [row for case in wanted for found in figures(case, options) for row in rows_of(found)]


def _head(options: Options) -> list[str]:
    """The machine, the flags, and how the peers are measured."""
    compiled = options.compiled_peers and pinocchio_peer.include_folders()
    way = "C++ from its headers, in the same process" if compiled else "from Python, less the time of a call"
    try:
        mujoco = f"{version('mujoco')}, its C library, in the same process"
    except PackageNotFoundError:
        mujoco = "none: it is not installed"
    return [
        *described("pin", "numpy"),
        f"flags     {options.flags}; ours with {OWN_OPTION}",
        f"peers     Pinocchio {version('pin')}: {way}; MuJoCo {mujoco}",
        f"figures   ns of an evaluation, CPU time, least of {options.repeats}; {options.coordinates} coordinates",
    ]


def main(argv: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="+", choices=CASES, default=CASES, metavar="NAME", help=", ".join(CASES))
    parser.add_argument("--yardsticks", type=Path, help="the folder of C by hand")
    parser.add_argument("--kept", type=Path, help="a folder for the compiled Pinocchio, so that it is compiled once")
    parser.add_argument("--coordinates", choices=("relative", "absolute"), default="relative")
    parser.add_argument("--flags", default=FLAGS)
    parser.add_argument("--repeats", type=int, default=REPEATS)
    parser.add_argument("--python", action="store_true", help="Pinocchio from Python, and no MuJoCo")
    parser.add_argument("--json", action="store_true", help="print all figures as JSON")
    given = parser.parse_args(argv)
    options = Options(given.flags, given.repeats, STATES, given.coordinates, given.yardsticks, given.kept, not given.python)
    head = _head(options)
    if given.json:
        print(json.dumps({"head": head, "rows": rows(options, given.only)}, indent=2))
        return 0
    print("\n".join([*head, "", TABLE_HEAD]))
    for case in given.only:
        for found in figures(case, options):
            print(table_row(found), flush=True)
    return 0


TABLE_HEAD = (
    "| | operations | kB | derive, s | gcc, s | ours | batch | Pinocchio | MuJoCo | by hand "
    "| ours / Pinocchio | ours / by hand | batch / ours |\n"
    "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"
)


def table_row(found: Figures) -> str:
    """A line of the table."""
    pinocchio = min((t for name, t in found.ns.items() if name.startswith("Pinocchio")), default=None)
    ours, batch, hand = (found.ns.get(name) for name in ("ours", "batch", "hand"))
    assert ours
    cells = [str(found.operations), f"{found.text / 1000:.1f}", f"{found.derive_seconds:.1f}", f"{found.compile_seconds:.1f}"]
    cells += [f"{t:.4g}" if t else "" for t in (ours, batch, pinocchio, found.ns.get("MuJoCo"), hand)]
    pairs = ((ours, pinocchio), (ours, hand), (batch, ours))
    cells += [f"{a / b:.2f}" if a and b else "" for a, b in pairs]
    notes = "".join(f"<br>{note}" for note in found.notes)
    return f"| {LABELS[found.function]}, {found.case} ({found.joints}){notes} | {' | '.join(cells)} |"


if __name__ == "__main__":
    sys.exit(main())
