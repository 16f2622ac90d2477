"""Accelerations of chains of very many bodies beside C by hand, whose values they are compared with.

Data of Pinocchio have the second derivatives of all forces by all coordinates: 8 GB for each of four tensors of a
thousand joints. Neither these nor dense mass matrices are made here. Angles are those of the C by hand.
"""

from __future__ import annotations

import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from interleaved import TimedCall
from robot_comparison import Array, Comparison, without_markers
from robot_coordinates import Motion
from robot_files import chain_count, scene_of
from timed_program import Program

from derive.derivation import derive
from derive.model_lowering import lower


class ChainAngles:
    """The map from the angles of a chain, from the ground on, to the coordinates of a scene."""

    def __init__(self, coordinates: list[str], count: int) -> None:
        self.order = [int(name.removeprefix("link").removesuffix("_phi")) for name in coordinates]
        assert sorted(self.order) == list(range(count)), "each body of a chain has one angle"

    def motion(self, q: Array, v: Array, a: Array) -> Motion:
        """The motion of the scene."""
        return Motion(q[self.order], v[self.order], a[self.order])


class LongChain(Comparison):
    """Ours and C by hand, in one program; rounding errors of both grow with the number of bodies."""

    tolerance = 1e-11

    def __init__(self, case: str, folder: Path, flags: str, coordinates: str, states: int) -> None:
        self.case, self.count = case, states
        n = chain_count(case)
        self.path, self.scene = scene_of(case, folder, coordinates)
        start = time.process_time()
        self.model = without_markers(lower(derive(self.scene), explicit=True))
        self.derive_seconds = time.process_time() - start
        self.program = Program(folder, flags)
        self.map = self.angles = ChainAngles([name for part in self.model.coordinates for name in part.elements], n)
        rng, none = np.random.default_rng(5), np.zeros(n)
        self.states = [(*rng.uniform(-1.5, 1.5, (2, n)), none) for _ in range(states)]
        self.truth = [(none, none, none)] * states
        self.robot = SimpleNamespace(nv=n)
        self.notes = [f"without Pinocchio, whose data of {n} joints have tensors of {8e-9 * n**3:.1f} GB each"]
        self.functions, self.calls, self.mujoco = ["accel"], {"accel": []}, None

    def add_hand(self, yardsticks: Path) -> None:
        """Add the C by hand, before all others, which are compared with it."""
        super().add_hand(yardsticks)
        self.calls["accel"].insert(0, self.calls["accel"].pop())

    def inputs(self, tau: Array) -> list[float]:
        """None: nothing acts in the joints of chains."""
        return []

    def compare(self, function: str, call: TimedCall, values: Array) -> None:
        """Compare the values of a call with those of the C by hand. Raises ArithmeticError if they differ."""
        if call.name == "hand":
            self.truth = [(vdot, *of) for vdot, (_, *of) in zip(values, self.truth, strict=True)]
        super().compare(function, call, values)

    def in_pinocchio(self, function: str, maker: str, q: Array, v: Array, values: Array) -> Array:
        """Accelerations from the ground on."""
        return values if maker == "hand" else values[np.argsort(self.angles.order)]
