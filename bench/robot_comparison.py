"""The makers of the dynamics of a robot in one program: ours, Pinocchio, MuJoCo, C by hand; their values and times."""

from __future__ import annotations

import subprocess
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio_peer
from interleaved import TimedCall, interleaved
from machine import OWN_OPTION
from mujoco_peer import MujocoPeer
from numpy.typing import NDArray
from robot_coordinates import RobotCoordinates
from robot_files import chain_count, chain_tables, scene_of
from timed_program import Program

from derive.backends.c.source import CBackend
from derive.derivation import derive
from derive.ir.model import Model
from derive.model_lowering import lower

Array = NDArray[np.float64]

BATCH = 8
"""The states of a batch."""
PEERS_PER_VELOCITY = 1e-13
"""The rounding errors of others for each velocity: MuJoCo errs by 2e-12 in a chain of 100 bodies."""
FUNCTIONS = ("accel", "inverse_dynamics", "mass")


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


def without_markers(model: Model) -> Model:
    """A model without the functions of markers, which are more than half of the code of a chain of 30 bodies."""
    kernels = tuple(kernel for kernel in model.kernels if not kernel.name.startswith("marker_"))
    return replace(model, markers=(), marker_classes=(), kernels=kernels)


class Comparison:
    """The makers of one case, in one program: their calls, and their values in the coordinates of Pinocchio.

    tolerance: the largest difference, relative to the largest number of a state.
    """

    tolerance = 1e-12

    def __init__(self, case: str, folder: Path, flags: str, coordinates: str, states: int) -> None:
        import pinocchio

        self.pin, self.case, self.count = pinocchio, case, states
        self.path, self.scene = scene_of(case, folder, coordinates)
        self.robot: Any = pinocchio.buildModelFromUrdf(str(self.path))
        start = time.process_time()
        self.model = without_markers(lower(derive(self.scene), explicit=True, functions="inverse_dynamics"))
        self.derive_seconds = time.process_time() - start
        self.program = Program(folder, flags)
        elements = [
            [name for v in part for name in v.elements] for part in (self.model.coordinates, self.model.velocities)
        ]
        self.map = RobotCoordinates(self.pin, self.robot, self.scene, *elements)
        self.states = self.map.states(states)
        forces = self.states[0][2] * bool(self.model.inputs)
        self.states = [(q, v, forces) for q, v, _ in self.states]  # the states of a batch share their inputs
        self.truth = self._truth()
        self.notes: list[str] = []
        self.functions = [name for name in FUNCTIONS if name in {kernel.name for kernel in self.model.kernels}]
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
        motions = [self.map.motion(q, v, a) for (q, v, _), (a, _, _) in zip(self.states, self.truth, strict=True)]
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
        self.program.arrays |= {
            "pin_q": q,
            "pin_v": v,
            "pin_tau": tau,
            "pin_a": np.array([a for a, _, _ in self.truth]),
        }
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
        n = chain_count(self.case)
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
            wanted = truth[FUNCTIONS.index(function)]
            if function == "inverse_dynamics":
                scale = abs(truth[2] @ truth[0]).max()
            given = self.in_pinocchio(function, call.name, q, v, found)
            if function != "inverse_dynamics":
                scale = abs(wanted).max()
            error = abs(given.ravel() - wanted.ravel()).max() / scale
            peers = 0.0 if call.name in ("ours", "batch") else PEERS_PER_VELOCITY * len(v)
            if not error < max(self.tolerance, peers):
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
