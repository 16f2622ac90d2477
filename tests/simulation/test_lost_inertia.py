"""The error by the kinetic energy that truncated terms leave out, against full terms of the same shapes."""

from __future__ import annotations

import numpy as np
import pytest

import derive
from derive.simulation.observables.beams import axis_points, beam_bodies, piece_names
from derive.simulation.trajectory import Trajectory
from derive.simulation.validity.implied_errors import ImpliedErrors
from derive.simulation.validity.monitors import Cause, Monitor
from derive.simulation.validity.truncated_energy import truncated_energy_error
from derive.simulation.validity.watched_beam import scene_watch
from explicit_motion import moved

DURATION = 2.0
BEAM = {"length": 1, "mass": 1, "bending_stiffness": 1, "ansatz": [f"xi^{i}" for i in range(5)], "order": 2}
LEFT = {"kind": "tangent", "at": -1}


def struck(
    terms: str, frame: object, spin: float, rate: float, pieces: int = 1, output: float = 0.005, **more: object
) -> Trajectory:
    """A free beam that spins and vibrates in P2, whose lowest frequency is 22.4 rad/s at rest."""
    start = {"deflection_rate": f"{rate}*(3/2*xi^2 - 1/2)", "spin": spin}
    beam = {**BEAM, "frame": frame, "terms": terms, "pieces": pieces, "start": start, **more}
    return moved(derive.scene("struck", bodies={"rod": beam}), duration=DURATION, output=output)


def deflections(run: Trajectory) -> np.ndarray:
    """(n, places): those of the beam in the plane, from its chord."""
    (beam,) = beam_bodies(run.motion.scene)
    x = np.hstack([axis_points(run.motion, beam, piece, np.linspace(-1, 1, 5)) for piece in piece_names(beam)])
    x = x - x[:, :1]
    along = x[:, -1] / np.linalg.norm(x[:, -1], axis=1)[:, None]
    return np.asarray(along[:, None, 0] * x[:, :, 1] - along[:, None, 1] * x[:, :, 0])


def error(own: np.ndarray, exact: np.ndarray) -> float:
    """The largest root mean square of the difference over the peak."""
    return float(np.sqrt(np.mean((own - exact) ** 2, axis=0)).max() / np.abs(exact).max())


def lost(run: Trajectory) -> Monitor:
    """The monitor of the mass matrix."""
    return max((m for m in run.validity if m.cause is Cause.MASS_MATRIX), key=lambda m: m.error)


def kinetic_error(run: Trajectory) -> float:
    """The error by the kinetic energy alone."""
    motion = run.motion
    scene = scene_watch(motion.scene, motion.native, motion.k, 0.0, motion.q[0], motion.v[0])
    (beam,), seen = scene.beams, scene.of_rows(motion.t, motion.q, motion.v)
    errors = ImpliedErrors(beam, seen)
    return errors.of_truncated_energy(truncated_energy_error(scene, beam, motion, errors.frequencies, 0.0))


@pytest.mark.parametrize(
    ("frame", "spin", "rate", "pieces", "expected"),
    [
        pytest.param(LEFT, 0, 0.15, 1, 0.040, id="at rest"),
        pytest.param(LEFT, 12, 0.1, 1, 0.108, id="spinning"),
        pytest.param(LEFT, 20, 0.1, 1, 0.271, id="spinning near the lowest frequency"),
        pytest.param("mean", 15, 0.8, 1, 0.121, id="mean frame, which loses next to no inertia"),
        pytest.param("chord", 0, 0.8, 1, 0.141, id="chord frame"),
        pytest.param(LEFT, 12, 0.4, 2, 0.016, id="two pieces"),
    ],
)
def test_the_error_by_truncated_terms_is_known(
    frame: object, spin: float, rate: float, pieces: int, expected: float
) -> None:
    """The kinetic energies of third and fourth order; a spin brings in those of third order."""
    run, full = (struck(terms, frame, spin, rate, pieces) for terms in ("truncated", "full"))
    measured = error(deflections(run), deflections(full))
    assert measured == pytest.approx(expected, rel=0.02)
    assert kinetic_error(run) == pytest.approx(measured, rel=0.15)


@pytest.mark.parametrize(("at", "mass", "expected"), [(0.5, 0.3, 0.25), (-0.5, 0.3, 0.13), (0, 0.5, 0.094)])
def test_the_axial_force_of_a_spinning_beam_jumps_at_an_attached_mass(at: float, mass: float, expected: float) -> None:
    """Frequencies without the jump imply two fifths of the error for a mass on either side of the middle."""
    masses = {"between": {"at": at, "mass": mass}}
    run, full = (struck(terms, LEFT, 12, 0.1, masses=masses) for terms in ("truncated", "full"))
    measured = error(deflections(run), deflections(full))
    assert measured == pytest.approx(expected, rel=0.02)
    assert lost(run).error == pytest.approx(measured, rel=0.08)


@pytest.mark.parametrize("spin", [6, 12, 20])
def test_a_run_implies_the_error_of_a_spinning_beam(spin: float) -> None:
    """Its loss of inertia alone would imply an eighth of it at 20 rad/s."""
    run, full = (struck(terms, LEFT, spin, 0.1) for terms in ("truncated", "full"))
    measured = error(deflections(run), deflections(full))
    assert measured / 1.5 < lost(run).error < 1.5 * measured


def test_a_velocity_that_the_beam_hardly_has_may_lose_much() -> None:
    """The value says when a run stops: a velocity loses 36 % of its kinetic energy, where the error is 4 %."""
    assert lost(struck("truncated", LEFT, 0, 0.15)).value == pytest.approx(0.36, abs=0.02)


def test_rows_that_are_far_apart_leave_the_loss_of_inertia() -> None:
    """Three rows in a period follow no vibration; what a vibration loses makes it late."""
    assert lost(struck("truncated", LEFT, 0, 0.15, output=0.1)).error == pytest.approx(0.036, rel=0.1)
