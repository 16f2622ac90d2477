"""Assembly: the configuration that meets the joints and drives, keeps what is given, and adapts the rest.

Distances are measured in poses of bodies, with lengths divided by the size of the scene, and not in the coordinates
that a scene keeps, on which the result therefore does not depend.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from derive.roles import Role
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import (
    Mask,
    coordinates_with,
    max_norm,
)
from derive.simulation.constraints.closest_state import (
    CONSISTENT,
    PERTURBATIONS,
    ClosestState,
    closest_state,
    perturbed,
    unmet_constraints,
)
from derive.simulation.errors import InconsistentInitialState
from derive.simulation.initial.assembler import Assembler, WithTargets
from derive.simulation.initial.contradictions import Conflict, Misfit, contradiction
from derive.simulation.initial.target_fit import NEWTON_CONVERGED, TargetFit, weight
from derive.simulation.initial.targets import Strength, Target

ROUNDING = 1e-3
"""rad, and part of the size of the scene: given values that contradict each other by no more are corrected."""
EXACT = 1e-10
"""rad, and part of the size: differences below this are not worth a message."""
FURTHER = (1.5, 3.0)
"""rad: further changes of rotations, from which the assembly looks for other ways of closing a mechanism."""
NEAR = 0.5
"""rad: a mechanism whose bodies have their guessed rotations up to this is closed in the way that is meant."""


@dataclass(frozen=True, eq=False)
class Assembly:
    """A configuration q (nq,) on the constraints. misfits: given values that are corrected; error: the largest |g| (m,
    rad); deformed: whether deformations had to change from those that are given or guessed."""

    q: Vector
    misfits: tuple[Misfit, ...]
    error: float
    deformed: bool


def assemble(
    assembler: Assembler,
    guess: Vector,
    targets: Sequence[Target],
    check_deformation: Callable[[Vector], None],
    conflict: Callable[[Vector, Sequence[Target]], Conflict],
    rough: bool = False,
) -> Assembly:
    """The configuration that keeps the given targets, and adapts to guesses and defaults what they leave free.

    guess: coordinates (nq,) from which the iteration begins. Bodies deform only where the joints cannot be met
    otherwise; check_deformation raises an error if they deform too far in a configuration (nq,). conflict: finds the
    joints, drives and given targets that contradict each other, near a configuration (nq,). rough: whether guesses and
    defaults are fitted to about three digits, for a configuration from which a search begins.

    Raises SpecError with the given values that contradict each other by more than rounding, InconsistentInitialState
    with the constraints that cannot be met.
    """
    native = assembler.native
    if _is_met(assembler, guess, targets):
        return Assembly(guess, (), max_norm(native.constraints(assembler.t, guess, assembler.k)), False)
    given = [target for target in targets if target.strength is Strength.GIVEN]
    amplitudes = coordinates_with(native, Role.AMPLITUDE)
    amplitudes[[target.amplitude for target in given if target.amplitude is not None]] = False
    straight = ~amplitudes
    missed: list[tuple[tuple[Misfit, ...], Vector]] = []
    open_states: list[ClosestState] = []
    for free in (straight, np.ones_like(straight)) if np.any(amplitudes) else (straight,):
        deformed = free is not straight
        closed: list[tuple[TargetFit, Vector, tuple[Misfit, ...]]] = []
        for start in _starts(native, guess):
            state, misfits = _closest(assembler, start, given, free)
            if not state.converged:
                open_states.append(state)
                continue
            if deformed:
                check_deformation(state.q)
            if max_norm(np.array([misfit.relative for misfit in misfits])) <= ROUNDING:
                kept = WithTargets(assembler, [replace(misfit.target, value=misfit.value) for misfit in misfits])
                fit = TargetFit(assembler, kept, _adapting(targets, deformed), free)
                q = fit.fitted(state.q)
                closed.append((fit, q, tuple(misfit for misfit in misfits if abs(misfit.relative) > EXACT)))
                if _is_near(assembler, targets, q):
                    break
            else:
                missed.append((misfits, state.q))
        if closed:
            fit, q, corrected = min(closed, key=lambda each: _distance(assembler, targets, each[1]))
            q = q if rough else fit.polished(q)
            return Assembly(q, corrected, max_norm(native.constraints(assembler.t, q, assembler.k)), deformed)
        if missed:
            misfits, q = min(missed, key=lambda of: max(abs(misfit.relative) for misfit in of[0]))
            raise contradiction(misfits, "positions", conflict(q, given))
    best = min(open_states, key=lambda state: state.error)
    unmet = unmet_constraints(native, best.g, CONSISTENT)
    raise InconsistentInitialState("positions", unmet, assembler.t, conflict(best.q, given).text)


def _is_met(assembler: Assembler, q: Vector, targets: Sequence[Target]) -> bool:
    """Whether a configuration (nq,) meets the constraints and has the values of all targets, up to rounding errors."""
    if max_norm(assembler.native.constraints(assembler.t, q, assembler.k)) > NEWTON_CONVERGED * max(1.0, max_norm(q)):
        return False
    return all(abs(misfit.relative) <= NEWTON_CONVERGED for misfit in assembler.misfits(targets, q))


def _starts(native: NativeScene, guess: Vector) -> Iterator[Vector]:
    """The guess, and guesses with rotations changed, from which bars that lie in one line can be assembled."""
    yield guess
    for angle in (*PERTURBATIONS, *FURTHER):
        yield perturbed(native, guess, angle, np.ones(native.nq, dtype=bool))


def _is_near(assembler: Assembler, targets: Sequence[Target], q: Vector) -> bool:
    """Whether all bodies have about the rotation that is given or guessed, so that no other assembly is nearer."""
    rotations = [target for target in targets if target.angular]
    return all(abs(misfit.relative) <= NEAR for misfit in assembler.misfits(rotations, q))


def _distance(assembler: Assembler, targets: Sequence[Target], q: Vector) -> tuple[float, float]:
    """The deviation from guesses and defaults; of mirror images, the one with rotations to the left comes first."""
    misfits = assembler.misfits([target for target in targets if target.strength is not Strength.GIVEN], q)
    squares = sum(weight(misfit.target) ** 2 * misfit.relative**2 for misfit in misfits)
    return round(squares, 9), -round(sum(misfit.relative for misfit in misfits if misfit.target.angular), 6)


def _closest(
    assembler: Assembler, start: Vector, given: Sequence[Target], free: Mask
) -> tuple[ClosestState, tuple[Misfit, ...]]:
    """A configuration that misses the given targets least, on the constraints if there is one next to the start."""
    k, t, native = assembler.k, assembler.t, assembler.native
    state = closest_state(WithTargets(assembler, given), k, t, start, free)
    if state.converged:
        return state, tuple(Misfit(target, target.value, 0.0) for target in given)
    for begin in (state.q, start):
        state = closest_state(native, k, t, begin, free)
        if state.converged:
            fit = TargetFit(assembler, native, given, free)
            q = fit.polished(fit.fitted(state.q))
            return ClosestState(q, native.constraints(t, q, k)), assembler.misfits(given, q)
    return state, ()


def _adapting(targets: Sequence[Target], deformed: bool) -> list[Target]:
    """The guesses and defaults; of deformations only if they have to change."""
    soft = (target for target in targets if target.strength is not Strength.GIVEN)
    return [target for target in soft if deformed or target.amplitude is None]
