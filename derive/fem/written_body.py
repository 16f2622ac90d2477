"""The TOML of a part: a body alone, or a scene that holds it at the first set of its interface."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from derive.errors import printable
from derive.fem.model import Array
from derive.reduction.body import ZERO_STIFFNESS, prepare
from derive.reduction.integrals import mass_products
from derive.reduction.marker_motion import marker_motion
from derive.reduction.properties import body_properties
from derive.spec.model.body import NodalBody
from derive.spec.model.node_data import NodeData
from derive.spec.model.node_markers import InterfaceMarker
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
    """The parts of the text. markers: the sets that joints hold, which are the interface if the body has one. mesh:
    that of the part in words."""

    name: str
    source: str
    nodes_file: str
    body: NodalBody
    markers: tuple[InterfaceMarker, ...]
    component_modes: str | None
    units: FileUnits
    mesh: str


LARGEST_DISPLACEMENT = 0.01
"""The largest displacement at which a body alone starts, as a part of its length."""

ROUNDING = 1e-14

PERIODS, ROWS = 5, 200
"""The duration of its simulation in periods of the first mode, and the rows of the output."""


def body_text(table: BodyTable) -> str:
    """The specification of a body alone, whose simulation is the vibration of its first mode."""
    body = table.body
    return "\n".join([*_head(table), "[body]", *_keys(table, body.interface), *_points(table), "", *_vibration(body)])


def _vibration(body: NodalBody) -> Iterator[str]:
    """The start with an amplitude of the first mode, and the simulation of a few periods of it."""
    shapes = prepare(body).shapes
    squares = np.diag(shapes.stiffness)
    if not len(squares) or not squares[0] > ZERO_STIFFNESS * squares.max():
        return
    c8 = float(mass_products(prepare(body).mass, shapes.phi[:1], shapes.phi[:1])[0, 0])
    period = 2 * np.pi * (c8 / squares[0]) ** 0.5
    size = np.ptp(shapes.x, axis=0).max() / np.linalg.norm(shapes.phi[0], axis=1).max()
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
    for name in (marker.name for marker in table.markers):
        names[name] = free_name(name, {*names.values(), "frame", "centre"})
    held, *_ = names.values()
    data, centre = table.body.data, body_properties(table.body).centre
    nodes = {marker.name: marker.nodes for marker in table.markers}
    shown = {marker.name: marker for marker in (table.markers[0], table.markers[-1])}
    means = {names[name]: marker_motion(table.body, of, data.positions).centre for name, of in shown.items()}
    places = [f"{own} = {_vector(mean)}  # the mean of this set" for own, mean in means.items()]
    markers = [
        f"{own} = {{ set = {_text(name)} }}" if len(nodes[name]) > 1 else f"{own} = {nodes[name][0]}"
        for name, own in names.items()
    ]
    given = table.body.frame.kind == "given"
    origin, where = (np.zeros(3), "the origin of the file") if given else (centre, "the centre of mass")
    lines = [
        *_head(table),
        *("[scene]", "gravity = [0, 0, -9.81]", ""),
        *("[ground.markers]", *places, ""),
        *(f"[bodies.{table.name}]", *_keys(table, tuple(names.values()) if table.body.interface else ())),
        *_damped(data),
        f"start = {{ guess = true, position = {_vector(origin)} }}  # {where}",
        *("", f"[bodies.{table.name}.markers]  # means over the areas of these sets, or of their nodes", *markers, ""),
        *(f"[joints.{held}]", 'kind = "fixed"', f'between = ["ground.{held}", "{table.name}.{held}"]', ""),
        *_plot(table.name, list(names.values())),
        *("[simulation]", "duration = 0.1", "output = 1e-3", ""),
    ]
    return "\n".join(lines)


def _damped(data: NodeData) -> Iterator[str]:
    """The usual damping of a part whose file has none."""
    if data.moments is None:
        yield "damping = { ratio = 0.01 }  # of critical damping, in each mode of the free body; less when it is held"


def _points(table: BodyTable) -> Iterator[str]:
    """The markers of a body alone."""
    if table.body.markers:
        yield from ("", "[body.markers]")
        yield from (f"{marker.name} = {marker.node}" for marker in table.body.markers)


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
    contents = "positions, mass, stiffness, sets of nodes, elements"
    if table.body.data.moments is not None:
        contents = "frames, their modes and stiffness, moments of the mass"
    yield f"nodes = {_text(table.nodes_file)}  # {contents}"
    yield f"units = {table.units}"
    if table.body.modes is not None:
        wish = table.body.modes
        error = "" if isinstance(wish, int) else f"{{ error = {wish.error:g}, up_to = {wish.up_to:g} }}"
        yield f"modes = {error or wish}"
    if table.body.frame.kind == "given":
        yield from ('frame = "given"  # that of the file', "orthonormal = false")
    if damping := [f"{name} = {float(x)!r}" for name, x in vars(table.body.damping).items() if x]:
        yield f"damping = {{ {', '.join(damping)} }}"
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


def _vector(values: Array) -> str:
    """The components of a vector, without those that are rounding errors of zero."""
    size = float(np.abs(values).max(initial=0.0))
    return f"[{', '.join(f'{x:.12g}' for x in np.where(np.abs(values) > ROUNDING * size, values, 0.0))}]"
