"""The TOML of a part: a body alone, or a scene that holds it at the first set of its interface."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from derive.errors import printable
from derive.reduction.body import ZERO_STIFFNESS, prepare
from derive.reduction.frames import centre_of_mass
from derive.reduction.integrals import mass_products
from derive.reduction.marker_motion import marker_motion
from derive.spec.model.body import NodalBody
from derive.spec.parsing.names import free_name


@dataclass(frozen=True)
class FileUnits:
    """The names of the units of a file."""

    length: str = "m"
    mass: str = "kg"
    time: str = "s"

    @property
    def are_si(self) -> bool:
        """Whether these are m, kg and s."""
        return self == FileUnits()

    def table(self) -> str | dict[str, str]:
        """The value of the key `units`."""
        return "SI" if self.are_si else {"length": self.length, "mass": self.mass, "time": self.time}

    def __str__(self) -> str:
        rows = ", ".join(f'{key} = "{unit}"' for key, unit in vars(self).items())
        return '"SI"' if self.are_si else f"{{ {rows} }}"


SI = FileUnits()


@dataclass(frozen=True)
class BodyTable:
    """The parts of the text; `mesh` is that of the part in words."""

    name: str
    source: str
    nodes_file: str
    body: NodalBody
    interface: tuple[str, ...]
    component_modes: str | None
    units: FileUnits
    mesh: str


LARGEST_DISPLACEMENT = 0.01
"""The largest displacement at which a body alone starts, as a part of its length."""

PERIODS, ROWS = 5, 200
"""The duration of its simulation in periods of the first mode, and the rows of the output."""


def body_text(table: BodyTable) -> str:
    """The specification of a body alone, whose simulation is the vibration of its first mode."""
    return "\n".join([*_head(table), "[body]", *_keys(table, table.interface), "", *_vibration(table.body)])


def _vibration(body: NodalBody) -> Iterator[str]:
    """The start with an amplitude of the first mode, and the simulation of a few periods of it."""
    shapes = prepare(body).shapes
    squares = np.diag(shapes.stiffness)
    if not len(squares) or not squares[0] > ZERO_STIFFNESS * squares.max():
        return
    c8 = float(mass_products(prepare(body).mass, shapes.phi[:1], shapes.phi[:1])[0, 0])
    period = 2 * np.pi * (c8 / squares[0]) ** 0.5
    size = np.ptp(body.data.positions, axis=0).max() / np.linalg.norm(shapes.phi[0], axis=1).max()
    yield "[body.start]"
    yield f"amplitudes = [{LARGEST_DISPLACEMENT * size:.3g}]  # of the first mode, whose period is {period:.4g} s"
    yield ""
    yield "[simulation]"
    yield f"duration = {PERIODS * period:.3g}"
    yield f"output = {PERIODS * period / ROWS:.3g}"
    yield ""


def scene_text(table: BodyTable) -> str:
    """The specification of a scene in which the first set is fixed to the ground and gravity acts."""
    names: dict[str, str] = {}
    for name in table.interface:
        names[name] = free_name(name, {*names.values(), "frame", "centre"})
    held, *_ = names.values()
    data, inertial = table.body.data, centre_of_mass(table.body.data.mass, table.body.data.positions)
    nodes = {marker.name: marker.nodes for marker in table.body.interface_markers}
    shown = dict.fromkeys((table.interface[0], table.interface[-1]))
    of_name = {marker.name: marker for marker in table.body.interface_markers}
    means = {names[name]: marker_motion(table.body, of_name[name], data.positions).centre for name in shown}
    places = [f"{own} = {_vector(mean)}  # the mean of this set" for own, mean in means.items()]
    markers = [
        f"{own} = {{ set = {_text(name)} }}" if len(nodes[name]) > 1 else f"{own} = {nodes[name][0]}"
        for name, own in names.items()
    ]
    lines = [
        *_head(table),
        *("[scene]", "gravity = [0, 0, -9.81]", ""),
        *("[ground.markers]", *places, ""),
        *(f"[bodies.{table.name}]", *_keys(table, tuple(names.values()))),
        "damping = { ratio = 0.01 }  # of critical damping, in each mode of the free body; less when it is held",
        f"start = {{ guess = true, position = {_vector(inertial)} }}  # the centre of mass",
        *("", f"[bodies.{table.name}.markers]  # means over the areas of these sets, or of their nodes", *markers, ""),
        *(f"[joints.{held}]", 'kind = "fixed"', f'between = ["ground.{held}", "{table.name}.{held}"]', ""),
        *_plot(table.name, list(names.values())),
        *("[simulation]", "duration = 0.1", "output = 1e-3", ""),
    ]
    return "\n".join(lines)


def _plot(body: str, markers: list[str]) -> Iterator[str]:
    """The displacement of the last set, which `study accuracy` compares, if that is not the one that is held."""
    *held, last = markers
    if held:
        yield f"[outputs.{last}]  # the displacement from its place in the undeformed part"
        yield from ('kind = "position"', f'marker = "{body}.{last}"', f'frame = "ground.{last}"', "")
        yield from (f"[plots.{last}]", f'y = ["{last}_1", "{last}_2", "{last}_3"]', "")


def _head(table: BodyTable) -> Iterator[str]:
    yield f"# {table.mesh}, imported from {printable(table.source)}."
    yield f'name = "{table.name}"'
    yield ""


def _keys(table: BodyTable, interface: tuple[str, ...]) -> Iterator[str]:
    yield f"nodes = {_text(table.nodes_file)}  # positions, mass, stiffness, sets of nodes, elements"
    yield f"units = {table.units}"
    if table.body.modes is not None:
        wish = table.body.modes
        error = "" if isinstance(wish, int) else f"{{ error = {wish.error:g}, up_to = {wish.up_to:g} }}"
        yield f"modes = {error or wish}"
    if table.component_modes:
        yield f'component_modes = "{table.component_modes}"'
    if interface:
        yield f"interface = [{', '.join(map(_text, interface))}]"
    if table.body.second_order:
        yield "order = 2  # stresses of its loads stiffen it or soften it"
    if table.body.data.has_stresses:
        yield "stress = true  # simulations record its largest stress"


def _text(value: str) -> str:
    """A basic string of TOML."""
    escaped = value.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def _vector(values: np.ndarray) -> str:
    return f"[{', '.join(f'{value:.9g}' for value in values + 0.0)}]"
