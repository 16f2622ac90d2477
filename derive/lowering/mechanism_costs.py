"""Cost model of mechanisms: predicts whether straight-line code or loops over instances are faster.

The times are those of the accelerations, predicted from the numbers of bodies, coordinates, joints and constraints, for
which neither lowering need be made. The constants are fitted to 53 scenes of 1 to 12 bodies, measured with gcc 12 at
-O3 -march=x86-64-v3 on an Intel Xeon processor (family 6, model 207). The ratio of the two times has an error of 15 %
(rms), and the form that is chosen takes at most 1.20 of the time of the other one. bench/lowerings.py measures them
again. With n coordinates of a body, c constraints of its joints, a addends of its h and, if M is not diagonal, z
non-zeros of M, and with e products in the elimination of the joints, in ns:

    straight-line code   5.7 + 0.74 n c + 0.39 a + 0.13 z n of each body, and 0.21 e
    loops                3.3 + 0.57 n c + 0.49 a + 0.18 z n of each body, 4.4 for each joint, and 0.25 e; from two
                         bodies of a class on these are in the lanes of vectors: two or three take 0.6 of it, more 0.4;
                         along an open path, which is eliminated from both ends, 0.16 e

A joint whose constraints depend on both of its bodies at once takes 6 more in straight-line code, and 11 in loops, of
which many of a kind take the same parts as many bodies of a class do: a rough fit to 15 scenes with 1 to 8 such joints.
Bodies with fewer joints join the class of others where the loops then take less (`joined_classes.py`).
In space the same constants serve for rigid bodies with ball joints. Where joints remove rotations, straight-line code
eliminates these along the joints, and takes 95 ns for each body and 5 for each pair of a joint and one on its way to
the ground. Times in space are some 0.6 of those predicted on an AMD EPYC, family 26. Of 20 scenes there (chains, trees,
stars and closed loops of 2 to 8 bodies with balls, hinges, crosses and welds) the form that is chosen takes at most
1.09 of the time of the other one; of 19 scenes that were not fitted (`--held-out`) at most 1.17, and in 16 it is the
faster one. In an open row of finite-element bodies, a body with N modes and c constraints takes some 30 N + 40 c ns in
straight-line code, and in loops four of a class take 2.2 of that, one alone 1.4. The compiler's time is not predicted
for them. How much straight-line code leaves
the instruction cache depends on its joints: chains of five hinges take twice their time, eight welds 1.3 times; this is
left out.
A gear takes 250 ns in straight-line code; in loops it is a joint of several bodies with one constraint, and the whole
takes 0.8 of what follows: a rough fit to 8 chains of 3 to 12 hinges with a gear, or with one between each two hinges,
of which the form that is chosen takes at most 1.33 of the time of the other one.
The blocks of joints in loops have one size, that of the joint with the most constraints. Straight-line code of more
than 0.35 us leaves the instruction cache, and from 0.65 us on takes twice its time (18 scenes); so do loops over bodies
where one body of each class takes more than 0.3 us, and from 0.55 us on (8 scenes). The compiler takes some 0.02 T +
2.2e-8 T^3 seconds for the functions of straight-line code that takes T ns without that.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from derive.algebra import sp
from derive.ir.indices import LANES
from derive.lowering.instances.classes.body_classes import BodyClass, body_classes, handles_of
from derive.lowering.instances.classes.dimension import plain_joint
from derive.lowering.instances.classes.gears import constraining, gears_of
from derive.lowering.instances.classes.varying_joints import varies
from derive.lowering.instances.elimination.block_system import Blocks, blocks
from derive.lowering.instances.elimination.joined_classes import joined_classes
from derive.mechanics.multibody.space.mechanism import AnyMechanism, SpatialMechanism
from derive.spec.model.markers import GROUND
from derive.spec.model.spatial_bodies import FlexibleBody, SpatialRigidBody

LONG = 30.0
"""The predicted time (s) of the compiler for straight-line code from which on this is too long."""
MARGIN = 0.9
"""The ratio of the predicted times below which loops are chosen."""
TWO = 2
"""The number of bodies that stay in straight-line code, which explains each entry: loops save a seventh at most."""
IN_CACHE, TWICE = 350.0, 650.0
"""The times (ns) up to which straight-line code is in the instruction cache, and from which on it takes twice that."""
IN_SPACE = 0.6
"""The times of straight-line code in space, relative to those predicted: the compiler takes its time for the former."""
LOOPS_IN_CACHE, LOOPS_TWICE = 300.0, 550.0
"""The times (ns) of one body of each class up to which loops are in it, and from which on they take twice as long."""


@dataclass(frozen=True)
class MechanismCosts:
    """The predicted times of both lowerings of a mechanism.

    flat, instances: of an evaluation of the accelerations (ns); compiler: of the compiler for straight-line code (s), 0
    where it is not predicted.
    """

    flat: float
    instances: float
    compiler: float

    @property
    def lowering(self) -> str:
        """The lowering that is chosen if the specification leaves it open."""
        return "instances" if self._is_faster_looped or self.compiler > LONG else "flat"

    @property
    def _is_faster_looped(self) -> bool:
        return self.instances < MARGIN * self.flat

    def selected(self, requested: str) -> str:
        """The lowering to use; `requested` is "auto", "flat" or "instances"."""
        return self.lowering if requested == "auto" else requested

    def reason(self, requested: str) -> str:
        """The selected lowering, the reason for it, and the predicted times as a line of text."""
        looped = self.selected(requested) == "instances"
        if requested != "auto":
            why = "as the specification asks"
        elif looped and not self._is_faster_looped:
            why = f"since straight-line code would take the compiler some {self.compiler:.0f} s"
        elif looped or self.instances > self.flat:
            why = "the faster form"
        else:
            why = f"since loops do not take less than {MARGIN:.0%} of its time"
        form = "looped over instances" if looped else "unrolled"
        times = f"{self.flat:.0f} ns unrolled, {self.instances:.0f} ns looped over instances"
        return f"{form}, {why}; predicted evaluation time of the accelerations: {times}"


def is_predicted(mechanism: SpatialMechanism) -> bool:
    """Whether the predictions hold for a mechanism in space: rigid bodies that keep their coordinates.

    Where joints have eliminated coordinates, they hold for a row of bodies with ball joints alone. They also hold for
    an open row of three or more finite-element bodies.
    """
    if _is_flexible_row(mechanism):
        return True
    rigid = all(isinstance(body, SpatialRigidBody) for body in mechanism.scene.bodies)
    if not rigid or not mechanism.joints:
        return False
    rows = [of.multipliers for of in constraining(mechanism)]
    is_row = _system(body_classes(mechanism), rows).is_path and not any(map(varies, mechanism.joints))
    return is_row or not mechanism.eliminated_joints


def estimate_mechanism_costs(mechanism: AnyMechanism) -> MechanismCosts:
    """The predicted costs of both lowerings of a mechanism, in space of one that `is_predicted`."""
    if isinstance(mechanism, SpatialMechanism) and _is_flexible_row(mechanism):
        return _of_flexible_row(mechanism)
    rows = [of.multipliers for of in constraining(mechanism)]
    classes = body_classes(mechanism)
    flat = sum(len(of.members) * _body_times(mechanism, of, rows)[0] for of in classes)
    looped = _loops(mechanism, classes, rows)
    if rows:
        system = _system(classes, rows)
        if sum(len(of.members) for of in classes) > TWO:
            looped = min(looped, _loops(mechanism, joined_classes(mechanism, classes, system), rows))
        path = system.is_path and not system.closes_loops
        flat += 0.21 * _products(system, system.rows)
        looped += 4.4 * len(rows) + (0.16 if path else 0.25) * _products(system, [system.size] * len(rows))
    varying = _varying_joints(mechanism, classes)
    flat += 6.0 * sum(varying)
    looped += 11.0 * sum(map(_passes, varying))
    if not isinstance(mechanism, SpatialMechanism):
        return MechanismCosts(flat * (1 + _beyond(flat, IN_CACHE, TWICE)), looped, _of_compiler(flat))
    if varying:
        flat = 95.0 * len(mechanism.instances) + 5.0 * _pairs_to_ground(mechanism) + 250.0 * len(mechanism.gears)
    return MechanismCosts(flat, looped * (0.8 if mechanism.gears else 1.0), _of_compiler(IN_SPACE * flat))


def _is_flexible_row(mechanism: SpatialMechanism) -> bool:
    """Whether a mechanism is an open row of three or more finite-element bodies."""
    flexible = all(isinstance(body, FlexibleBody) for body in mechanism.scene.bodies)
    if (
        not flexible
        or len(mechanism.instances) <= TWO
        or not mechanism.joints
        or mechanism.gears
        or mechanism.eliminated_joints
    ):
        return False
    system = _system(body_classes(mechanism), [joint.multipliers for joint in mechanism.joints])
    return system.is_path and not system.closes_loops


def _of_flexible_row(mechanism: SpatialMechanism) -> MechanismCosts:
    """The times of an open row of finite-element bodies."""
    rows = [joint.multipliers for joint in mechanism.joints]
    classes = body_classes(mechanism)
    flat = looped = 0.0
    for of in joined_classes(mechanism, classes, _system(classes, rows)):
        modes = mechanism.kinds[of.first.instance.kind].equations.body.modes
        time, count = 30.0 * modes + 40.0 * sum(rows) / len(mechanism.instances), len(of.members)
        flat += count * time
        looped += time * (1.4 if count == 1 else 2.2 * -(-count // LANES))
    return MechanismCosts(flat, looped, 0.0)


def _of_compiler(flat: float) -> float:
    """The time of the compiler (s) for straight-line code that takes so many ns."""
    return 0.02 * flat + 2.2e-8 * flat**3


def _pairs_to_ground(mechanism: SpatialMechanism) -> int:
    """The pairs of a joint and one on its shortest way to the ground, itself among them, summed over all bodies."""
    beside: dict[str, set[str]] = {}
    for joint in mechanism.joints:
        first, second = joint.joint.first.body, joint.joint.second.body
        beside.setdefault(first, set()).add(second)
        beside.setdefault(second, set()).add(first)
    total, distance, reached, last = 0, 0, {GROUND}, {GROUND}
    while last:
        total, distance = total + distance * len(last), distance + 1
        last = {body for other in last for body in beside.get(other, ())} - reached
        reached |= last
    return total


def _loops(mechanism: AnyMechanism, classes: Sequence[BodyClass], rows: Sequence[int]) -> float:
    """The time of the loops over the bodies of classes."""
    times = [(_passes(len(of.members)), _body_times(mechanism, of, rows)[1]) for of in classes]
    once = sum(time for _, time in times)
    return sum(passes * time for passes, time in times) * (1 + _beyond(once, LOOPS_IN_CACHE, LOOPS_TWICE))


def _beyond(time: float, in_cache: float, twice: float) -> float:
    """The part of its time that code takes in addition, since it is too long for the instruction cache."""
    return min(max((time - in_cache) / (twice - in_cache), 0.0), 1.0)


def _system(classes: Sequence[BodyClass], rows: Sequence[int]) -> Blocks:
    """The blocks of the joints and gears with these numbers of rows, which the bodies of the classes couple."""
    members = [member for of in classes for member in of.members]
    return blocks(rows, *handles_of(members))


def _varying_joints(mechanism: AnyMechanism, classes: Sequence[BodyClass]) -> list[int]:
    """The numbers of joints and gears of each kind whose constraints depend on several of their bodies at once."""
    number = {member.instance.name: k for k, of in enumerate(classes) for member in of.members}
    joints = (joint for joint in mechanism.joints if varies(joint))
    ends = ((joint, (joint.joint.first.body, joint.joint.second.body)) for joint in joints)
    kinds = Counter((joint.type, plain_joint(joint), *map(number.get, bodies)) for joint, bodies in ends)
    gears = Counter((gear.form, *(number.get(marker.body) for marker in gear.markers)) for gear in gears_of(mechanism))
    return [*kinds.values(), *gears.values()]


def _body_times(mechanism: AnyMechanism, of: BodyClass, rows: Sequence[int]) -> tuple[float, float]:
    """The times of a body of a class in straight-line code and in loops."""
    instance = of.first.instance
    equations = mechanism.kinds[instance.kind].equations.expanded()
    coordinates = len(instance.coordinates.rows)
    constraints = sum(rows[h.joint] for h in of.first.handles)
    addends = _addends((*equations.force, *(d.expr for d in equations.definitions)))
    entries = sum(entry != 0 for entry in equations.mass)
    dense = coordinates * entries if constraints and entries > coordinates else 0
    products = coordinates * constraints
    return (
        5.7 + 0.74 * products + 0.39 * addends + 0.13 * dense,
        3.3 + 0.57 * products + 0.49 * addends + 0.18 * dense,
    )


def _addends(expressions: Iterable[sp.Expr]) -> int:
    return sum(len(sp.Add.make_args(expr)) for expr in expressions)


def _passes(count: int) -> float:
    """The time of a loop over so many bodies of a class, in times of a single one."""
    if count < LANES:
        return count if count == 1 else 0.6 * count
    return 0.4 * LANES * -(-count // LANES)


def _products(system: Blocks, rows: Sequence[int]) -> float:
    """The products of the elimination of joints with so many rows."""
    size = [0] * len(rows)
    for joint, place in enumerate(system.position):
        size[place] = rows[joint]
    later = (len(others) for others in system.neighbours)
    return sum(r**3 * (1 / 3 + k + k * (k + 1) / 2) for r, k in zip(size, later, strict=True))
