"""An oracle for scenes that knows x = c + Q (X + u), virtual displacements and virtual work, and nothing else.

Bodies are clouds of point masses: a beam has one in each Gauss point, a rigid body two. Positions, constraints, lengths
of springs and rotations of sections are functions of t and q; all that mechanics needs of them are values, derivatives
along the motion (t + s, q + s v) and by each coordinate, which are differences of numbers with 50 digits.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import mpmath
import numpy as np
from kinematics import DIGITS, Kinematics, Piece, Real, pose
from scipy.linalg import lu_factor, lu_solve
from shapes import at, gauss

from derive.spec.model.markers import GROUND

STEP = mpmath.mpf(10) ** -12


@dataclass(frozen=True)
class Seen:
    """The results of the oracle in one state, as arrays of mpf; see `Oracle.see`."""

    M: np.ndarray
    h: np.ndarray
    G: np.ndarray
    g: np.ndarray
    gdot: np.ndarray
    gamma: np.ndarray
    vdot: np.ndarray
    lam: np.ndarray
    energy: np.ndarray
    momentum: np.ndarray
    poses: np.ndarray
    markers: Mapping[str, tuple[np.ndarray, np.ndarray, np.ndarray]]


class Oracle(Kinematics):
    """The equations of motion of a scene as numbers."""

    def see(self, t: float, q: np.ndarray, v: np.ndarray) -> Seen:
        """Everything in one state."""
        with mpmath.workdps(DIGITS):
            return self._see(mpmath.mpf(t), [mpmath.mpf(float(x)) for x in q], [mpmath.mpf(float(x)) for x in v])

    def _see(self, t: Real, q: list[Real], v: list[Real]) -> Seen:
        n = len(q)

        def values(s: Real, moved: Sequence[Real]) -> np.ndarray:
            return np.array(self.everything(t + s, moved), dtype=object)

        def along(s: Real) -> np.ndarray:
            return values(s, [a + s * b for a, b in zip(q, v, strict=True)])

        def by(j: int) -> np.ndarray:
            ahead, behind = ([x + (sign * STEP if i == j else 0) for i, x in enumerate(q)] for sign in (1, -1))
            return (values(0, ahead) - values(0, behind)) / (2 * STEP)

        now, ahead, behind = along(mpmath.mpf(0)), along(STEP), along(-STEP)
        rate, second = (ahead - behind) / (2 * STEP), (ahead - 2 * now + behind) / STEP**2
        J = np.array([by(j) for j in range(n)], dtype=object).reshape(n, len(now)).T
        points, m = 2 * len(self.cloud), len(self.row)
        weights = np.repeat(np.array([mass for mass, _ in self.cloud], dtype=object), 2)
        falling = np.array(list(self.gravity) * len(self.cloud), dtype=object)
        body = slice(0, points)
        M = J[body].T @ (weights[:, None] * J[body]) if points else np.zeros((n, n), dtype=object)
        h = J[body].T @ (weights * (second[body] - falling)) if points else np.zeros(n, dtype=object)
        h = h + self._elastic(q) + self._damped(v)
        of_g = slice(points, points + m)
        h = h - self._distributed(t, q, J) - self._given(t, J, now, points + m) + self._sprung(J, now, rate)
        G, gamma = J[of_g], -second[of_g]
        vdot, lam = _solved(M, h, G, gamma)
        return Seen(
            M,
            h,
            G,
            now[of_g],
            rate[of_g],
            gamma,
            vdot,
            lam,
            self._energy(t, q, now, rate),
            self._momentum(t, q, now, rate),
            self._all_poses(t, q),
            self._seen_markers(J, now, rate),
        )

    def _elastic(self, q: list[Real]) -> np.ndarray:
        """dU/dq with U = 1/2 int EI (d2v/dx2)^2 dx."""
        force = np.array([mpmath.mpf(0)] * len(q), dtype=object)
        for piece in self.pieces.values():
            for xi, w in gauss(DIGITS):
                bend = [at(s, xi, 2) * 4 / piece.length**2 for s in piece.shapes]
                curvature = sum(q[j] * b for j, b in zip(piece.columns, bend, strict=True))
                for j, b in zip(piece.columns, bend, strict=True):
                    force[j] += piece.bending * curvature * b * w * piece.length / 2
        return force

    def _strain(self, q: list[Real]) -> Real:
        amplitudes = np.array(q, dtype=object)
        return (self._elastic(q) @ amplitudes) / 2 if self.pieces else mpmath.mpf(0)  # U is quadratic

    def _damped(self, v: list[Real]) -> np.ndarray:
        """B alphadot: of proportional damping, and of B = 2 ratio M (M^-1 K)^(1/2), with M and K of the whole rod."""
        force = np.array([mpmath.mpf(0)] * len(v), dtype=object)
        for rod in (b for b in self.scene.bodies if b.name in self.rods and b.beam.damping):
            ratio, a, b = (self.number(x) for x in vars(rod.beam.damping).values())
            pieces = self.rods[rod.name]
            columns = [column for piece in pieces for column in piece.columns]
            n = len(columns)
            M, K = mpmath.zeros(n), mpmath.zeros(n)
            fields = self._deformation(pieces)
            for k, piece in enumerate(pieces):
                own = slice(k * len(piece.columns), (k + 1) * len(piece.columns))
                for xi, w in gauss(DIGITS):
                    dx, bend = w * piece.length / 2, mpmath.zeros(n, 1)
                    bend[own, 0] = mpmath.matrix([at(s, xi, 2) * 4 / piece.length**2 for s in piece.shapes])
                    moved = (self._fields(piece, k, len(pieces), xi) * fields).T
                    M += dx * piece.mass / piece.length * moved * moved.T
                    K += dx * piece.bending * bend * bend.T
            B = a * M + b * K
            B += 2 * ratio * M * mpmath.sqrtm(M**-1 * K).apply(mpmath.re) if ratio else mpmath.zeros(n)
            for i, row in enumerate(columns):
                force[row] += sum(B[i, j] * v[column] for j, column in enumerate(columns))
        return force

    def _fields(self, piece: Piece, k: int, pieces: int, xi: Real, derivative: int = 0) -> mpmath.matrix:
        """1, x and the shapes of piece k at xi, or their slopes, where they have columns among those of all pieces."""
        n = len(piece.shapes)
        row = mpmath.zeros(1, pieces * (2 + n))
        row[k * (2 + n)] = 0 if derivative else 1
        row[k * (2 + n) + 1] = 1 if derivative else xi * piece.length / 2
        shapes = piece.basis(xi)[derivative]
        for i, value in enumerate(shapes):
            row[k * (2 + n) + 2 + i] = value
        return row

    def _deformation(self, pieces: Sequence[Piece]) -> mpmath.matrix:
        """All fields for unit amplitudes of all pieces: with no break at a cut, and no rigid motion on average."""
        count, n = len(pieces), len(pieces[0].shapes)
        size, length = 2 + n, pieces[0].length
        conditions = []
        for k in range(count - 1):
            for derivative in (0, 1):
                left = self._fields(pieces[k], k, count, mpmath.mpf(1), derivative)
                conditions.append(left - self._fields(pieces[k + 1], k + 1, count, -mpmath.mpf(1), derivative))
        for power in (0, 1):
            mean = mpmath.zeros(1, count * size)
            for k, piece in enumerate(pieces):
                for xi, w in gauss(DIGITS):
                    x = (k - mpmath.mpf(count - 1) / 2 + xi / 2) * length
                    mean += w * x**power * self._fields(piece, k, count, xi)
            conditions.append(mean)
        known = [(k * n + i, k * size + 2 + i) for k in range(count) for i in range(n)]
        A, b = mpmath.zeros(count * size), mpmath.zeros(count * size, count * n)
        for i, condition in enumerate(conditions):
            A[i, :] = condition
        for i, (amplitude, field) in enumerate(known, len(conditions)):
            A[i, field], b[i, amplitude] = 1, 1
        return mpmath.inverse(A) * b

    def _distributed(self, t: Real, q: list[Real], J: np.ndarray) -> np.ndarray:
        """The work of distributed loads on the points of the cloud, whose weights are those of an integral."""
        total, at_pose = np.array([mpmath.mpf(0)] * J.shape[1], dtype=object), self.poses(t, q)
        for i, (mass, spot) in enumerate(self.cloud):
            rod = next((b for b in self.scene.bodies if spot.body in (p.name for p in self.rods.get(b.name, []))), None)
            if rod is None or i >= self.on_axes:
                continue
            pieces = self.rods[rod.name]
            k = next(k for k, piece in enumerate(pieces) if piece.name == spot.body)
            dx = mass / pieces[k].mass * pieces[k].length
            xi = (2 * (k + (spot.r[0] / pieces[k].length + mpmath.mpf(1) / 2))) / len(pieces) - 1
            for load in rod.loads:
                size = self.of_time(load.time, t) * dx
                p = tuple(sum(self.number(c) * xi**n for n, c in enumerate(of)) * size for of in load.force)
                if load.frame == "body":
                    p = at_pose[spot.body].turned(p)
                total = total + p[0] * J[2 * i] + p[1] * J[2 * i + 1]
        return total

    def _given(self, t: Real, J: np.ndarray, now: np.ndarray, start: int) -> np.ndarray:
        """The work of forces and torques."""
        total = np.array([mpmath.mpf(0)] * J.shape[1], dtype=object)
        row = start
        for force in self.scene.forces:
            components = tuple(self.of_time(component, t) for component in force.components)
            if force.frame == "body":
                components = pose((0, 0), now[row + 2]).turned(components)
            for k in range(2):
                total = total + components[k] * J[row + k]
            row += 3
        for torque in self.scene.torques:
            value = self.of_time(torque.value, t)
            total = total + value * J[row + 2]
            row += 3
            if torque.against:
                total = total - value * J[row + 2]
                row += 3
        return total

    def _sprung(self, J: np.ndarray, now: np.ndarray, rate: np.ndarray) -> np.ndarray:
        total = np.array([mpmath.mpf(0)] * J.shape[1], dtype=object)
        for i, (coefficients, damping, rest) in enumerate(self._springs(), len(now) - len(self._springs())):
            force = sum(c * (now[i] - rest) ** n for n, c in enumerate(coefficients, 1))
            total = total + (force + damping * rate[i]) * J[i]
        return total

    def _springs(self) -> list[tuple[list[Real], Real, Real]]:
        """The coefficients of each characteristic from power one on, the damping constant, and the length at rest."""
        powers = ("quadratic", "cubic", "quartic", "quintic")
        found = []
        for spring, end in self.sprung():
            names = [f"stiffness{end}", *(powers if not end else ()), f"damping{end}", f"rest{end}"]
            *coefficients, damping, rest = (self.number(getattr(spring, name)) for name in names)
            found.append((coefficients, damping, rest))
        return found

    def _counted(self, t: Real, q: list[Real]) -> set[str]:
        """Bodies that have coordinates, and whose place depends on these alone."""
        one, other = self.poses(t, q), self.poses(t + 1, q)
        moving = {name for name in one if one[name] != other[name]}
        held = {n for n in self.rigid if not {f"{n}_c1", f"{n}_phi", f"{n}_s"} & set(self.column)}
        return {*self.pieces, *self.rigid} - moving - held

    def _energy(self, t: Real, q: list[Real], now: np.ndarray, rate: np.ndarray) -> np.ndarray:
        counted = self._counted(t, q)
        kinetic = weight = mpmath.mpf(0)
        for i, (mass, spot) in enumerate(self.cloud):
            if spot.body in counted:
                kinetic += mass * sum(x * x for x in rate[2 * i : 2 * i + 2]) / 2
                weight -= mass * sum(g * x for g, x in zip(self.gravity, now[2 * i : 2 * i + 2], strict=True))
        strain, still = self._strain(q), counted | {GROUND} | self._fixed(t, q)
        springs = zip(self.sprung(), self._springs(), strict=True)
        for i, ((spring, _), (coefficients, _, rest)) in enumerate(springs, len(now) - len(self.sprung())):
            if all(self.spots[p].body in still for p in (spring.first, spring.second)):
                strain += sum(c * (now[i] - rest) ** (n + 1) / (n + 1) for n, c in enumerate(coefficients, 1))
        return np.array([kinetic, strain] + ([weight] if self.scene.gravity else []), dtype=object)

    def _fixed(self, t: Real, q: list[Real]) -> set[str]:
        one, other = self.poses(t, q), self.poses(t + 1, q)
        return {name for name in self.rigid if one[name] == other[name]}

    def _momentum(self, t: Real, q: list[Real], now: np.ndarray, rate: np.ndarray) -> np.ndarray:
        counted = self._counted(t, q)
        total = [mpmath.mpf(0)] * 3
        for i, (mass, spot) in enumerate(self.cloud):
            if spot.body in counted:
                (x, y), (u, w) = now[2 * i : 2 * i + 2], rate[2 * i : 2 * i + 2]
                total = [a + mass * b for a, b in zip(total, (u, w, x * w - y * u), strict=True)]
        return np.array(total, dtype=object)

    def _all_poses(self, t: Real, q: list[Real]) -> np.ndarray:
        """The poses in the order of the specification, pieces one by one."""
        bodies = (self.rods.get(b.name, [b]) for b in self.scene.bodies)
        names = [one.name for some in bodies for one in some]
        found = self.poses(t, q)
        return np.array([[*found[n].c, found[n].phi] for n in names], dtype=object)

    def _seen_markers(
        self, J: np.ndarray, now: np.ndarray, rate: np.ndarray
    ) -> dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Position, velocity and Jacobian of each marker."""
        found, end = {}, len(now) - len(self.sprung())
        for i, name in enumerate(self.markers):
            first = end - 3 * (len(self.markers) - i)
            rows = slice(first, first + 2)
            found[name] = now[rows], rate[rows], J[rows]
        return found


def _solved(M: np.ndarray, h: np.ndarray, G: np.ndarray, gamma: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """vdot and lambda of M vdot + h = G^T lambda, G vdot = gamma, whose equations they meet to 40 digits."""
    n, m = M.shape[0], G.shape[0]
    A, b = np.zeros((n + m, n + m), dtype=object), np.concatenate([-h, gamma])
    A[:n, :n], A[:n, n:], A[n:, :n] = M, -G.T, G
    return tuple(np.split(refined(A, b), [n]))  # type: ignore[return-value]


def refined(A: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The solution of A x = b in many digits: by doubles, and then for what is left of b, again and again."""
    lu, x, rest = lu_factor(A.astype(float)), b * mpmath.mpf(0), b
    limit = mpmath.mpf(10) ** -40 * max(map(abs, b), default=0)
    for _ in range(20):
        size = max(map(abs, rest), default=mpmath.mpf(0))
        if size <= limit:
            return x
        x = x + lu_solve(lu, (rest / size).astype(float)) * size
        rest = b - A @ x
    raise ArithmeticError("the equations are too badly conditioned for doubles")
