"""The default plots of a specification: its outputs without a plot, or its coordinates by their roles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from derive.ir.model import Model
from derive.mechanics.axes import AXES
from derive.mechanics.multibody.outputs.deflection import CHORD, DIVIDED_BY, ChordDeflection
from derive.mechanics.multibody.outputs.marker_motion import MARKER
from derive.mechanics.multibody.outputs.registry import output_type
from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS
from derive.mechanics.multibody.space.outputs import spatial_output_type
from derive.mechanics.multibody.space.rows import ROTATIONS
from derive.roles import Role
from derive.simulation.free_body import FreeBody
from derive.simulation.trajectory import energy_names
from derive.spec.model.instances import identifier, joined
from derive.spec.model.plots import ColumnCurves, Deflection, Plot
from derive.spec.model.ports import SceneOutput
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene

PLANAR = {
    "angles": (Role.ROTATION,),
    "positions": (Role.TRANSLATION, Role.DISPLACEMENT),
    "deformations": (Role.AMPLITUDE,),
}
"""The plots of coordinates in the plane by their names, with the roles of the coordinates in each."""
SPATIAL = {
    "position": (Role.TRANSLATION,),
    "rotation": (Role.QUATERNION,),
    "angular_velocity": (),
    "amplitudes": (Role.AMPLITUDE,),
}
"""The plots of the coordinates of a body in space, and of its angular velocity."""


MANY_CURVES, SELECTED = 60, 12
"""A plot of more coordinates than the first shows as many as the second, evenly spaced ones."""


def default_plots(scene: AnyScene, model: Model, stresses: tuple[str, ...] = ()) -> tuple[Plot, ...]:
    """The plots over the time that a simulation draws by default: one for each output that no plot shows.

    A scene without outputs and plots has plots of its coordinates; a body in space alone also of its angular velocity
    and its energies. stresses: the columns of largest stresses, which a plot of their own shows.
    """
    shown = {y for plot in scene.plots if isinstance(plot.quantity, ColumnCurves) for y in plot.quantity.y}
    largest = [name for name in stresses if name not in shown]
    if scene.outputs or scene.plots:
        outputs = _unplotted(scene)
        own = [_plot(_free_name(output, scene), _drawn_columns(output, scene)) for output in outputs]
    else:
        own = [_plot(name, _selected(columns)) for name, columns in _quantities(scene, model).items()]
    taken = [plot.name for plot in (*scene.plots, *own)]
    return (*own, *([_plot(_other_than(taken, "stress", "_of_bodies"), largest)] if largest else ()))


def plots_note(scene: AnyScene, model: Model) -> tuple[str, ...]:
    """A line on what default plots leave out, if they do."""
    if scene.outputs or scene.plots:
        return ()
    every = {name: columns for name, columns in _quantities(scene, model).items() if len(columns) > MANY_CURVES}
    shown = ", ".join(f"{len(_selected(columns))} of {len(columns)} of {name}" for name, columns in every.items())
    return (f"plots show some curves only: {shown}; the CSV has all, and [plots] selects others",) if shown else ()


def _selected(columns: Sequence[str]) -> list[str]:
    """The columns of a plot: all, or some up to the last one, with an odd step, so that both components are shown."""
    if len(columns) <= MANY_CURVES:
        return [*columns]
    step = ((len(columns) - 1) // (SELECTED - 1) - 1) // 2 * 2 + 1
    return [columns[len(columns) - 1 - step * i] for i in reversed(range(SELECTED))]


def _quantities(scene: AnyScene, model: Model) -> dict[str, list[str]]:
    """The names of the columns that are plotted, by the names of the default plots."""
    spatial = any(c.role is Role.QUATERNION for c in model.coordinates)
    every = SPATIAL if spatial or model.in_space else PLANAR
    quantities = {name: quantities_of(model, *roles) for name, roles in every.items()}
    if scene.bodies and (spatial or model.in_space):
        quantities |= {"joints": quantities_of(model, Role.ROTATION, Role.DISPLACEMENT)}
        quantities["angular_velocity"] = [x.title for x in model.velocities if x.unit == "rad/s"]
    elif spatial:
        quantities["angular_velocity"] = [x.name for x in model.velocities[FreeBody(0).rotation]]
    quantities["energy"] = [*energy_names(scene, model)]
    return {name: columns for name, columns in quantities.items() if columns}


def quantities_of(model: Model, *roles: Role) -> list[str]:
    """The names of the columns of coordinates with some roles."""
    return [x for c in model.coordinates if c.role in roles for x in c.columns]


def _unplotted(scene: AnyScene) -> list[SceneOutput]:
    """The outputs that no plot shows, by their columns or as the same deflection."""
    quantities = [plot.quantity for plot in scene.plots]
    in_space = _in_space(scene)
    columns = {y for quantity in quantities if isinstance(quantity, ColumnCurves) for y in quantity.y}
    return [
        o
        for o in scene.outputs
        if not columns & {*output_columns(o, in_space)} and (in_space or _deflection(o) not in quantities)
    ]


def _in_space(scene: AnyScene) -> bool:
    return isinstance(scene, SpatialScene)


def _deflection(output: SceneOutput) -> Deflection | None:
    """The quantity of a plot that an output measures, if it is a deflection."""
    if not isinstance(output_type(output.kind), ChordDeflection):
        return None
    values: Mapping[str, Any] = output.values
    divisor = values.get(DIVIDED_BY.name)
    return Deflection(values[MARKER.name], values[CHORD.name], None if divisor is None else float(divisor))


def _free_name(output: SceneOutput, scene: AnyScene) -> str:
    """The name of an output's plot: its own, or one like it if a plot of something else has that, in any case."""
    names = [plot.name for plot in scene.plots] + [other.name for other in scene.outputs if other != output]
    return _other_than(names, identifier(output.name), "_output")


def _other_than(names: Sequence[str], name: str, suffix: str) -> str:
    """A name that differs from others in more than case, with suffixes where it has to."""
    taken = {other.lower() for other in names}
    while name.lower() in taken:
        name += suffix
    return name


def output_columns(output: SceneOutput, in_space: bool = False) -> tuple[str, ...]:
    """The names of the columns of an output of a scene, or of one that monitors a model."""
    of: Any = spatial_output_type(output.kind) if in_space else output_type(output.kind)
    labels: tuple[str, ...] = of.labels
    return tuple(joined(output.name, label) for label in labels)


def _drawn_columns(output: SceneOutput, scene: AnyScene) -> tuple[str, ...]:
    """The columns of an output that its plot shows: not the torque of what exerts none, whatever the motion."""
    columns = output_columns(output, _in_space(scene))
    if not isinstance(scene, SpatialScene) or not _without_torque(output, scene):
        return columns
    return tuple(column for column in columns if column not in {joined(output.name, f"torque{k}") for k in AXES})


def _without_torque(output: SceneOutput, scene: SpatialScene) -> bool:
    """Whether an output is the force of a linear spring, or of a joint that leaves all rotations."""
    values: Mapping[str, Any] = output.values
    if output.kind == "spring":
        return any(spring.name == values["spring"] and spring.kind == "linear" for spring in scene.springs)
    if output.kind != "reaction":
        return False
    joint = next(joint for joint in scene.joints if joint.name == values["joint"])
    return not {*ROTATIONS} & {*SPATIAL_JOINTS[joint.kind].removed(joint)}


def _plot(name: str, columns: Sequence[str]) -> Plot:
    return Plot(name, ColumnCurves(tuple(columns)))
