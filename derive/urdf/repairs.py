"""Changes that the user of a robot asks for: joints that are locked, and tensors of inertia that a body can have."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from scipy.optimize import nnls

from derive.errors import Problem, SpecError, quoted
from derive.spec.parsing.faults import did_you_mean
from derive.urdf.robot import JointKind, Matrix, Robot

SPREAD = 1e-3
"""The least distance, m, root mean square, of the mass of a repaired body from each plane through its centre."""
FROM_SECOND_MOMENTS = np.ones((3, 3)) - np.eye(3)
"""The principal moments of inertia are sums of two second moments of the mass, which are not negative, in each."""


def with_locked_joints(robot: Robot, names: Iterable[str], source: str | None = None) -> Robot:
    """The robot with joints that do not leave their zero positions. Raises SpecError where there is no such joint."""
    names = dict.fromkeys(names)
    problems = [
        Problem("", f"there is no joint {quoted(name)} to lock{did_you_mean(name, robot.joints)}")
        for name in names
        if name not in robot.joints
    ]
    if problems:
        raise SpecError(tuple(problems), source)
    fixed = {name: replace(robot.joints[name], kind=JointKind.FIXED, mimic=None) for name in names}
    return replace(robot, joints={**robot.joints, **fixed})


def nearest_tensor(tensor: Matrix, mass: float) -> Matrix:
    """The tensor of inertia of a body of this mass that differs least from a symmetric one, kg m^2.

    Least is the sum of the squares of the differences of all entries. The principal axes remain; the second moments of
    the mass along them are at least those of a mass at the distance SPREAD, so that no rotation is without inertia.
    """
    moments, axes = np.linalg.eigh(tensor)
    least = np.full(3, mass * SPREAD**2)
    more, _ = nnls(FROM_SECOND_MOMENTS, moments - FROM_SECOND_MOMENTS @ least)
    return np.asarray(axes @ np.diag(FROM_SECOND_MOMENTS @ (least + more)) @ axes.T)
