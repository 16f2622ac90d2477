"""Warnings on a valid specification: units other than those of SI, and defaults of physical constants."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import chain

from derive.errors import quoted
from derive.spec.checks.scene_data import Raw, SceneData
from derive.spec.checks.scene_parameters import SceneConstant, beam_constants, scene_constants
from derive.spec.model.beam import BEAM_QUANTITIES
from derive.spec.model.body import ACCELERATION_UNIT
from derive.spec.parsing.faults import Fault, KeyPath
from derive.spec.parsing.units import UnknownUnit, unit_size


def specification_warnings(data: Raw) -> list[Fault]:
    """The warnings on a specification without faults, with the keys that they concern."""
    beam, body = data.get("beam"), data.get("body")
    if isinstance(beam, Mapping):
        constants = chain(beam_constants(("beam",), beam), _gravity("beam", beam))
        parts = (_defaults(("beam",), beam), _units(constants))
    elif isinstance(body, Mapping):
        parts = (iter(()), _units(_gravity("body", body)))
    else:
        view = SceneData(data)
        beams = ((name, table) for name, table in view.bodies.items() if view.is_beam(name))
        defaults = chain.from_iterable(_defaults(("bodies", name), table) for name, table in beams)
        parts = (defaults, _units(scene_constants(view)))
    return [*chain(*parts)]


def _defaults(path: KeyPath, beam: Raw) -> Iterator[Fault]:
    """Warnings on the physical constants of a beam that are not given."""
    for key, like in BEAM_QUANTITIES.items():
        if key not in beam:
            is_given = f"no {key.replace('_', ' ')} is given, so that it is the parameter {like.symbol}"
            yield Fault((*path, key), f"{is_given}, {like.default:g} {like.unit} by default; write {key} = 1.0")


def _gravity(kind: str, table: Raw) -> Iterator[SceneConstant]:
    gravity = table.get("gravity")
    for i, component in enumerate(gravity if isinstance(gravity, (list, tuple)) else ()):
        yield SceneConstant((kind, "gravity", i), component, f"component {i + 1} of gravity", ACCELERATION_UNIT)


def _units(constants: Iterator[SceneConstant]) -> Iterator[Fault]:
    """Warnings on parameters whose units are not those of SI, and on parameters without a default."""
    for constant in constants:
        value = constant.value
        if not isinstance(value, Mapping) or constant.unit is None:
            continue
        if "unit" in value and (fault := _misfit(str(value["unit"]), constant.unit)):
            yield Fault((*constant.path, "unit"), fault)
        if "default" not in value:
            yield Fault(constant.path, f"the parameter {value['symbol']} has no default, and gets 1 {constant.unit}")


def _misfit(unit: str, expected: str) -> str | None:
    """The reason why a unit does not fit; None if it does."""
    try:
        needed = unit_size(expected)
    except UnknownUnit:  # of a body, joint or force that is registered from outside
        return None
    try:
        given = unit_size(unit)
    except UnknownUnit:
        return f"the unit {quoted(unit)} is unknown and not checked; in SI units it is {quoted(expected)}"
    if given.dimension != needed.dimension:
        return f"the unit {quoted(unit)} does not fit: the equations need {quoted(expected)}"
    if not math.isclose(given.scale, needed.scale, rel_tol=1e-9):
        return (
            f"the unit {quoted(unit)} is {given.scale / needed.scale:.6g} {expected}, and values enter the equations "
            f"as they are, beside others in SI units; write unit = {quoted(expected)} and convert the default"
        )
    return None
