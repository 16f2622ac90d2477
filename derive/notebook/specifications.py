"""The HTML of specifications: scenes with their drawing and tables of their members, beams, bodies of nodes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from derive.notebook.parts import Writers, folded, head, joined, picture, table
from derive.short_text import changed_fields, counted, listed, short_text
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.body import NodalBody, SymbolicBody
from derive.spec.model.keys import declared_keys
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.quantity import Parameter
from derive.spec.model.scene import NAMED, Scene
from derive.spec.model.spatial_beam import SpatialBeam
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.spec_text import body_kind, quantity_text, shapes_text, simulation_text
from derive.spec.model.time_function import TimeFunction
from derive.spec.parsing.time_text import function_text
from derive.visual.mechanism import mechanism_picture
from derive.visual.spatial_scene_picture import undeformed_picture

ACTIONS = ("drives", "gears", "forces", "torques", "springs", "inputs", "outputs", "plots")
"""The sections of a scene after its bodies and joints."""

KINDS = {PlanarBeam: "planar beam", NodalBody: "body of nodes", SymbolicBody: "body with symbolic integrals"}
"""The bodies that are specified alone, in words."""
KEYS = {
    PlanarBeam: declared_keys(PlanarBeam),
    NodalBody: declared_keys(NodalBody),
    SymbolicBody: declared_keys(SymbolicBody),
}
"""The keys of these bodies."""


def scene_html(scene: Scene | SpatialScene) -> str:
    """A scene: its drawing, its bodies, its joints, and what acts in it."""
    planar = isinstance(scene, Scene)
    drawn = mechanism_picture(scene) if isinstance(scene, Scene) else undeformed_picture(scene)
    bodies = [(body.name, body_kind(body), _body(body), _names(body.markers)) for body in scene.bodies]
    joints = [(joint.name, joint.kind, joint.first, joint.second) for joint in scene.joints]
    actions = [
        (element.name, NAMED[section], _element(element))
        for section in ACTIONS
        for element in getattr(scene, section, ())
    ]
    size = f"{counted(len(scene.bodies), 'body', 'bodies')}, {counted(len(scene.joints), 'joint')}"
    gravity = f", gravity ({', '.join(quantity_text(g, 'm/s^2') for g in scene.gravity)})" if scene.gravity else ""
    return joined(
        head(scene.name, f"{'planar scene' if planar else 'scene in space'} of {size}{gravity}"),
        picture(drawn, f"The mechanism {scene.name} at t = 0") if scene.bodies else "",
        table(("body", "kind", "constants", "markers"), bodies, left=4),
        table(("joint", "kind", "marker 1", "marker 2"), joints, left=4),
        table(("element", "kind", "values"), actions, left=3),
        table(("simulation",), [(simulation_text(scene.simulation),)]) if scene.simulation else "",
    )


def _names(markers: tuple[Any, ...]) -> str:
    return listed((marker.name for marker in markers), 60)


def _body(body: Any) -> str:
    """The constants of a body in a few words."""
    if isinstance(body, BeamBody):
        beam = body.beam
        mass, length = quantity_text(beam.mass, "kg"), quantity_text(beam.length, "m")
        return f"{mass}, {length}, bending stiffness {quantity_text(beam.bending_stiffness, 'N m^2')}"
    if isinstance(body, SpatialBeam):
        both = " and ".join(quantity_text(x, "N m^2") for x in dict.fromkeys(body.bending_stiffnesses))
        return f"{quantity_text(body.mass, 'kg')}, {quantity_text(body.length, 'm')}, bending stiffness {both}"
    if isinstance(body, FlexibleBody):
        return f"{counted(len(body.body.data.positions), 'node')}, {body.body.frame.kind} frame"
    constant = getattr(body, "mass", None)
    return "" if constant is None else quantity_text(constant, "kg")


def _element(element: Any) -> str:
    """The keys of an element that differ from their defaults, with their values."""
    shown = ((name, value) for name, value in changed_fields(element) if name != "name" and value is not None)
    return ", ".join(f"{name} {_value(value)}" for name, value in shown)


def _value(value: Any) -> str:
    """A value as a specification has it."""
    if isinstance(value, TimeFunction):
        return function_text(value)
    if isinstance(value, tuple) and any(isinstance(part, TimeFunction) for part in value):
        return f"[{', '.join(map(_value, value))}]"
    return value if isinstance(value, str) else short_text(value)


def body_html(body: PlanarBeam | NodalBody | SymbolicBody) -> str:
    """A body alone: the keys of its specification with their values and meanings."""
    return joined(
        head(body.name, KINDS[type(body)]),
        table(("key", "value"), list(_values(body)), left=2),
        folded("Meaning of the keys", table(("key", "meaning"), list(_meanings(body)), left=2, most=99)),
    )


def _values(body: Any) -> Iterator[tuple[str, str]]:
    """The keys of a body with values, in the words of the specification."""
    changed = dict(changed_fields(body))
    for key in KEYS[type(body)]:
        value = changed.get(key.field)
        if value is None or key.field != key.name:
            continue
        if key.name == "ansatz":
            yield key.name, shapes_text(value)
        else:
            has_unit = key.unit and not isinstance(value, Parameter)
            yield key.name, f"{short_text(value)} {key.unit}" if has_unit else short_text(value)


def _meanings(body: Any) -> Iterator[tuple[str, str]]:
    for key in KEYS[type(body)]:
        if key.description:
            yield key.name, key.description


WRITERS: Writers = {
    Scene: scene_html,
    SpatialScene: scene_html,
    PlanarBeam: body_html,
    NodalBody: body_html,
    SymbolicBody: body_html,
}
