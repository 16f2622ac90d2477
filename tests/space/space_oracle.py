"""The equations of motion of a spatial scene from the positions of its material points and virtual work.

M vdot + h = G^T lambda with v = (cdot, omega in the floating frame, alphadot) of each body: every derivative is a
central difference of 60-digit numbers along the motion or along a virtual displacement, to about 1e-26.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal

import numpy as np
from beam_shapes import beam_shapes, gauss_points
from decimal_vectors import STEP, ZERO, Array, array, cross, floats, number, precise, solved, stacked, zeros
from mass_points import PointBody
from second_order_inertia import BodyInertia, truncated_inertia
from space_kinematics import Pose, SpaceState
from spring_motions import SpringKinematics

TWICE = 2 * STEP


@dataclass(frozen=True, eq=False)
class Mechanics:
    """The results of the oracle in one state; mass_sizes, force_sizes: sums of the magnitudes of what M and h add up.

    rows: names of the constraints, by joint and row.
    """

    M: Array
    h: Array
    mass_sizes: Array
    force_sizes: Array
    rows: tuple[str, ...]
    g: Array
    G: Array
    gdot: Array
    gamma: Array
    energy: Mapping[str, Decimal]
    momentum: Array
    poses: Mapping[str, Pose]
    markers: Mapping[str, tuple[Array, Array, Array]]

    def accelerations(self) -> tuple[Array, Array]:
        """vdot and lambda, if the constraints are independent."""
        n, m = len(self.h), len(self.g)
        with precise():
            matrix = np.block([[self.M, -self.G.T], [self.G, zeros(m, m)]]) if m else self.M
            result = solved(matrix, np.concatenate([-self.h, self.gamma]))
        return result[:n], result[n:]


class SpaceOracle(SpringKinematics):
    """A scene whose equations are evaluated in states."""

    def see(self, t: float, q: Array, v: Array) -> Mechanics:
        """Everything in one state."""
        with precise():
            return self.see_state(number(t), self.columns.state(q), array(v))

    def _functions(self, t: Decimal, state: SpaceState) -> tuple[Array, ...]:
        """Points, constraints, frames of forces (12 numbers each), motions of springs, positions of markers."""
        poses = self.poses(t, state)
        points = self.points(state, poses)
        frames = [stacked([x, A.ravel()]) for x, A in (self.frame(m, state, poses) for m in self.acted_on())]
        return (
            np.concatenate([x.ravel() for x in points]) if points else zeros(0),
            np.array(list(self.constraints(t, state, poses).values()), dtype=object),
            np.concatenate(frames) if frames else zeros(0),
            np.array(self.spring_motions(t, state, poses), dtype=object),
            np.concatenate([self.frame(m, state, poses)[0] for m in self.all_markers()] or [zeros(0)]),
        )

    def velocities(self, t: float, q: Array, v: Array) -> list[tuple[PointBody, Array]]:
        """The bodies with the velocities (P, 3) of their points."""
        with precise():
            state, rates, at = self.columns.state(q), array(v), number(t)
            ends = []
            for s in (STEP, -STEP):
                moved = self.columns.moved(state, rates, s)
                ends.append(self.points(moved, self.poses(at + s, moved)))
            return [(body, (a - b) / TWICE) for body, a, b in zip(self.bodies.values(), *ends, strict=True)]

    def all_markers(self) -> list[str]:
        """References of the markers of all bodies."""
        return [f"{body.name}.{name}" for body in self.bodies.values() for name in body.markers]

    def see_state(self, t: Decimal, state: SpaceState, v: Array) -> Mechanics:
        """Everything in a state of decimal numbers, under `precise()`."""
        columns, n = self.columns, self.columns.size

        def along(s: Decimal) -> tuple[Array, ...]:
            return self._functions(t + s, columns.moved(state, v, s))

        def varied(j: int) -> list[Array]:
            unit = zeros(n)
            unit[j] = Decimal(1)
            ends = (self._functions(t, columns.moved(state, unit, s)) for s in (STEP, -STEP))
            return [(a - b) / TWICE for a, b in zip(*ends, strict=True)]

        now, ahead, behind = along(ZERO), along(STEP), along(-STEP)
        rate = [(a - b) / TWICE for a, b in zip(ahead, behind, strict=True)]
        second = [(a - 2 * x + b) / (STEP * STEP) for a, x, b in zip(ahead, now, behind, strict=True)]
        by = [varied(j) for j in range(n)]
        jacobians = [np.array([b[k] for b in by], dtype=object).reshape(n, len(now[k])).T for k in range(len(now))]
        inertia = self._of_second_order(t, state, v)
        M, mass_sizes, h, force_sizes = self._inertia(jacobians[0], second[0], inertia)
        for force in (
            *self._internal(state, v),
            *self._on_nodes(t, self.poses(t, state), jacobians[0]),
            *self._applied(t, now[2], jacobians[2]),
            *self._distributed(t, self.poses(t, state), jacobians[4]),
            *self._distributed_torques(t, now[2], jacobians[2]),
            *self._sprung(now[3], rate[3], jacobians[3]),
        ):
            h, force_sizes = h + force, force_sizes + abs(force)
        poses = self.poses(t, state)
        names = self.all_markers()
        x, xdot, J = now[4].reshape(-1, 3), rate[4].reshape(-1, 3), jacobians[4].reshape(len(names), 3, n)
        return Mechanics(
            M,
            h,
            mass_sizes,
            force_sizes,
            tuple(self.constraints(t, state, poses)),
            now[1],
            jacobians[1],
            rate[1],
            -second[1],
            self._energies(state, now, rate, jacobians[0], inertia),
            self._momenta(now[0], rate[0], inertia),
            poses,
            {name: (x[i], xdot[i], J[i]) for i, name in enumerate(names)},
        )

    def _of_second_order(self, t: Decimal, state: SpaceState, v: Array) -> dict[str, BodyInertia]:
        """The inertia of the bodies with displacements of second order."""
        of = ((name, body) for name, body in self.bodies.items() if body.second is not None)
        return {name: truncated_inertia(body, self.columns, state, v, self.gravity) for name, body in of}

    def _inertia(
        self, J: Array, second: Array, truncated: Mapping[str, BodyInertia]
    ) -> tuple[Array, Array, Array, Array]:
        """M, and the part of h from accelerations and gravity; with the sums of magnitudes."""
        n, start = J.shape[1], 0
        M, mass_sizes, h, force_sizes = zeros(n, n), zeros(n, n), zeros(n), zeros(n)
        for body in self.bodies.values():
            count = len(body.points)
            own = slice(start, start + 3 * count)
            start += 3 * count
            if not count:
                continue
            used = [j for j in range(n) if any(J[own, j])]
            Jb = J[own][:, used].reshape(count, 3, len(used))
            acceleration = second[own].reshape(count, 3) - self.gravity
            for k in range(3):
                weighted = body.masses @ Jb[:, k]
                block = np.ix_(used, used)
                M[block] = M[block] + Jb[:, k].T @ weighted
                mass_sizes[block] = mass_sizes[block] + abs(Jb[:, k]).T @ (abs(body.masses) @ abs(Jb[:, k]))
                h[used] = h[used] + weighted.T @ acceleration[:, k]
                force_sizes[used] = force_sizes[used] + abs(Jb[:, k]).T @ (abs(body.masses) @ abs(acceleration[:, k]))
            if body.name in truncated:
                of = truncated[body.name]
                M[np.ix_(of.rows, of.rows)], h[of.rows] = of.M, of.h
        return M, mass_sizes, h, force_sizes

    def _internal(self, state: SpaceState, v: Array) -> list[Array]:
        """The forces of strain energy and B alphadot of flexible bodies."""
        result = []
        place, i = {}, 0
        for name, turns in self.columns.parts:
            place[name] = i
            i += 3 if turns else 1
        for name, body in self.bodies.items():
            own = [place[f"{name}_alpha{k}"] for k in range(1, body.n + 1)]
            if own:
                for matrix, x in ((body.stiffness, self.amplitudes(name, state)), (body.damping, v[own])):
                    for term in (matrix * x).T:  # one term for each column
                        force = zeros(len(v))
                        force[own] = term
                        result.append(force)
                for term in body.other_forces(self.amplitudes(name, state)):
                    force = zeros(len(v))
                    force[own] = term
                    result.append(force)
        return result

    def _on_nodes(self, t: Decimal, poses: Mapping[str, Pose], J: Array) -> list[Array]:
        """Less the virtual work of forces at nodes, of which a single one is that of all nodes of a load."""
        result, start = [], 0
        for name, body in self.bodies.items():
            table = self.scene["bodies"][name]
            for load in table.get("loads", {}).values() if "nodes" in table else ():
                forces = [self.value.vector(force) for force in load["forces"]]
                for i, node in enumerate(load["nodes"]):
                    force = self.value.at(load.get("time", 1), t) * forces[i if len(forces) > 1 else 0]
                    if load.get("frame", "inertial") == "body":
                        force = poses[name].R @ force
                    result += [-force[k] * J[start + 3 * node + k] for k in range(3)]
            start += 3 * len(body.points)
        return result

    def _distributed(self, t: Decimal, poses: Mapping[str, Pose], J: Array) -> list[Array]:
        """Less the virtual work of forces per length, at points of the axes of beams."""
        result, names = [], self.all_markers()
        by = J.reshape(len(names), 3, -1 if names else 0)
        for name, table in self.scene["bodies"].items():
            for load in self.loads_along(table, "force"):
                length, factor = self.value(table["length"]), self.value.at(load.get("time", 1), t)
                for i, (xi, w) in enumerate(gauss_points(beam_shapes(table).nodes)):
                    force = self._density(load["force"], xi) * factor * w * length / 2
                    if load.get("frame", "inertial") == "body":
                        force = poses[name].R @ force
                    row = names.index(f"{name}.point {i}")
                    result += [-force[k] * by[row, k] for k in range(3)]
        return result

    def _distributed_torques(self, t: Decimal, now: Array, J: Array) -> list[Array]:
        """Less the virtual work of torques per length, on the sections at the same points."""
        result, names = [], self.acted_on()
        frames, by = now.reshape(-1, 12), J.reshape(-1, 12, J.shape[1])
        for name, table in self.scene["bodies"].items():
            for load in self.loads_along(table, "torque"):
                length, factor = self.value(table["length"]), self.value.at(load.get("time", 1), t)
                for i, (xi, w) in enumerate(gauss_points(beam_shapes(table).nodes)):
                    row = names.index(f"{name}.point {i}")
                    torque = self._density(load["torque"], xi) * factor * w * length / 2
                    if load.get("frame", "inertial") == "body":
                        torque = frames[row, 3:].reshape(3, 3) @ torque
                    turned = virtual_rotations(frames[row, 3:], by[row, 3:])
                    result += [-torque[k] * turned[k] for k in range(3)]
        return result

    def _density(self, components: list[object], xi: Decimal) -> Array:
        """A load per length at a place; a polynomial in xi is read as a function of t."""
        texts = (of.replace("xi", "t") if isinstance(of, str) else of for of in components)
        return np.array([self.value.at(of, xi) for of in texts], dtype=object)

    def _applied(self, t: Decimal, now: Array, J: Array) -> list[Array]:
        """Less the virtual work of forces and torques."""
        result, row, n = [], 0, J.shape[1]
        frames, by = now.reshape(-1, 12), J.reshape(-1, 12, n)
        for table in (of for of in self.scene.get("forces", {}).values() if "joint" not in of):
            force = np.array([self.value.at(f, t) for f in table["force"]], dtype=object)
            if table.get("frame", "inertial") == "body":
                force = self._body_axes(table["at"], frames[row]) @ force
            result += [-force[k] * by[row, k] for k in range(3)]
            row += 1
        for table in (of for of in self.scene.get("torques", {}).values() if "joint" not in of):
            torque = np.array([self.value.at(f, t) for f in table["torque"]], dtype=object)
            if table.get("frame", "inertial") == "body":
                torque = self._body_axes(table["on"], frames[row]) @ torque
            for sign in (1, -1) if "against" in table else (1,):
                turned = virtual_rotations(frames[row, 3:], by[row, 3:])
                result += [-sign * torque[k] * turned[k] for k in range(3)]
                row += 1
        for section, table in self.in_joints():
            load = self._body_axes(table["joint"], frames[row])[:, 2] * self.value.at(table["value"], t)
            for sign in (-1, 1):  # on the first marker, then on the second one
                moved = by[row, :3] if section == "forces" else virtual_rotations(frames[row, 3:], by[row, 3:])
                result += [-sign * load[k] * moved[k] for k in range(3)]
                row += 1
        return result

    def _body_axes(self, reference: str, frame: Array) -> Array:
        """The axes of the marker at which a force acts."""
        return frame[3:].reshape(3, 3)

    def _sprung(self, now: Array, rate: Array, J: Array) -> list[Array]:
        """Forces of springs and dampers along what they act along."""
        result = []
        for i, (stiffness, damping, rest) in enumerate(self.elements()):
            result += [stiffness * (now[i] - rest) * J[i], damping * rate[i] * J[i]]
        for i, K, C in self.couplings():
            own = slice(i, i + 6)
            for matrix, x in ((K, now[own]), (C, rate[own])):
                result += [(matrix[k] @ x) * J[i + k] for k in range(6)]
        return result

    def _energies(
        self,
        state: SpaceState,
        now: tuple[Array, ...],
        rate: list[Array],
        J: Array,
        truncated: Mapping[str, BodyInertia],
    ) -> dict[str, Decimal]:
        """The kinetic energy, the strain energy with that of springs, and the potential in gravity of what moves."""
        kinetic, strain, potential, start = ZERO, ZERO, ZERO, 0
        for name, body in self.bodies.items():
            own = slice(start, start + 3 * len(body.points))
            start += 3 * len(body.points)
            x, xdot = now[0][own].reshape(-1, 3), rate[0][own].reshape(-1, 3)
            if not np.any(J[own] != 0):  # a body that is fixed to the ground
                continue
            moving = sum((xdot[:, k] @ body.masses @ xdot[:, k] / 2 for k in range(3) if len(x)), ZERO)
            kinetic += truncated[name].kinetic if name in truncated else moving
            potential -= sum((self.gravity[k] * sum(body.masses @ x[:, k]) for k in range(3) if len(x)), ZERO)
            strain += body.strain(self.amplitudes(name, state)) if body.n else ZERO
        for x, (stiffness, _, rest) in zip(now[3], self.elements(), strict=True):
            strain += stiffness * (x - rest) ** 2 / 2
        strain += sum((now[3][i : i + 6] @ K @ now[3][i : i + 6] / 2 for i, K, _ in self.couplings()), ZERO)
        return {"kinetic": kinetic, "strain": strain, "gravity": potential}

    def _momenta(self, now: Array, rate: Array, truncated: Mapping[str, BodyInertia]) -> Array:
        """Linear momentum, and angular momentum about the inertial origin."""
        total, start = zeros(6), 0
        for body in self.bodies.values():
            count = len(body.points)
            own = slice(start, start + 3 * count)
            start += 3 * count
            x, p = now[own].reshape(-1, 3), body.masses @ rate[own].reshape(-1, 3) if count else zeros(0, 3)
            if body.name in truncated:
                total = total + truncated[body.name].momentum
                continue
            for a, b in zip(x, p, strict=True):
                total = total + np.concatenate([b, cross(a, b)])
        return total


def virtual_rotations(R: Array, dR: Array) -> Array:
    """The virtual rotations (3, n), inertial components, of a rotation R (9,) with the derivatives dR (9, n)."""
    W = np.einsum("ijn,kj->ikn", dR.reshape(3, 3, -1), R.reshape(3, 3))
    return np.array([(W[2, 1] - W[1, 2]) / 2, (W[0, 2] - W[2, 0]) / 2, (W[1, 0] - W[0, 1]) / 2], dtype=object)


def apart(found: Array, expected: Array, size: Array) -> float:
    """The largest difference, relative to the magnitudes of what is summed in each number."""
    size = floats(size)
    if not size.size:
        return 0.0
    return float(np.max(np.abs(np.asarray(found) - floats(expected)) / (size + 1e-15 * size.max() + 1e-300)))
