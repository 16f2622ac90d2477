"""The vibrations of monitored beams that an axial force stiffens, such as blades that spin."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh

import derive
from derive.runtime.native_call import Matrix, Vector
from derive.simulation.observables.beams import piece_names
from derive.simulation.validity.beam_vibrations import MissedForms, Vibration, vibrations_of
from derive.simulation.validity.bending_planes import bending_planes
from derive.simulation.validity.held_beam import HeldMode, held_modes
from derive.simulation.validity.monitors import Cause
from derive.simulation.validity.piece_frames import PieceFrames
from derive.simulation.validity.surroundings import Surroundings, surroundings
from derive.simulation.validity.turned_stiffness import TurnedStiffness
from derive.simulation.validity.watched_forms import WatchedForms
from explicit_motion import moved
from spinning_blade import ROD, blade, error_of

BENDING, TWIST, FORCE = 0, 1, 4
"""The numbers of the amplitudes of the two planes, and of the axial force in z."""
MASS = np.array([[1.0, 0.05], [0.05, 1.0]])


@dataclass
class OneShape:
    """A plane with one shape, which misses half as much strain energy as it has, or nothing."""

    number: int
    misses: bool
    stiffness: float

    @property
    def shapes(self) -> Any:
        return SimpleNamespace(stiffness=np.array([[self.stiffness]]))

    @property
    def amplitudes(self) -> list[list[int]]:
        return [[self.number]]

    @property
    def rates(self) -> list[int]:
        return [2 + self.number]

    @property
    def missed(self) -> MissedForms:
        form = np.zeros((1, FORCE + 1))
        form[0, self.number] = np.sqrt(self.stiffness / 4) if self.misses else 0.0
        return MissedForms(form, form, form, form[None])

    def stiffened(self, motions: Matrix) -> Iterator[tuple[int, Matrix]]:
        if self.misses:
            slopes = motions[:, [self.number]]
            yield FORCE, slopes @ slopes.T

    def stiffened_fields(self, fields: Matrix) -> Iterator[tuple[int, Matrix]]:
        yield FORCE, 0.1 * fields[[self.number]].T @ fields[[self.number]]

    def softened(self, motions: Matrix) -> tuple[Vector, Matrix]:
        return np.zeros(FORCE + 1), np.zeros((len(motions),) * 2)


def vibrations(force: float, twist: float) -> list[Vibration]:
    """The vibrations of a beam whose twist has a stiffness near that of its bending, coupled by the mass."""
    stiffness = np.array([1.0, twist])
    squares, modes = eigh(np.diag(stiffness), MASS)
    held = [HeldMode(float(np.sqrt(s)), x) for s, x in zip(squares, modes.T, strict=True)]
    planes = [OneShape(BENDING, True, 1.0), OneShape(TWIST, False, twist)]

    def response(motion: Vector) -> Vector:
        return np.concatenate([motion, np.zeros(3)])

    z = np.zeros(FORCE + 1)
    z[FORCE] = force
    return [*vibrations_of(held, planes, response, z)]  # type: ignore[arg-type]


def test_an_axial_force_takes_bending_away_from_a_twist_that_it_is_coupled_with_at_rest() -> None:
    """Frequencies a seventh apart are coupled by a mass; bending that is 40 times as stiff is late by itself."""
    at_rest = sorted(of.missed for of in vibrations(0.0, 1.3))
    spun = sorted(vibrations(40.0, 1.3), key=lambda of: of.missed)
    assert 0.005 < at_rest[0] < at_rest[1] < 0.495
    assert spun[0].missed < 0.002 and spun[1].missed == pytest.approx(0.5, abs=0.003)
    assert spun[1].axial[FORCE] == pytest.approx(1, abs=0.01) and spun[1].frequency == pytest.approx(1, abs=0.01)


def test_vibrations_with_almost_equal_frequencies_are_late_by_themselves() -> None:
    """A bending and a twist that are coupled but hardly lose their phases: one of them is late, the other is not."""
    almost = sorted(of.missed for of in vibrations(0.0, 1.0))
    assert almost[0] == pytest.approx(0, abs=0.01) and almost[1] == pytest.approx(0.5, abs=0.01)


@pytest.mark.long
def test_a_spinning_blade_in_three_shapes_is_late() -> None:
    """Its lowest mode is 45 times as stiff as at rest, less 36 that the spin takes away: all shares count for the rest.

    What the shapes miss has less of that stiffness than the mode, and most of its moment is that of the axial force.
    """
    few, many = (derive.simulate(blade(shapes), duration=0.5, output=0.002) for shapes in (3, 5))
    error = error_of(few, many)
    (moment,) = (m for m in few.validity if m.cause is Cause.BENDING_MOMENT)
    assert error > 0.2 and error / 1.6 < moment.error < 1.6 * error


def test_a_spin_takes_stiffness_away_from_attached_masses_too() -> None:
    """The square of the spin takes away M w(1)^2 by a mass M at the tip, whichever piece has it."""
    rod = ROD | {"ansatz": ["1", "xi", "xi^2"], "pieces": 2, "masses": {"tip": {"at": 1, "mass": 3}}}
    root = {"kind": "fixed", "between": ["ground.o", "rod.left"]}
    motion = moved(
        derive.scene("held", ground={"o": (0, 0)}, bodies={"rod": rod}, joints={"root": root}),
        duration=0.01,
        output=0.01,
    ).motion
    native, q = motion.native, motion.q[0]
    (shapes,) = bending_planes(motion.scene)
    frames, pieces = PieceFrames(native, motion.k, 0.0, q), piece_names(shapes.beam)
    amplitudes = [shapes.amplitudes_in(native, piece) for piece in pieces]
    motions = np.array([held.motion for held in held_modes((shapes,), native, motion.k, 0.0, q)])
    around = surroundings(motion.scene, shapes)

    def taken(of: Surroundings) -> Matrix:
        return TurnedStiffness(of, WatchedForms(native), shapes, frames, pieces, amplitudes).taken(motions)[1]

    rise, slope = frames.motion(shapes, pieces[1], motions).T
    tip = rise + slope * shapes.length / 2 + motions[:, amplitudes[1]] @ shapes.values(np.array([1.0]))[:, 0]
    added = taken(around) - taken(replace(around, masses=()))
    assert np.abs(tip).max() > 0.1 and added == pytest.approx(3 * np.outer(tip, tip))
