"""Random rigid and finite-element bodies and beams of scenes in space, with all kinds of markers and loads on nodes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from random_values import RandomValues

Arrays = dict[str, np.ndarray]


class RandomBodies(RandomValues):
    """The lines of the ground and of bodies, and the files of finite-element bodies."""

    def __init__(self, seed: int) -> None:
        super().__init__(seed)
        self.lines = [f'name = "space_{seed}"']
        self.markers: list[str] = []
        self.turning: set[str] = set()
        """The markers that have a rotation."""
        self.flexible_bodies: set[str] = set()
        self.kept: set[str] = set()
        """The rigid bodies that keep their coordinates."""
        self.files: dict[str, Arrays] = {}

    def marker(self) -> str:
        if self.chance(0.3):
            return self.quantities(self.vector())
        return f"{{ at = {self.quantities(self.vector())}, rotation = {self.rotation()} }}"

    def known(self, marker: str, turning: bool = True) -> None:
        self.markers.append(marker)
        if turning:
            self.turning.add(marker)

    def ground(self) -> None:
        self.lines.append("[ground.markers]")
        for k in range(2):
            self.lines.append(f"base{k} = {self.marker()}")
            self.known(f"ground.base{k}")

    def rigid(self, name: str, weightless: bool = False, keep: float = 0.3) -> None:
        """A rigid body whose inertia tensor is that of masses on three random lines and of a ball."""
        self.lines.append(f"[bodies.{name}]")
        if not weightless:
            arms = np.array([self.vector(0.6) for _ in range(3)])
            tensor = sum(((a @ a) * np.eye(3) - np.outer(a, a) for a in arms), 0.05 * np.eye(3))
            six = [float(f"{tensor[i, j]:.6g}") for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
            self.lines += [f"mass = {self.quantity(self.positive())}", f"inertia = {self.quantities(six)}"]
        if self.chance(0.7):
            self.lines.append(f"centre = {self.quantities(self.vector(0.3))}")
        if self.chance(keep):
            self.lines.append("keep_coordinates = true")
            self.kept.add(name)
        for marker in ("one", "two", "three"):
            self.lines.append(f"markers.{marker} = {self.marker()}")
            self.known(f"{name}.{marker}")

    # ---- finite-element bodies

    def flexible(self, name: str) -> None:
        """A body of nodes, with modes that hold rigid motion or not, and markers at nodes and on sets of nodes."""
        self.flexible_bodies.add(name)
        count = self.random.randint(6, 8)
        nodes = self.random.sample(range(count), 6)
        rigid_set = nodes[:3] if self.chance(0.5) else []
        order = self.random.choice([1, 2])
        given = self.random.randint(1, 3)
        self.files[f"{name}.npz"] = nodal_arrays(self.random.randrange(10**6), count, given, rigid_set, order == 2)
        self.lines += [f"[bodies.{name}]", f'nodes = "{name}.npz"', 'units = "SI"', "orthonormal = false"]
        if given > 1 and self.chance(0.3):
            self.lines.append(f"modes = {given - 1}")
        if order == 2 or self.chance(0.4):
            self.lines.append('frame = "given"')
        elif self.chance(0.5):
            self.lines.append('frame = "mean"')
        else:
            self.lines.append(f'frame = {{ kind = "point", node = {nodes[0]}, around = {nodes[1:5]} }}')
        if order == 1 or self.chance(0.5):
            self.lines.append(f"order = {order}")
        if self.chance(0.4):
            self.lines.append(f"damping = {{ mass = {self.positive(0, 0.2)}, stiffness = {self.positive(0, 0.01)} }}")
        elif self.chance(0.5):
            self.lines.append(f"damping = {{ ratio = {self.positive(0.01, 0.1)} }}")
        node = f"{{ node = {nodes[0]}, rotation = {self.rotation()} }}" if self.chance(0.5) else nodes[0]
        self.lines.append(f"markers.tip = {node}")
        self.known(f"{name}.tip", turning=False)
        face = f"nodes = {nodes[1:5]}, weights = {[self.positive(1, 3) for _ in range(4)]}"
        self.lines.append(f"markers.face = {{ {face}, rotation = {self.rotation()} }}")
        self.known(f"{name}.face")
        own = f'nodes = {rigid_set}, motion = "rigid"' if rigid_set else f'nodes = {nodes[3:]}, motion = "mean"'
        self.lines.append(f"markers.edge = {{ {own}, rotation = {self.rotation()} }}")
        self.known(f"{name}.edge")
        self.loads(count)

    def loads(self, count: int) -> None:
        """Loads on nodes of the last body."""
        nodes = self.random.sample(range(count), 3)
        forces = [self.vector(2) for _ in nodes]
        frame = ', frame = "inertial"' if self.chance(0.3) else ""
        self.lines.append(f"loads.wind = {{ nodes = {nodes}, forces = {forces}, time = {self.function()}{frame} }}")
        if self.chance(0.5):
            forces = f"forces = [{self.vector(2)}]"
            self.lines.append(f'loads.jet = {{ nodes = {nodes[:2]}, {forces}, frame = "body" }}')

    # ---- beams

    def beam(self, name: str) -> None:
        """A beam of few shapes in any frame, with markers whose frames are rotated or not."""
        self.flexible_bodies.add(name)
        order = self.random.choice([1, 2, 2])
        self.lines.append(f"[bodies.{name}]")
        sizes = {"length": (0.5, 2), "mass": (0.2, 2), "bending_stiffness": (5, 50), "rotary_inertia": (0.01, 0.1)}
        for key, (low, high) in sizes.items():
            self.lines.append(f"{key} = {self.quantity(self.positive(low, high), 0.2)}")
        if order == 2 or self.chance(0.3):
            self.lines.append(f"order = {order}")
        ansatz = self.bending()
        lateral = [f"ansatz = {ansatz}"] if ansatz and self.chance(0.4) else []
        if self.chance(0.6):
            lateral.append(f"bending_stiffness = {self.quantity(self.positive(5, 50), 0.3)}")
        if lateral:
            self.lines.append(f"lateral = {{ {', '.join(lateral)} }}")
        if self.chance(0.6):
            shapes = self.random.choice([["xi"], ["xi^2"], ["xi", "xi^2"], ["1", "xi"]])
            stiffness = self.quantity(self.positive(5, 50), 0.3)
            self.lines.append(f"torsion = {{ ansatz = {shapes}, stiffness = {stiffness} }}")
        if self.chance(0.5):
            preload = f", preload = {self.quantity(self.number(5), 0.4)}" if order == 2 and self.chance(0.6) else ""
            shapes, stiffness = self.random.choice([["xi"], ["xi^2"]]), self.quantity(self.positive(50, 200), 0.4)
            self.lines.append(f"axial = {{ ansatz = {shapes}, stiffness = {stiffness}{preload} }}")
        if self.chance(0.6):
            self.lines.append(f"centre = {self.quantities([self.number(0.1), self.number(0.1)], 0.2)}")
        if self.chance(0.4):
            factors = [self.quantity(self.positive(0.01, 0.2), 0.3) for _ in range(2)]
            self.lines.append(f"damping = {{ mass = {factors[0]}, stiffness = {factors[1]} }}")
        elif self.chance(0.5):
            self.lines.append(f"damping = {{ ratio = {self.quantity(self.positive(0.01, 0.1), 0.4)} }}")
        if self.chance(0.4):
            self.lines += [f"masses.bob.at = {self.random.choice(['1', '-0.5'])}"]
            self.lines += [f"masses.bob.mass = {self.quantity(self.positive(0.1, 0.5), 0.3)}"]
            if self.chance(0.6):
                tensor = [0.02, 0.03, 0.025, *(0.1 * self.number(0.02) for _ in range(3))]
                self.lines += [f"masses.bob.inertia = {self.quantities(tensor, 0.2)}"]
            if self.chance(0.6):
                self.lines += [f"masses.bob.centre = {self.quantities([self.number(0.1) for _ in range(3)], 0.2)}"]
        if self.chance(0.4):
            self.lines += [
                f'loads.wind.force = [{self.number(2)}, "{self.number(3)}*(1 - xi^2)", "{self.number(3)}*xi"]'
            ]
            if self.chance(0.6):
                self.lines.append(f"loads.wind.time = {self.input() if self.chance(0.2) else self.function()}")
            if self.chance(0.7):
                self.lines += [f'loads.wind.frame = "{self.random.choice(["inertial", "body"])}"']
        for marker, at in (("left", -1), ("middle", self.random.choice(["0", '"1/3"', "0.5"])), ("right", 1)):
            turned = f"{{ at = {at}, rotation = {self.rotation()} }}"
            self.lines.append(f"markers.{marker} = {turned if self.chance(0.7) else at}")
            self.known(f"{name}.{marker}")

    def bending(self) -> str:
        """Write the frame and the shapes of the deflection of a beam; another ansatz for the other plane, if any."""
        form = self.random.choice(["family", "ends", "given", "polynomials", "polynomials", "even"])
        if form == "family":
            kind = self.random.choice(["pinned", "free-free", "clamped-free"])
            self.lines.append(f'ansatz = {{ kind = "{kind}", count = {self.random.randint(1, 2)} }}')
            return f'{{ kind = "{kind}", count = 1 }}'
        if form == "given":
            self.lines += ['frame = "given"', 'ansatz = ["xi^2 - 1/3", "xi^3 - 3/5*xi"]']
            return '["xi^2 - 1/3"]'
        if form == "ends":
            ends, frame = self.random.choice([("pinned", "chord"), ("pinned", "mean"), ("free", "mean")])
            powers = ["1", "xi", *(f"xi^{n}" for n in range(2, 7 if ends == "free" else 6))]
            self.lines += [f'frame = "{frame}"', f'ends = "{ends}"', f"ansatz = {powers}"]
            return ""
        frames = ['"mean"', '"chord"', '"point"', '{ kind = "point", at = "1/3" }']
        frames += ['{ kind = "tangent", at = -1 }', '{ kind = "tangent", at = 1 }']
        if self.chance(0.8):
            self.lines.append(f"frame = {self.random.choice(frames)}")
        if self.chance(0.4):
            self.lines.append(f"orthogonal = {str(self.chance(0.5)).lower()}")
        if form == "even":
            self.lines.append('ansatz = ["1", "xi", "xi^2", "xi^4"]')
        return '["1", "xi", "xi^3"]'

    def write_files(self, folder: Path) -> None:
        """The files of finite-element bodies."""
        for name, arrays in self.files.items():
            np.savez(folder / name, **arrays)


def nodal_arrays(seed: int, count: int, modes: int, rigid_set: list[int], order2: bool) -> Arrays:
    """The arrays of a random body; rigid_set: nodes that every mode moves as a rigid body.

    order2: whether there are geometric stiffness matrices, those of random displacements of second order.
    """
    rng = np.random.default_rng(seed)
    x, half = rng.uniform(-1, 1, (count, 3)), rng.uniform(-1, 1, (modes, modes))
    phi, psi = rng.uniform(-0.5, 0.5, (modes, count, 3)), rng.uniform(-0.7, 0.7, (modes, modes, count, 3))
    if rigid_set:
        levers = x[rigid_set] - x[rigid_set[0]]
        turns = rng.uniform(-0.5, 0.5, (modes, 1, 3))
        phi[:, rigid_set] = phi[:, rigid_set[:1]] + np.cross(turns, levers[None])
    psi = (psi + np.swapaxes(psi, 0, 1)) / 2
    arrays: Arrays = {"positions": x, "modes": phi, "modal_stiffness": half @ half.T * 20 + np.eye(modes)}
    root = rng.uniform(-1, 1, (count, count))
    mass = np.diag(rng.uniform(0.1, 0.5, count)) + (0.02 * root @ root.T if rng.random() < 0.4 else 0.0)
    if np.count_nonzero(mass) == count:
        arrays["mass"] = np.diag(mass)
    else:
        rows, columns = np.nonzero(mass)
        arrays |= {"mass_row": rows, "mass_col": columns, "mass_value": mass[rows, columns]}
    if order2:
        arrays |= geometric_stiffness(x, mass, psi)
    return arrays


def geometric_stiffness(x: np.ndarray, mass: np.ndarray, psi: np.ndarray) -> Arrays:
    """K0t, K0r, K0omega and K0F of displacements Psi (modes, modes, nodes, 3): the work of unit loads on them."""
    axes = np.eye(3)

    def centrifugal(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return np.cross(a, np.cross(b, x))

    squares = [centrifugal(a, a) for a in axes]
    pairs = [(axes[i], axes[j]) for i, j in ((0, 1), (1, 2), (0, 2))]
    fields = squares + [centrifugal(a, b) + centrifugal(b, a) for a, b in pairs]

    def work(loads: list[np.ndarray]) -> np.ndarray:
        return np.array([np.einsum("ijak,ab,bk->ij", psi, mass, np.broadcast_to(f, x.shape)) for f in loads])

    return {
        "K0t": work([*axes]),
        "K0r": work([np.cross(axis, x) for axis in axes]),
        "K0omega": work(fields),
        "K0F": -np.moveaxis(psi, (0, 1), (2, 3)),
        "K0F_nodes": np.arange(len(x)),
    }
