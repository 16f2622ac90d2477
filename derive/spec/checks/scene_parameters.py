"""The parameters of a scene, of which all with the same symbol have to be the same parameter."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from derive.errors import quoted
from derive.mechanics.multibody.bodies.registry import BODIES
from derive.mechanics.multibody.forces.registry import DEFAULT_KINDS, kinds
from derive.mechanics.multibody.joints.registry import JOINTS
from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS
from derive.mechanics.multibody.space.springs import SPATIAL_BUSHINGS, bushing_unit
from derive.registry import Registry
from derive.spec.checks.name_clashes import taken_names
from derive.spec.checks.scene_data import SceneData
from derive.spec.model.beam import BEAM_QUANTITIES
from derive.spec.model.beam_parts import DEFAULT_LENGTH, INERTIA_UNIT, AttachedMass, AxialDeformation, BeamDamping
from derive.spec.model.body import ACCELERATION_UNIT
from derive.spec.model.keys import Key, declared_keys, quantities
from derive.spec.model.markers import GROUND
from derive.spec.model.planar_bodies import RigidBody
from derive.spec.model.scene import NAMED
from derive.spec.model.spatial_beam_parts import LateralDeflection, SpatialAttachedMass, TorsionalDeformation
from derive.spec.model.spatial_scene import Gear
from derive.spec.parsing import values
from derive.spec.parsing.faults import Fault, KeyPath, readable
from derive.spec.parsing.names import name_problem
from derive.spec.tables.scene_elements import speed_unit


class SceneConstant(NamedTuple):
    """A constant of a scene: its path, its value, its description, and the default unit of a parameter."""

    path: KeyPath
    value: object
    what: str
    unit: str | None
    given: bool = True


def parameter_faults(view: SceneData) -> Iterator[Fault]:
    """Faults of symbols that are taken, and of symbols that name two different parameters."""
    taken = taken_names(view)
    model = view.data.get("name")
    if isinstance(model, str):
        taken[model.lower()] = "it is the name of the model"
    first: dict[str, SceneConstant] = {}
    # Default symbols come first, so that a fault is reported where something was written.
    for constant in (*_implied_constants(view), *scene_constants(view)):
        symbol = _symbol(constant.value)
        if symbol is None:
            continue
        path = (*constant.path, "symbol") if constant.given else constant.path
        if symbol.lower() in taken:
            yield Fault(path, f"{quoted(symbol)} is taken: {taken[symbol.lower()]}; choose another symbol")
            continue
        other = first.setdefault(symbol.lower(), constant)
        if _symbol(other.value) != symbol:
            text = f"{quoted(symbol)} is taken: {quoted(str(_symbol(other.value)))} is the symbol of {other.what}"
            yield Fault(path, f"{text}; names must differ in more than case")
        elif differs := _difference(constant, other):
            text = f"{quoted(symbol)} is the symbol of {other.what}, {differs}"
            yield Fault(path, f"{text}; one symbol is one parameter: write both alike, or choose another symbol")


def _difference(constant: SceneConstant, other: SceneConstant) -> str | None:
    """The difference between two parameters with one symbol; None if they agree, or if one is unreadable."""
    for noun, own, others in (
        ("unit", _unit(constant), _unit(other)),
        ("default", _default(constant), _default(other)),
    ):
        if None not in (own, others) and own != others:
            return f"with the {noun} {others}, not {own}"
    return None


def _symbol(value: object) -> str | None:
    symbol = value.get("symbol") if isinstance(value, Mapping) else None
    return symbol if isinstance(symbol, str) and not name_problem(symbol) else None


def _unit(constant: SceneConstant) -> str | None:
    assert isinstance(constant.value, Mapping)
    return readable(values.unit, constant.value["unit"]) if "unit" in constant.value else constant.unit


def _default(constant: SceneConstant) -> float | None:
    assert isinstance(constant.value, Mapping)
    if "default" in constant.value:
        return readable(values.any_float, constant.value["default"])
    return 1.0  # of masses and the like; where a default is required, another check reports it


def _implied_constants(view: SceneData) -> Iterator[SceneConstant]:
    for name, body in view.bodies.items():
        for key, like in BEAM_QUANTITIES.items() if view.is_beam(name) else ():
            if key not in body:
                what = f"{key} of the body {name} if none is given"
                yield SceneConstant(("bodies", name, key), {"symbol": like.symbol}, what, like.unit, given=False)


def scene_constants(view: SceneData) -> Iterator[SceneConstant]:
    """All constants of a scene that may be parameters."""
    scene = view.data.get("scene")
    if isinstance(scene, Mapping):
        yield from _components(("scene", "gravity"), scene.get("gravity"), "gravity", ACCELERATION_UNIT)
    for name, body in view.bodies.items():
        of = f"of the body {name}"
        if view.is_beam(name):
            yield from beam_constants(("bodies", name), body, f" {of}", view.in_space)
            continue
        kind = view.kind(name)
        if kind == "flexible":
            continue
        for key, unit in _units(declared_keys(RigidBody) if kind == "rigid" else BODIES[kind].keys).items():
            yield SceneConstant(("bodies", name, key), body.get(key), f"{key} {of}", unit)
        yield from _components(("bodies", name, "centre"), body.get("centre"), f"the centre {of}", DEFAULT_LENGTH.unit)
        yield from _components(("bodies", name, "inertia"), body.get("inertia"), f"the inertia {of}", INERTIA_UNIT)
        yield from _markers(("bodies", name, "markers"), body.get("markers"), of)
    ground = view.data.get(GROUND)
    if isinstance(ground, Mapping):
        yield from _markers((GROUND, "markers"), ground.get("markers"), "of the ground")
    types: Registry[Any] = SPATIAL_JOINTS if view.in_space else JOINTS
    for name, joint in view.tables["joints"].items():
        joint_type = types.get(str(joint.get("kind")))
        for key, unit in _units(joint_type.keys if joint_type else ()).items():
            yield SceneConstant(("joints", name, key), joint.get(key), f"{key} of the joint {name}", unit)
    for name, drive in view.tables["drives"].items():
        joint = view.tables["joints"].get(str(drive.get("joint")), {})
        of_speed = speed_unit(types.get(str(joint.get("kind"))))
        yield SceneConstant(("drives", name, "speed"), drive.get("speed"), f"the speed of the drive {name}", of_speed)
    for name, gear in view.tables["gears"].items():
        for key in _units(declared_keys(Gear)):
            yield SceneConstant(("gears", name, key), gear.get(key), f"{key} of the gear {name}", "")
    for section, default in DEFAULT_KINDS.items():
        for name, table in view.tables[section].items():
            kind = str(table.get("kind", default))
            bushing = view.in_space and section == "springs" and kind in SPATIAL_BUSHINGS
            yield from _of_bushing(name, table, kind) if bushing else _force(section, name, table, kind)
    yield from _of_functions(view)


def beam_constants(
    path: KeyPath, beam: Mapping[str, object], of: str = "", in_space: bool = False
) -> Iterator[SceneConstant]:
    """All constants of a beam that may be parameters; `of` is added to their descriptions in messages."""
    for key, like in BEAM_QUANTITIES.items():
        yield SceneConstant((*path, key), beam.get(key), f"{key}{of}", like.unit)
    if in_space:
        key = "rotary_inertia"
        yield SceneConstant((*path, key), beam.get(key), f"{key}{of}", INERTIA_UNIT)
        yield from _components((*path, "centre"), beam.get("centre"), f"the centre{of}", DEFAULT_LENGTH.unit)
    for part, (keys, what) in PARTS.items():
        table = beam.get(part)
        if isinstance(table, Mapping):
            for key, unit in _units(keys).items():
                yield SceneConstant((*path, part, key), table.get(key), f"{what.format(key)}{of}", unit)
    masses = beam.get("masses")
    for name, mass in masses.items() if isinstance(masses, Mapping) else ():
        if isinstance(mass, Mapping):
            own, of_mass = (*path, "masses", str(name)), f"of the attached mass {name}{of}"
            for key, unit in _units(declared_keys(SpatialAttachedMass if in_space else AttachedMass)).items():
                yield SceneConstant((*own, key), mass.get(key), f"{key} {of_mass}", unit)
            if in_space:
                yield from _components((*own, "inertia"), mass.get("inertia"), f"the inertia {of_mass}", INERTIA_UNIT)
                centre = mass.get("centre")
                yield from _components((*own, "centre"), centre, f"the centre {of_mass}", DEFAULT_LENGTH.unit)


PARTS = {
    "axial": (declared_keys(AxialDeformation), "axial {}"),
    "lateral": (declared_keys(LateralDeflection), "lateral {}"),
    "torsion": (declared_keys(TorsionalDeformation), "torsion {}"),
    "damping": (declared_keys(BeamDamping), "{} in the damping"),
}
"""The tables of a beam with constants: their keys, and what these are called."""


def _of_functions(view: SceneData) -> Iterator[SceneConstant]:
    parameters = view.data.get("parameters")
    for name, table in parameters.items() if isinstance(parameters, Mapping) else ():
        if isinstance(table, Mapping):
            value = {**table, "symbol": str(name)}
            yield SceneConstant(("parameters", str(name)), value, f"the parameter {name}", None, given=False)


def _units(keys: tuple[Key, ...]) -> dict[str, str]:
    """The keys that may be parameters, with their units."""
    return {name: key.unit for name, key in quantities(keys).items()}


def _force(section: str, name: str, table: Mapping[str, object], kind: str) -> Iterator[SceneConstant]:
    """The constants of a force; constants that its kind does not have, or of an unknown kind, have no unit."""
    types = kinds(section)
    units = _units(types[kind].keys) if kind in types else {}
    for key in dict.fromkeys(key for force_type in types.values() for key in quantities(force_type.keys)):
        what = f"{key} of the {NAMED[section]} {name}"
        yield SceneConstant((section, name, key), table.get(key), what, units.get(key))


def _of_bushing(name: str, table: Mapping[str, object], kind: str) -> Iterator[SceneConstant]:
    """The constants in the six numbers, or in the matrices, of a bushing in space."""
    for key in (key.name for key in SPATIAL_BUSHINGS[kind].keys):
        rows = table.get(key)
        for i, row in enumerate(rows[:6] if isinstance(rows, (list, tuple)) else ()):
            path: KeyPath = ("springs", name, key, i)
            several = isinstance(row, (list, tuple))
            for j, entry in enumerate(row[:6]) if several else ((i, row),):
                own: KeyPath = (*path, j) if several else path
                yield SceneConstant(own, entry, f"{key} of the spring {name}", bushing_unit(key, i, j))


def _components(path: KeyPath, value: object, what: str, unit: str) -> Iterator[SceneConstant]:
    for i, component in enumerate(value[:6] if isinstance(value, (list, tuple)) else ()):
        yield SceneConstant((*path, i), component, f"component {i + 1} of {what}", unit)


def _markers(path: KeyPath, markers: object, of: str) -> Iterator[SceneConstant]:
    for name, at in markers.items() if isinstance(markers, Mapping) else ():
        if isinstance(at, Mapping):
            what = f"the marker {name} {of}"
            yield from _components((*path, str(name), "at"), at.get("at"), what, DEFAULT_LENGTH.unit)
        yield from _components((*path, str(name)), at, f"the marker {name} {of}", DEFAULT_LENGTH.unit)
