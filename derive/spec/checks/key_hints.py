"""Information on the keys of a scene for messages: the table at each path, and examples of missing keys."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial

from pydantic import BaseModel

from derive.mechanics.multibody.bodies.registry import BODIES
from derive.mechanics.multibody.forces.registry import DEFAULT_KINDS, kinds
from derive.mechanics.multibody.joints.registry import JOINTS
from derive.mechanics.multibody.keys import quantities
from derive.spec.model.body import BEAM_QUANTITIES
from derive.spec.parsing.faults import KeyPath, similar_key
from derive.spec.tables.beam_parts import AXIAL_UNITS, MASS_UNITS, AttachedMassTable, AxialTable
from derive.spec.tables.beam_shapes import FrameTable
from derive.spec.tables.damping import DAMPING_UNITS, BeamDampingTable
from derive.spec.tables.drives import DriveTable
from derive.spec.tables.forces import force_table
from derive.spec.tables.functions import FunctionParameterTable, ValuesTable
from derive.spec.tables.initial_values import BeamStartTable, JointStartTable, StartTable
from derive.spec.tables.joints import joint_table
from derive.spec.tables.ports import InputTable, output_table
from derive.spec.tables.scene_bodies import (
    BEAM_KEYS,
    BeamBodyTable,
    GroundTable,
    LoadTable,
    RigidTable,
    SceneTable,
    body_tables,
    kind_of_scene_body,
)
from derive.spec.tables.simulation import ColumnPlotTable, PlotTable, ReferenceTable, SimulationTable, kind_of_plot

_NAMED: dict[str | int, Callable[[], type[BaseModel]]] = {
    "joints": joint_table,
    "drives": lambda: DriveTable,
    **{section: partial(force_table, section) for section in DEFAULT_KINDS},
    "inputs": lambda: InputTable,
    "outputs": output_table,
    "parameters": lambda: FunctionParameterTable,
    "tables": lambda: ValuesTable,
}
_PLAIN: dict[str | int, type[BaseModel]] = {"ground": GroundTable, "scene": SceneTable, "simulation": SimulationTable}
PLAIN_TABLES = {str(name): {*table.model_fields} for name, table in _PLAIN.items()}
"""The keys of each table that exists once in a scene."""

_EXAMPLES = {
    ("joints", "kind"): 'kind = "revolute"',
    ("joints", "between"): 'between = ["ground.bearing", "crank.hub"]',
    ("drives", "joint"): 'joint = "bearing"',
    ("forces", "at"): 'at = "rod.right"',
    ("forces", "components"): "components = [0, -10]",
    ("torques", "at"): 'at = "crank.hub"',
    ("torques", "value"): "value = 1.5",
    ("springs", "between"): 'between = ["ground.bearing", "slider.pin"]',
    ("springs", "stiffness"): "stiffness = 1000",
    ("outputs", "kind"): 'kind = "position"',
    ("tables", "file"): 'file = "load.csv"',
    ("tables", "x"): 'x = "the name of a column"',
    ("tables", "y"): 'y = "the name of a column"',
    ("plots", "deflection"): 'deflection = "rod.middle"',
    ("plots", "chord"): 'chord = ["rod.left", "rod.right"]',
    ("plots", "divided_by"): "divided_by = 0.3",
    ("plots", "y"): 'y = "rod_phi"',
}
_SYMBOLS = {"inertia": "I", "speed": "Omega", "stiffness": "k", "damping": "d", "rest": "l0"}


def is_union(path: KeyPath) -> bool:
    """Whether a value has two notations, which pydantic distinguishes in the path of an error."""
    match path:
        case ("bodies", _) | ("bodies", _, "frame" | "ansatz") | ("plots", _):
            return True
        case ("bodies", _, "inertia"):
            return True
        case ("bodies", _, *keys) if is_beam_union(keys):
            return True
        case ("bodies", _, "centre", int()) | ("bodies", _, "markers", _, int()) | ("ground", "markers", _, int()):
            return True
        case ("scene", "gravity", int()) | ("drives", _, "speed"):
            return True
        case ("bodies", _, key):
            return any(key in quantities(body_type.keys) for body_type in BODIES.values())
        case ("joints", _, key):
            return any(key in quantities(joint_type.keys) for joint_type in JOINTS.values())
        case (section, _, key) if section in DEFAULT_KINDS:
            return any(key in quantities(force_type.keys) for force_type in kinds(section).values())
    return False


def is_beam_union(keys: Sequence[str | int]) -> bool:
    """Whether a value of a beam, at these keys of its table, has two notations."""
    match keys:
        case (key,):
            return key in BEAM_QUANTITIES
        case ("axial", key):
            return key in AXIAL_UNITS
        case ("damping", key):
            return key in DAMPING_UNITS
        case ("masses", _, key):
            return key in MASS_UNITS
    return False


def beam_table(keys: Sequence[str | int]) -> type[BaseModel] | None:
    """The model of a table inside the table of a beam; None if there is none of that name."""
    match keys:
        case ("frame",):
            return FrameTable
        case ("axial",):
            return AxialTable
        case ("damping",):
            return BeamDampingTable
        case ("masses", _):
            return AttachedMassTable
    return None


def example(path: KeyPath) -> str:
    """An example of a missing key."""
    match path:
        case ("simulation", "duration"):
            return "duration = 1.0"
        case ("simulation", _):
            return "output = 1e-3"
        case ("plots", _, "reference", "file"):
            return 'file = "curve.csv"'
        case ("plots", _, "reference", key):
            return f'{key} = "the name of a column"'
        case (*_, key, "symbol"):
            return f'symbol = "{_SYMBOLS.get(str(key), "a")}"'
        case (*_, "default"):
            return "default = 0.1"
        case ("bodies", _, "loads", _, "force"):
            return 'force = [0, "-10*(1 - xi^2)"]'
        case (*_, "axial", "ansatz"):
            return 'ansatz = ["xi"]'
        case (*_, "axial", "stiffness"):
            return "stiffness = 1e6"
        case (*_, "masses", _, "at"):
            return "at = 1"
        case (*_, "masses", _, "mass"):
            return "mass = 0.5"
        case ("bodies", _, key):
            return f"{key} = 1.0"
        case (kind, _, key):
            return _EXAMPLES[str(kind), str(key)]
    raise AssertionError(f"there is no example of {path} yet")


def table(path: KeyPath, data: Mapping[str, object]) -> type[BaseModel] | None:
    """The model of the table at a path; None if it is not a table of a scene, or if it is a parameter."""
    match path:
        case (kind,):
            return _PLAIN.get(kind)
        case ("bodies", name):
            return body_tables()[_kind(name, data)]
        case ("bodies", name, "start"):
            return BeamStartTable if _kind(name, data) == "beam" else StartTable
        case ("joints" | "drives", _, "start"):
            return JointStartTable
        case ("bodies", _, *keys) if of_beam := beam_table(keys):
            return of_beam
        case ("bodies", _, "loads", _):
            return LoadTable
        case ("plots", _, "reference"):
            return ReferenceTable
        case ("plots", name):
            plots = data.get("plots")
            kind_of = kind_of_plot(plots.get(name) if isinstance(plots, Mapping) else None)
            return ColumnPlotTable if kind_of == "columns" else PlotTable
        case (kind, _) if kind in _NAMED:
            return _NAMED[kind]()
    return None


def unknown(path: KeyPath, data: Mapping[str, object]) -> str | None:
    """The message on an unknown key of a rigid body or a beam, which may belong to the other; None for other paths."""
    kind = _kind(path[1], data) if len(path) == 3 and path[0] == "bodies" else ""
    if kind not in ("rigid", "beam"):
        return None
    key = str(path[2])
    keys = ", ".join(BEAM_KEYS)
    if kind == "rigid" and key in BeamBodyTable.model_fields:
        return f"a rigid body has no such key; leave it out, or make the body a beam by one of {keys}"
    if kind == "beam" and key in RigidTable.model_fields:
        return f"a beam has no such key; leave it out, or make the body rigid: without {keys}"
    if key == "gravity":
        return "gravity acts on all bodies; write it in the table [scene]"
    own, other = (BeamBodyTable, RigidTable) if kind == "beam" else (RigidTable, BeamBodyTable)
    both = [*own.model_fields, *(key for key in other.model_fields if key not in own.model_fields)]
    what = "beam" if kind == "beam" else "rigid body"
    return f"unknown key{similar_key(key, both, f'the keys of a {what} are ' + ', '.join(own.model_fields))}"


def _kind(name: str | int, data: Mapping[str, object]) -> str:
    bodies = data.get("bodies")
    return kind_of_scene_body(bodies.get(name) if isinstance(bodies, Mapping) else None)
