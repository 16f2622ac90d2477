"""Springs, dampers and bushings of a spatial scene: the motions along which they act, their stiffness and damping."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from decimal import Decimal

from decimal_vectors import ONE, ZERO, Array, length
from relative_motion import WHOLE_TURN, axial, coupled, relative_angle, removed, without_turns
from space_kinematics import Pose, SpaceKinematics, SpaceState
from written_scene import Table


class SpringKinematics(SpaceKinematics):
    """A scene with the motions of its springs as functions of t and a state."""

    def spring_rotation(
        self, table: Table, t: Decimal, state: SpaceState, poses: Mapping[str, Pose], R: Array
    ) -> Decimal:
        """The rotation of a spring, with all turns between the markers of a joint whose body counts them."""
        for name, joint in self.joints.items():
            if (
                {*joint["between"]} == {*table["between"]}
                and {"rx", "ry"} <= {*removed(joint)}
                and "rz" not in removed(joint)
            ):
                sign = 1 if joint["between"] == table["between"] else -1
                if any(placing == name for _, placing in self.held):
                    return sign * self.coupled_motion(name, t, state, poses)[0]
                if name in self.drives and coupled(joint) == "rz":
                    (_, A1), (_, A2) = (self.frame(end, state, poses) for end in joint["between"])
                    less = self.motion(name, t) - relative_angle(A1.T @ A2)
                    return relative_angle(R) + sign * (less - without_turns(less, ONE))
                if joint["kind"] == "screw":
                    (x1, A1), (x2, A2) = (self.frame(end, state, poses) for end in joint["between"])
                    turn = self.value(joint["pitch"]) / WHOLE_TURN
                    d = (A1.T @ (x2 - x1))[2]
                    less = d - turn * relative_angle(A1.T @ A2)
                    return relative_angle(R) + sign * (less - without_turns(less, turn)) / turn
        return relative_angle(R)

    def spring_motions(self, t: Decimal, state: SpaceState, poses: Mapping[str, Pose]) -> list[Decimal]:
        """Lengths, rotations, and relative displacements along which springs act, in the order of `elements`."""
        result: list[Decimal] = []
        for table in self.springs.values():
            (x1, A1), (x2, A2) = (self.frame(end, state, poses) for end in table["between"])
            R = A1.T @ A2
            match table.get("kind", "linear"):
                case "linear":
                    result.append(length(x2 - x1))
                case "rotational":
                    result.append(self.spring_rotation(table, t, state, poses, R))
                case "bushing":
                    result += [*(A1.T @ (x2 - x1)), *axial(R)]
        return result

    def elements(self) -> list[tuple[Decimal, Decimal, Decimal]]:
        """Stiffness, damping constant and rest of each spring; six of a bushing, which is at rest at zero.

        They are zero for the matrices of a bushing, which are in `couplings`.
        """
        result = []
        for table in self.springs.values():
            kind = table.get("kind", "linear")
            if kind not in ("linear", "rotational", "bushing"):
                raise NotImplementedError(f"a {kind} spring")
            if kind == "bushing":
                numbers = (self.value.vector(_diagonal(table.get(key, [0] * 6))) for key in ("stiffness", "damping"))
                result += [(k, c, ZERO) for k, c in zip(*numbers, strict=True)]
            else:
                names = ("stiffness", "damping", "rest")
                result.append(tuple(self.value(table.get(name, 0)) for name in names))
        return result

    def couplings(self) -> list[tuple[int, Array, Array]]:
        """The matrices of stiffness and damping of bushings, with the place of their motions among those of springs."""
        result, place = [], 0
        for table in self.springs.values():
            if table.get("kind") == "bushing":
                matrices = [self.value.vector([x for row in _rows(table.get(key)) for x in row]) for key in _KEYS]
                result.append((place, *(matrix.reshape(6, 6) for matrix in matrices)))
            place += 6 if table.get("kind") == "bushing" else 1
        return result


_KEYS = ("stiffness", "damping")


def _diagonal(value: Sequence[object]) -> Sequence[object]:
    """Six numbers as they are; of a matrix zeros, as its entries are counted elsewhere."""
    return [0] * 6 if isinstance(value[0], list) else value


def _rows(value: object) -> list[list[object]]:
    """The rows of a matrix; zeros of six numbers, which are counted elsewhere."""
    return value if isinstance(value, list) and isinstance(value[0], list) else [[0] * 6] * 6
