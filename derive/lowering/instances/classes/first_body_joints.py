"""Whether accelerations are solved for with rows of joints along the axes of the first bodies of these.

The compliance of bodies with many modes is then constant besides what their rotation adds, also where a body is the
first one of a joint, and takes no products with rotation tensors there.
"""

from __future__ import annotations

from collections.abc import Iterable

from derive.lowering.instances.classes.body_classes import BodyClass
from derive.lowering.instances.classes.gears import gears_of
from derive.lowering.instances.classes.known_motion import KnownMotion
from derive.lowering.instances.classes.mode_factors import FEWEST_MODES, constants_of_modes
from derive.mechanics.axes import SPACE
from derive.mechanics.equations import Equations
from derive.mechanics.multibody.space.first_body_rows import rows_along_first
from derive.mechanics.multibody.space.mechanism import AnyMechanism, SpatialMechanism


def has_rows_along_first(
    mechanism: AnyMechanism, classes: Iterable[tuple[BodyClass, Equations]], known: KnownMotion
) -> bool:
    """Whether all joints have such rows, all bodies are of many modes and have joints, and the ground is at rest."""
    if not isinstance(mechanism, SpatialMechanism) or not mechanism.joints or gears_of(mechanism) or known.moving:
        return False
    own = list(classes)
    met = {handle.joint for of, _ in own for member in of.members for handle in member.handles}
    return (
        all(rows_along_first(joint) for joint in mechanism.joints)
        and met == {*range(len(mechanism.joints))}
        and all(_suits(of, equations) for of, equations in own)
    )


def _suits(of: BodyClass, equations: Equations) -> bool:
    """Whether a body has joints, many modes whose factors are constants, and is coupled by its rotation alone."""
    if of.first.instance.coordinates.reason or len(equations.rows) - 2 * SPACE < FEWEST_MODES:
        return False  # it follows the ground, or has few modes
    constants = constants_of_modes(c.symbol for c in equations.coefficients)
    mass, turning = equations.mass, range(SPACE, 2 * SPACE)
    others = [i for i in range(mass.rows) if i not in turning]
    alike = all(mass[i, i] == mass[0, 0] and mass[i, j] == 0 for i in range(SPACE) for j in turning)
    apart = alike and all(mass[i, j] == 0 for i in others for j in others if i != j)
    sections = [of.first.instance.component.sections[handle.marker] for handle in of.first.handles]
    has_constants = {section.point.name for section in sections} <= {label.point for label in constants.values()}
    first_order = not any(section.second_twists or section.point.second for section in sections)
    return bool(sections) and apart and first_order and has_constants
