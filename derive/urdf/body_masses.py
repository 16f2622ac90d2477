"""The masses and tensors of inertia of the bodies of a robot: which no scene can have, and which are repaired."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

import numpy as np

from derive.errors import Problem, printable, quoted
from derive.spec.parsing.values import WrongValueError
from derive.spec.tables.inertia_tensor import check_tensor
from derive.urdf.repairs import nearest_tensor
from derive.urdf.rigid_bodies import RobotBody, joints_on
from derive.urdf.robot import JointKind, Matrix, Robot


class BodyMasses:
    """Checks the bodies that move; `repaired` has new tensors by the names of bodies, `notes` a line on each."""

    def __init__(self, robot: Robot, bodies: Sequence[RobotBody], repair_inertia: bool) -> None:
        self.robot, self.bodies, self.repair_inertia = robot, bodies, repair_inertia
        self.repaired: dict[str, Matrix] = {}
        self.notes: list[str] = []
        self.singular: list[str] = []
        self.carrying = _carrying(robot, bodies)

    def tensor(self, body: RobotBody) -> Matrix:
        """The tensor of inertia of a body in the scene, about its centre and along its axes, kg m^2."""
        return self.repaired.get(body.name, body.tensor)

    def problems(self, moving: Sequence[RobotBody]) -> Iterator[Problem]:
        """The faults of the bodies that move."""
        for body in moving:
            if why := self._why_no_body(body):
                yield Problem(f"link {body.name}", why, body.parts[0].link.line)
        if len(self.singular) > 1:
            yield Problem("", f"to make these joints fixed: --lock {','.join(self.singular)}")

    def _why_no_body(self, body: RobotBody) -> str:
        """The reason why a body of a scene cannot be this one; empty if it can."""
        if not body.mass:
            return self._why_not_without_mass(body)
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = body.tensor.tolist()
        try:
            check_tensor(tuple(map(Fraction, (xx, yy, zz, xy, xz, yz))))
        except WrongValueError as error:
            if self.repair_inertia:
                self._repair(body)
                return ""
            parts = " and what is fixed to it" if len(body.parts) > 1 else ""
            return f"{error}; correct the <inertia> of this link{parts}, or import it with --repair-inertia"
        return ""

    def _why_not_without_mass(self, body: RobotBody) -> str:
        if body.tensor.any():
            return "it moves, has a tensor of inertia and no mass; give it a mass, or make its joint fixed (--lock)"
        why = "it moves, has no mass and carries none, so that"
        if not body.joint:
            return f"{why} the free base is singular; give it an <inertial>"
        if body.name in self.carrying:
            return ""
        self.singular.append(body.joint.name)
        name = quoted(body.joint.name)
        return f"{why} joint {name} becomes singular; give it an <inertial>, or make the joint fixed (--lock)"

    def _repair(self, body: RobotBody) -> None:
        """Replace the tensor of inertia of a body by the nearest one that a body of its mass has."""
        tensor = self.repaired[body.name] = nearest_tensor(body.tensor, body.mass)
        before, after = (", ".join(f"{x:.4g}" for x in np.linalg.eigvalsh(t)) for t in (body.tensor, tensor))
        self.notes.append(
            f"inertia of {printable(body.name)} repaired: principal moments of {after} kg m^2 instead of {before}"
        )


def _carrying(robot: Robot, bodies: Sequence[RobotBody]) -> set[str]:
    """The names of the bodies that carry others with mass; `bodies` are each behind the one that carries them."""
    behind = {body.joint.name: body for body in bodies if body.joint}
    result: set[str] = set()
    for body in reversed(bodies):
        moved = (behind[joint.name] for joint, _ in joints_on(robot, body) if joint.kind is not JointKind.FLOATING)
        if any(other.mass or other.name in result for other in moved):
            result.add(body.name)
    return result
