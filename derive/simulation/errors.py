"""The errors of a simulation. Each message states where the fault is, what it is, its size, and a remedy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from derive.enumerations import enumeration
from derive.errors import TisserandError
from derive.lowering.redundancy import Dependence, redundancy_text
from derive.percentages import percent

AT_DEAD_CENTRE = (
    "Start next to this state instead of in it, drive another joint, or change lengths so that the mechanism "
    "does not come there."
)


class SimulationError(TisserandError):
    """A simulation cannot start or continue; the text says why, and what to do.

    Examples:
        >>> import derive
        >>> ball = derive.scene("ball", gravity=(0, -10), bodies={"ball": {"mass": 1, "inertia": 1}})
        >>> try:
        ...     derive.simulate(ball, duration=1, output=0.5, integrator="adaptive", step=0.1)
        ... except derive.SimulationError as error:
        ...     print(error)
        adaptive chooses its own steps, so that a step of 0.1 s means nothing to it; leave it out ...
    """


class InconsistentInitialState(SimulationError):
    """No state near the initial guess meets the constraints.

    level: "positions" or "velocities". unmet: the names of multipliers, and the violations (m, rad; m/s, rad/s).
    together: joints and drives that cannot be met together, as text.
    """

    def __init__(self, level: str, unmet: Sequence[tuple[str, float]], t: float, together: str = "") -> None:
        self.unmet = tuple(unmet)
        width = max((len(name) for name, _ in unmet), default=0)
        unit = "m or rad" if level == "positions" else "m/s or rad/s"
        advice = {
            "positions": "Give bodies a start nearer to the closed mechanism, check that lengths can reach, and that "
            "every drive begins where the mechanism can be.",
            "velocities": "Check that every drive can be followed from this position, and that drives do not "
            "contradict each other.",
        }[level]
        lines = [f"no {level} near the initial guess at t = {t:g} s meet the constraints; violations in {unit}:"]
        lines += [f"  {name.ljust(width)}  {amount:.3g}" for name, amount in unmet]
        if together:
            lines.append(f"What cannot be met together, with what each misses if the others are met: {together}.")
        super().__init__("\n".join([*lines, advice]))


class ExcessiveDeformation(SimulationError):
    """The initial state meets the constraints only with deflections beyond the range of linear displacements.

    deflections: for each beam, by name, its largest deflection divided by the length of a piece.
    """

    def __init__(self, deflections: Mapping[str, float]) -> None:
        self.deflections = dict(deflections)
        beams = ", ".join(f"{name} by {value:.2g} of the length of a beam" for name, value in deflections.items())
        super().__init__(
            f"the initial state meets the joints only by bending {beams}, which linear displacements do not describe. "
            "Check that lengths can reach, or give bodies a start nearer to the closed mechanism."
        )


class MovingDrives(SimulationError):
    """A static equilibrium is requested while `drives` move, or begin to move."""

    def __init__(self, drives: Sequence[str]) -> None:
        self.drives = tuple(drives)
        super().__init__(
            'start = "equilibrium" needs drives at rest: without speed and acceleration at t = 0. This does not hold '
            f"for {enumeration(drives)}; use a motion such as 0.1*t^3, or leave `start` out."
        )


class NoEquilibrium(SimulationError):
    """No configuration near the first guess balances the loads. `coordinates` move on in Newton's method."""

    def __init__(self, t: float, coordinates: Sequence[str]) -> None:
        self.t, self.coordinates = t, tuple(coordinates)
        super().__init__(
            f"no static equilibrium is found at t = {t:g} s: Newton's method does not converge, and loads keep moving "
            f"{enumeration(coordinates)}. Support the bodies so that a stiffness or gravity balances every load, or "
            "give a start nearer to the equilibrium."
        )


class MassMatrixNotDefinite(SimulationError):
    """Deflections have taken a truncated model of second order to the limit of a positive definite mass matrix.

    t: the time, s. body: the body in space whose motion loses its inertia, of which a finite-element body has no full
    model; left: the part of that inertia that its modes leave in its frame while it is undeformed.
    """

    def __init__(self, t: float, body: str = "", left: float = 1.0) -> None:
        self.t, self.body, self.left = t, body, left
        cause = (
            f"{body} deforms too far for the truncated terms of order = 2. Undeformed, its modes leave {percent(left)} "
            'of the inertia of the motion that has lost all of it: in frame = "mean" they leave most, at a node or a '
            'tangent less with every mode. terms = "full" in the table of a beam truncates nothing; order = 1 leaves '
            "out the geometric stiffness of a finite-element body"
            if body
            else "a beam of order 2 with truncated terms bends too far for its frame. "
            'Write terms = "full" in its table, or frame = "mean"'
        )
        super().__init__(f"after t = {t:.9g} s the mass matrix is no longer positive definite: {cause}.")


class RedundantConstraints(SimulationError):
    """Other constraints imply some of the constraints, in the initial state and in neighbouring states."""

    def __init__(self, redundant: Sequence[Dependence]) -> None:
        self.redundant = tuple(redundant)
        super().__init__(redundancy_text(redundant))


class SingularConfiguration(SimulationError):
    """The mechanism is at a dead centre: the constraints depend on each other in this state only.

    t: the time (s). smallest: the smallest singular value of the scaled constraints. multipliers: the names of the
    multipliers that grow without bound.
    """

    def __init__(self, t: float, smallest: float, multipliers: Sequence[str], advice: str = AT_DEAD_CENTRE) -> None:
        self.t, self.smallest, self.multipliers = t, smallest, tuple(multipliers)
        grow = "grow" if len(multipliers) > 1 else "grows"
        super().__init__(
            f"the mechanism is at a dead centre at t = {t:.9g} s: the smallest singular value of its scaled "
            f"constraints is {smallest:.2g}, and {enumeration(multipliers)} {grow} without bound. {advice}"
        )


class TooNearDeadCentre(SingularConfiguration):
    """Steps of the tolerance become so short that they do not pass a dead centre, which longer ones might pass.

    tolerance: that of the integrator.
    """

    def __init__(self, of: SingularConfiguration, tolerance: float) -> None:
        self.tolerance = tolerance
        advice = (
            f"Near it the rounding errors of accelerations exceed the tolerance {tolerance:g} of a step. Longer steps "
            f"pass it: those of a larger tolerance, such as {10 * tolerance:g}, or of generalised-alpha."
        )
        super().__init__(of.t, of.smallest, of.multipliers, f"{advice} {AT_DEAD_CENTRE}")


class DriveCannotBeFollowed(SingularConfiguration):
    """A drive has moved the mechanism to a dead centre that it cannot pass.

    drives: the names of its multipliers. locked: whether no configuration closes the joints later,
    as far as the search could see.
    """

    def __init__(
        self, t: float, smallest: float, multipliers: Sequence[str], drives: Sequence[str], locked: bool = False
    ) -> None:
        self.drives, self.locked = tuple(drives), locked
        why = "The mechanism cannot turn through: behind this state its joints do not close. " if locked else ""
        advice = f"{why}What drives prescribe in {enumeration(drives)} cannot be followed. {AT_DEAD_CENTRE}"
        super().__init__(t, smallest, multipliers, advice)


class InextensibleBeam(SimulationError):
    """Joints hold beams where these are rigid, along and in space about their axes, so that reactions are not unique.

    t: in s. multipliers: the names of those that have no unique value. in_space: whether the beams are in space.
    """

    def __init__(self, t: float, multipliers: Sequence[str], in_space: bool = False) -> None:
        self.t, self.multipliers = t, tuple(multipliers)
        along, only, remedy = IN_SPACE if in_space else IN_THE_PLANE
        super().__init__(
            f"at t = {t:.9g} s the joints hold beams {along} more often than once: a beam bends, and {only}, so that "
            f'{enumeration(multipliers)} have no unique values. {remedy}; or write frame = "chord" for a rod of one '
            "beam that is held at its ends, whose distance its deflection does not change in this frame."
        )


IN_THE_PLANE = (
    "along their axes",
    "it stretches only with a table axial",
    "Give a beam this table, or let one end move along the axis: a translational joint acts as a roller, with a rigid "
    "body that a revolute joint connects to the end of the beam",
)
"""Where joints hold beams in the plane, with which table these give way, and what to do."""
IN_SPACE = (
    "along or about their axes",
    "it stretches or twists only with the tables axial and torsion",
    "Give a beam the table that it lacks, or let one end move: a cylindrical joint with z along the axis lets it slide "
    "and turn",
)
"""The same for beams in space."""


class MasslessMotion(SimulationError):
    """The constraints allow a motion that moves no mass; `coordinates` are the names of those that it involves."""

    def __init__(self, coordinates: Sequence[str]) -> None:
        self.coordinates = tuple(coordinates)
        super().__init__(
            f"a motion of {enumeration(coordinates)} moves no mass, and no constraint prevents it, so that its "
            "acceleration has no value. Give the body a mass and an inertia, or prescribe its motion by joints and "
            "drives."
        )


class DriftTooLarge(SimulationError):
    """A constraint is violated by more than the tolerance.

    level: "position" or "rate". name: that of the multiplier. amount, tolerance: in m, rad, m/s or rad/s.
    """

    def __init__(self, t: float, level: str, name: str, amount: float, tolerance: float) -> None:
        self.t, self.name, self.amount, self.tolerance = t, name, amount, tolerance
        super().__init__(
            f"at t = {t:.9g} s the {level} of constraint {name} is off by {amount:.2g}, more than the tolerance of "
            f"drift {tolerance:.2g}. Integrate with a smaller tolerance, with projection, or allow more drift."
        )


class IntegrationStopped(SimulationError):
    """The integrator cannot continue after t (s), and singular constraints are not the reason."""

    def __init__(self, t: float, reason: str) -> None:
        self.t = t
        super().__init__(
            f"the integration stops at t = {t:.9g} s: {reason}. The motion may grow without bound there (a beam that "
            "spins too fast for its stiffness, a force that is too large); a value may have no bound (the rate of a "
            "drive such as sqrt(t) at 0, a spring with a rest length or a damper whose ends meet); or the tolerance is "
            "out of reach."
        )
