"""Validation of the data of a specification: all faults at once, each with its path and a sentence."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

from pydantic import ValidationError

from derive.errors import Problem, SpecError, quoted
from derive.spec.checks.body_checks import shape_faults
from derive.spec.checks.cross_references import scene_faults
from derive.spec.checks.dimensions import dimension_faults, is_in_space
from derive.spec.checks.flexible_nodes import flexible_nodes
from derive.spec.checks.known_functions import function_faults, known_functions
from derive.spec.checks.messages import key_faults
from derive.spec.checks.plotted_columns import column_faults
from derive.spec.checks.scene_parameters import beam_constants
from derive.spec.checks.spatial_references import spatial_scene_faults
from derive.spec.files.meshes import with_meshes
from derive.spec.files.nodal_forces import with_nodal_forces
from derive.spec.files.reference_curves import Rows, references
from derive.spec.model.beam import BEAM_QUANTITIES, PlanarBeam
from derive.spec.model.body import SymbolicBody
from derive.spec.model.node_data import NodeData
from derive.spec.model.scene import Scene
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import Specification
from derive.spec.parsing.faults import Fault, KeyPath, line_of, path_text
from derive.spec.parsing.names import name_problem
from derive.spec.tables.body import kind_of_body, nodal_body
from derive.spec.tables.instance_tables import instance_tables
from derive.spec.tables.sections import SCENE, plots
from derive.spec.tables.shared import MAX_MARKERS, TomlTable
from derive.spec.tables.spatial_scene import spatial_scene, spatial_specification_table
from derive.spec.tables.specification import scene, specification_table

Curves = Mapping[str, Rows]

INTEGRALS = "m|c[1-8](_[0-9]+)*|[kb](_[0-9]+)*|(x|phi)[0-9]+(_[0-9]+)*"
"""The names of the parameters of a body in space: m, c2_1_3, C3, C3_11, K_1_2, B_1_2, and X1, Phi1 of its markers."""


def validate(
    data: Mapping[str, object],
    source: str | None = None,
    lines: Callable[[], Mapping[KeyPath, int]] = dict,
    curves: Curves = MappingProxyType({}),
    columns: bool = True,
) -> Specification:
    """The specification that `data` describe. Raises SpecError with all faults.

    source: the file they come from, beside which other files are; lines: the lines of its keys, asked for only if they
    are needed; curves: the numbers of reference curves that are known already, by the names of their plots; columns:
    whether plots may show only columns that there can be.
    """
    result = _checked(data, Path() if source is None else Path(source).parent, curves, columns)
    if not isinstance(result, list):
        return result
    known = lines()
    problems = [Problem(path_text(path), message, line_of(path, known)) for path, message in result]
    # In the order of the file; what is not in it comes first.
    raise SpecError(tuple(sorted(problems, key=lambda problem: problem.line or 0)), source)


def _checked(data: Mapping[str, object], folder: Path, known: Curves, columns: bool) -> Specification | list[Fault]:
    """The specification that `data` describe, with other files relative to `folder`; or all faults."""
    specification = None
    instances = instance_tables(data)
    data = instances.data
    names, faults_of_names = known_functions(data, folder)
    faults: list[Fault] = []
    in_space = is_in_space(data)
    data, faults_of_loads = with_nodal_forces(data, folder) if in_space else (data, [])
    data, faults_of_meshes = with_meshes(data, folder) if in_space else (data, [])
    table = spatial_specification_table() if in_space else specification_table()
    try:
        specification = table.model_validate(data, context=names)
    except ValidationError as error:
        faults = key_faults(error, data, instances.written, table)
    kinds = _kinds(data)
    if len(kinds) > 1:
        return [_mixed(kinds)]  # what else there is follows from this
    if not kinds:
        text = "this key is missing; write [beam], [body] for a body in space, or [bodies.rod] for a scene"
        faults.append(Fault(("beam",), text))
    faults += _repeated_names(data)
    faults += _names_of_integrals(data)
    faults += shape_faults(("beam",), data.get("beam"))
    nodes, node_faults = _nodes(data, specification, folder)
    of_bodies, faults_of_bodies = flexible_nodes(data, specification, folder) if in_space else ({}, [])
    node_faults = [*node_faults, *faults_of_bodies]
    curves, curve_faults = references(data, folder, known)
    faults += [*node_faults, *curve_faults, *faults_of_names, *faults_of_loads, *faults_of_meshes]
    if any(key in data for key in SCENE) and instances.counts_are_known:
        mixed = list(dimension_faults(data))
        faults = mixed or [*faults, *(spatial_scene_faults(data) if in_space else scene_faults(data))]
    faults += [*_simulated_without_numbers(data), *_plots_of_a_body(data)]
    faults = instances.merged(faults)
    if specification is None or faults:
        return faults
    result = _specified(specification, nodes, curves, of_bodies)
    faults += function_faults(result, data) if isinstance(result, (Scene, SpatialScene)) else ()
    faults += column_faults(result) if columns else ()
    return instances.merged(faults) or result


def _simulated_without_numbers(data: Mapping[str, object]) -> Iterator[Fault]:
    """Faults of a simulation, or of plots, of a body whose constants are all parameters."""
    body = data.get("body")
    if isinstance(body, Mapping) and kind_of_body(body) == "symbolic":
        text = "a symbolic body has no numbers to simulate with; leave this table out, or give the body by its nodes"
        yield from (Fault((key,), text) for key in ("simulation", "plots") if key in data)


def _plots_of_a_body(data: Mapping[str, object]) -> Iterator[Fault]:
    """Faults of plots of a single body with keys that need a scene."""
    plots = data.get("plots")
    if "bodies" in data or not isinstance(plots, Mapping):
        return
    for name, plot in plots.items():
        for key in ("deflection", "chord", "divided_by", "over", "cut", "pieces"):
            if isinstance(plot, Mapping) and key in plot:
                text = 'plots of a body alone draw columns, such as y = ["c1", "c2"]; this key is for scenes'
                yield Fault(("plots", str(name), key), text)


def _kinds(data: Mapping[str, object]) -> list[str]:
    """The keys of what is specified, a beam, a body or a scene; of the keys of a scene only the first is given."""
    scene = [key for key in ("bodies", *SCENE) if key in data]
    return [*(key for key in ("beam", "body") if key in data), *scene[:1]]


def _mixed(kinds: list[str]) -> Fault:
    tables = " and ".join(f"[{kind}]" for kind in kinds)
    what = "one body" if kinds == ["beam", "body"] else "a body alone or a scene"
    return Fault((kinds[-1],), f"a file specifies {what}, and here are {tables}; leave one of them out")


def _specified(
    table: Any, nodes: NodeData | None, curves: Mapping[str, Rows], of_bodies: Mapping[str, NodeData]
) -> Specification:
    """The specification that a table without faults describes."""
    if table.bodies is not None:
        in_space = isinstance(table, spatial_specification_table())
        return spatial_scene(table, curves, of_bodies) if in_space else scene(table, curves)
    if isinstance(table.body, SymbolicBody):
        return replace(table.body, name=table.name)
    others = {"name": table.name, "simulation": table.simulation, "plots": plots(table, curves)}
    if table.body is not None:
        assert nodes is not None
        return nodal_body(table.body, nodes, **others)
    beam: PlanarBeam = table.beam
    return replace(beam, **others)


def _repeated_names(data: Mapping[str, object]) -> Iterator[Fault]:
    """Faults of names that differ in case alone: constants become upper case in code, so that m and M coincide."""
    for kind in ("beam", "body"):
        table = data.get(kind)
        if not isinstance(table, Mapping):
            continue
        for names in (_symbols(data.get("name"), kind, table), _marker_names(kind, table.get("markers"))):
            first: dict[str, str] = {}
            for path, name, where in names:
                if name_problem(name):
                    continue
                other = first.setdefault(name.lower(), where)
                if other != where:
                    yield Fault(path, f"{quoted(name)} is taken: {other}; names must differ in more than case")


def _names_of_integrals(data: Mapping[str, object]) -> Iterator[Fault]:
    """Faults of symbols of gravity that coincide with names of other parameters of a body in space."""
    body = data.get("body")
    if isinstance(body, Mapping):
        for path, name, _ in _symbols(None, "body", body):
            if re.fullmatch(INTEGRALS, name, re.IGNORECASE):
                yield Fault(path, f"{quoted(name)} is taken: it is the name of another parameter of a body in space")


def _symbols(model: object, kind: str, table: Mapping[str, object]) -> Iterator[tuple[KeyPath, str, str]]:
    # Default symbols come first, so that a clash is reported where something was written.
    for key, parameter in BEAM_QUANTITIES.items() if kind == "beam" else ():
        if key not in table:
            yield (kind, key), parameter.symbol, f"it is the symbol of {key} if none is given"
    if isinstance(model, str):
        yield ("name",), model, "it is the name of the model"
    for constant in beam_constants((kind,), table) if kind == "beam" else ():
        yield from _symbol(constant.path, constant.value, f"it is the symbol of {constant.what}")
    gravity = table.get("gravity")
    for i, component in enumerate(gravity[:3] if isinstance(gravity, (list, tuple)) else ()):
        yield from _symbol((kind, "gravity", i), component, f"it is the symbol of component {i + 1} of gravity")


def _symbol(path: KeyPath, quantity: object, where: str) -> Iterator[tuple[KeyPath, str, str]]:
    symbol = quantity.get("symbol") if isinstance(quantity, Mapping) else None
    if isinstance(symbol, str):
        yield (*path, "symbol"), symbol, where


def _marker_names(kind: str, markers: object) -> Iterator[tuple[KeyPath, str, str]]:
    if isinstance(markers, Mapping) and len(markers) <= MAX_MARKERS:
        for name in markers:
            if isinstance(name, str):
                yield (kind, "markers", name), name, f"there is a marker {quoted(name)}"


def _nodes(
    data: Mapping[str, object], specification: TomlTable | None, folder: Path
) -> tuple[NodeData | None, list[Fault]]:
    """The data of a body of nodes, if there is one; they are checked even if another key is at fault."""
    body = data.get("body")
    if not isinstance(body, Mapping) or kind_of_body(body) != "nodal":
        return None, []
    # NumPy and SciPy are not for specifications that have no arrays.
    from derive.spec.checks.node_checks import nodes_of

    return nodes_of(body, getattr(specification, "body", None), folder)
