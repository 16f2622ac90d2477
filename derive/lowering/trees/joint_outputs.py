"""Outputs of trees in loops: the motions of joints and their rates, which are coordinates and velocities."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from derive.algebra import sp
from derive.ir.indices import variable
from derive.ir.patterns import Pattern, pattern
from derive.ir.statements import Statement
from derive.lowering.trees.link_loop import LINK, LinkLoop
from derive.lowering.trees.motion import TreeMotion
from derive.lowering.trees.row_loads import place_in
from derive.mechanics.multibody.space.joints import SpatialEliminatedJoint
from derive.mechanics.multibody.space.mechanism import SpatialMechanism
from derive.mechanics.terms import OutputEquation
from derive.spec.model.instances import identifier, joined
from derive.spec.model.ports import SceneOutput

MOST_UNROLLED = 12
"""The largest number of velocities for which functions without loops are straight-line code."""
LOOPED = frozenset({"inverse_dynamics", "gravity_compensation", "centre_of_mass", "centroidal_momentum"})
"""The functions on request that are in loops."""
KINDS = {"joint": ("relative motion", ""), "joint_speed": ("rate of the relative motion", "/s")}
"""The kinds of outputs that loops have, with their nouns and the ends of their units."""


@dataclass(frozen=True)
class JointOutput:
    """An output that is `sign` times an element of q, or of v if it is a rate."""

    equation: OutputEquation
    sign: int
    index: int
    is_rate: bool


def joint_outputs(mechanism: SpatialMechanism) -> tuple[JointOutput, ...] | None:
    """The outputs of a scene, if all of them are motions of joints of trees."""
    found = [_joint_output(mechanism, output) for output in mechanism.scene.outputs]
    known = [output for output in found if output]
    return tuple(known) if len(known) == len(found) else None


def other_outputs(mechanism: SpatialMechanism) -> Iterator[str]:
    """Yield the names of the outputs that are no motions of joints of trees."""
    yield from (output.name for output in mechanism.scene.outputs if not _joint_output(mechanism, output))


def _joint_output(mechanism: SpatialMechanism, output: SceneOutput) -> JointOutput | None:
    joint = mechanism.joints_by_name.get(str(output.values.get("joint")))
    if output.kind not in KINDS or not isinstance(joint, SpatialEliminatedJoint):
        return None
    freedom = joint.type.coupled(joint.joint)
    if freedom is None:
        return None
    row, coordinate = place_in(mechanism, joint, freedom)
    noun, per = KINDS[output.kind]
    shown = joined(output.name, "")
    doc = f"{noun} in joint {joint.joint.name}"
    equation = OutputEquation(identifier(shown), shown, f"{freedom.unit}{per}", doc, sp.S.Zero)
    return JointOutput(equation, joint.sign, row if per else coordinate, bool(per))


def values(motion: TreeMotion, outputs: tuple[JointOutput, ...]) -> Iterator[Statement]:
    """Yield the loops over the outputs, first those that are coordinates."""
    for array, numbers in _by_array(outputs):
        of = [outputs[n] for n in numbers]
        loop = LinkLoop(motion.arrays, f"outputs_{array}", numbers)
        value = loop.element(array, loop.place("joint", [o.index for o in of]).at(0))
        loop.store("out", loop.place("output", numbers).at(0), loop.column([Fraction(o.sign) for o in of]) * value)
        yield loop.made()


def jacobian_pattern(outputs: tuple[JointOutput, ...], sizes: tuple[int, ...]) -> Pattern:
    """The pattern of the derivatives with respect to arguments of these sizes, q and v first."""
    return pattern(len(outputs), sum(sizes), {(n, o.index + o.is_rate * sizes[0]) for n, o in enumerate(outputs)})


def derivatives(motion: TreeMotion, outputs: tuple[JointOutput, ...], shape: Pattern) -> list[Statement]:
    """The loop over the derivatives of the outputs, which are numbers."""
    if not outputs:
        return []
    loop = LinkLoop(motion.arrays, "derivatives", range(len(outputs)))
    signs = [Fraction(outputs[i].sign) for i, _ in shape.entries]
    loop.store("jac", variable(LINK), loop.column(signs))
    return [loop.made()]


def _by_array(outputs: tuple[JointOutput, ...]) -> Iterator[tuple[str, list[int]]]:
    for array, is_rate in (("q", False), ("v", True)):
        if numbers := [n for n, o in enumerate(outputs) if o.is_rate == is_rate]:
            yield array, numbers
