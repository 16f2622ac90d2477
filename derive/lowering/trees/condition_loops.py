"""The values of the constraints of trees, their bias, and their Jacobian G from what they exert on frames.

The factor of a row is the virtual work of these loads by its unit motion. Both refer to the inertial origin: with x the
position of the frame, a force f and a torque n there are f and n + x x f. A ball between the row and the frame takes
the place of the frame, and passes no torque.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import casadi as ca

from derive.algebra import sp
from derive.ir.expressions import Operator
from derive.ir.indices import constant
from derive.ir.statements import ForEach, Statement, Work
from derive.lowering.instances.loop_code.kernels import ZERO
from derive.lowering.trees.ball_columns import TWIST, LinkPair, pairs_of, unit_motion
from derive.lowering.trees.conditions import VECTORS, Conditions, frame_symbol
from derive.lowering.trees.link_frames import CARRIED, frame_motion
from derive.lowering.trees.link_loop import LinkLoop
from derive.lowering.trees.motion import FRAME, ORIGIN, TreeMotion, matrix
from derive.lowering.trees.newton_euler import carried_accelerations
from derive.lowering.vectors import applied, cross, plus, scaled, transposed
from derive.mechanics.terms import Constraint

EXERTED = "exerted"
"""The array of the loads of unit multipliers on frames."""
EACH = 9
"""The numbers of a load: a force, its moment about the inertial origin, and the position of the frame."""


@dataclass(frozen=True)
class ConditionLoops:
    """The code of the constraints of a tree; parameters: the symbols of those of the model."""

    motion: TreeMotion
    conditions: Conditions
    coordinates: Sequence[sp.Symbol]
    velocities: Sequence[sp.Symbol]
    parameters: frozenset[sp.Symbol]

    def values(
        self, output: str, of: Callable[[Constraint], sp.Expr], moving: bool, biased: bool = False, first: int = 0
    ) -> ForEach:
        """The loop, of one iteration, that writes a value of each constraint from an element of an array on."""
        loop = LinkLoop(self.motion.arrays, f"constraints_{output}", [0])
        for number, condition in enumerate(self.conditions.every):
            loop.store(output, constant(first + number), self._value(loop, of(condition), moving, biased))
        return loop.made()

    def loads(self, multipliers: tuple[str, int], array: str) -> list[Statement]:
        """The statements that subtract what multipliers exert from an array with a force and a torque of each link."""
        if not self.conditions.of_frames:
            return []
        loop = LinkLoop(self.motion.arrays, f"exerted_{array}", [0])
        for factor in self.conditions.of_frames:
            by = loop.element(multipliers[0], constant(multipliers[1] + factor.condition))
            values = [by * self._value(loop, x) for x in factor.values]
            place = self.conditions.frames[factor.frame].place
            slot = loop.place(
                f"frame_{factor.frame}", [self.motion.arrays.slot(place.link)], self.motion.arrays.spacing
            )
            lever = self._frame(loop, factor.frame, moving=False, biased=False)["lever"]
            force, torque = values[:3], values[3:]
            for k, value in enumerate([*force, *plus(torque, cross(lever, force))]):
                loop.store(array, slot.at(k), value, Operator.SUB)
        return [loop.made()]

    def on_rows(
        self, factors: tuple[str, int], target: tuple[str, int], by_row: bool, operator: Operator
    ) -> list[Statement]:
        """The statements that add or subtract products of G's factors of rows, from elements of arrays on.

        by_row: the target has an element for each row and `factors` one for each constraint; or the other way round.
        """
        if not self.conditions.of_rows:
            return []
        loop = LinkLoop(self.motion.arrays, f"on_rows_{target[0]}_{target[1]}", [0])
        for of in self.conditions.of_rows:
            to, by = (of.row, of.condition) if by_row else (of.condition, of.row)
            value = self._value(loop, of.value) * loop.element(factors[0], constant(factors[1] + by))
            loop.store(target[0], constant(target[1] + to), value, operator)
        return [loop.made()]

    def _value(self, loop: LinkLoop, expr: sp.Expr, moving: bool = False, biased: bool = False) -> ca.SX:
        """The value of an expression; moving, biased: whether velocities, and accelerations, of frames are known."""
        present = expr.free_symbols
        for number in range(len(self.conditions.frames)):
            names = [(what, k) for what, count in (*((v, 3) for v in VECTORS), ("axes", 9)) for k in range(count)]
            if present & {frame_symbol(number, what, k) for what, k in names}:
                known = self._frame(loop, number, moving, biased)
                loop.symbols.values |= {frame_symbol(number, w, k): known[w][k] for w, k in names if w in known}
        for array, symbols in ((self.motion.q, self.coordinates), (self.motion.v, self.velocities)):
            for k, symbol in enumerate(symbols):
                if symbol in present:
                    loop.symbols.values[symbol] = loop.element(array[0], constant(array[1] + k))
        for symbol in present - loop.symbols.values.keys():
            is_parameter = symbol in self.parameters
            loop.symbols.values[symbol] = loop.value(symbol) if is_parameter else loop.scalar(symbol.name)
        return loop.symbols(expr)

    def _frame(self, loop: LinkLoop, number: int, moving: bool, biased: bool) -> dict[str, list[ca.SX]]:
        """The motion of a frame, from that of its link."""
        return frame_motion(loop, f"frame_{number}", [self.conditions.frames[number].place], moving, biased)

    def bias(self, output: str) -> list[Statement]:
        """The statements of gamma, with the accelerations that frames have without those of coordinates."""
        motion = self.motion
        ground = [*motion.work((CARRIED, 6), cleared=bool(motion.free)), *motion.at_ground(CARRIED, [ZERO] * 6)]
        loops = [carried_accelerations(motion, None, CARRIED)] if motion.joints else []
        return [*ground, *loops, self.values(output, lambda of: -of.bias, moving=True, biased=True)]

    def jacobian(self, array: str, position: Callable[[int, int], int]) -> list[Statement]:
        """The statements that add the entries of G to an array of zeros; position: of the entry of a row, a column."""
        motion, tree = self.motion, self.motion.tree
        result: list[Statement] = []
        if self.conditions.of_frames:
            result += [*motion.work((TWIST, 6)), Work(EXERTED, EACH * len(self.conditions.of_frames))]
            result += [self._exerted(), *([self._twists()] if motion.joints else [])]
        found = [
            (n, pair) for n, link in self._moving() for pair in pairs_of(tree, link) if pair.moved == self._link(n)
        ]
        for is_free in (False, True):
            for across in (False, True):
                some = [
                    (n, pair)
                    for n, pair in found
                    if tree.links[pair.link].is_free == is_free and (pair.ball is not None) == across
                ]
                if some:
                    result.append(self._entries(array, position, some, is_free, across))
        if self.conditions.of_rows:
            loop = LinkLoop(motion.arrays, f"rows_of_{array}", [0])
            for factor in self.conditions.of_rows:
                place = constant(position(factor.condition, factor.row))
                loop.store(array, place, self._value(loop, factor.value), Operator.ADD)
            result.append(loop.made())
        return result

    def entries(self) -> set[tuple[int, int]]:
        """The entries of G."""
        tree, result = self.motion.tree, {(of.condition, of.row) for of in self.conditions.of_rows}
        for n, link in self._moving():
            row = tree.links[link].row
            count = 6 if tree.links[link].is_free else 1
            result |= {(self.conditions.of_frames[n].condition, row + k) for k in range(count)}
        return result

    def _link(self, number: int) -> int:
        return self.conditions.frames[self.conditions.of_frames[number].frame].place.link

    def _moving(self) -> Iterator[tuple[int, int]]:
        """Yield each load with the links that move its frame."""
        for number in range(len(self.conditions.of_frames)):
            link = self._link(number)
            while link >= 0:
                yield number, link
                link = self.motion.tree.links[link].parent

    def _exerted(self) -> ForEach:
        loop = LinkLoop(self.motion.arrays, "exerted", [0])
        for number, factor in enumerate(self.conditions.of_frames):
            values = [self._value(loop, x) for x in factor.values]
            x = self._frame(loop, factor.frame, moving=False, biased=False)["position"]
            force, torque = values[:3], values[3:]
            for k, value in enumerate([*force, *plus(torque, cross(x, force)), *x]):
                loop.store(EXERTED, constant(number * EACH + k), value)
        return loop.made()

    def _twists(self) -> ForEach:
        loop = self.motion.loop("twists", self.motion.joints)
        loop.store_vector(TWIST, loop.of_links(), unit_motion(loop))
        return loop.made(independent=True)

    def _entries(
        self,
        array: str,
        position: Callable[[int, int], int],
        some: Sequence[tuple[int, LinkPair]],
        is_free: bool,
        across: bool,
    ) -> ForEach:
        """The loop over links and loads of which a link moves the frame."""
        motion, tree = self.motion, self.motion.tree
        name = f"{'free_' * is_free}{array}{'_across' * across}"
        loop = LinkLoop(motion.arrays, name, range(len(some)))
        load = loop.place("load", [EACH * n for n, _ in some])
        here = loop.place("link", [motion.arrays.slot(pair.link) for _, pair in some], motion.arrays.spacing)
        force = [loop.element(EXERTED, load.at(k)) for k in range(3)]
        moment = [loop.element(EXERTED, load.at(3 + k)) for k in range(3)]
        if across:
            balls = [motion.arrays.slot(pair.ball) for _, pair in some if pair.ball is not None]
            moment = cross(loop.vector(ORIGIN, loop.place("ball", balls, motion.arrays.spacing)), force)
        if is_free:
            x = loop.vector(ORIGIN, here)
            about = plus(moment, scaled(ca.SX(-1), cross(x, force)))
            values = [*force, *applied(transposed(matrix(loop.vector(FRAME, here, 9))), about)]
        else:
            twist = loop.vector(TWIST, here, 6)
            values = [sum((a * b for a, b in zip(twist, [*force, *moment], strict=True)), ca.SX(0))]
        conditions = self.conditions.of_frames
        for k, value in enumerate(values):
            places = [position(conditions[n].condition, tree.links[pair.link].row + k) for n, pair in some]
            loop.store(array, loop.place(f"entry_{k}", places).at(0), value, Operator.ADD)
        return loop.made()
