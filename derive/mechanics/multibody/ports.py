"""The run-time inputs and the outputs of a mechanism as parts of its equations."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from derive.mechanics.symbols import DOTS, run_time_input
from derive.mechanics.terms import InputSymbol, ModelConstant, OutputEquation
from derive.spec.model.instances import identifier, joined, rate_name
from derive.spec.model.specification import AnyScene

if TYPE_CHECKING:
    from derive.mechanics.multibody.outputs.output_type import OutputInstance
    from derive.mechanics.multibody.scene_mechanics import SceneMechanics


def input_symbols(scene: AnyScene) -> tuple[InputSymbol, ...]:
    """The symbols of the run-time inputs; inputs that prescribe motions of drives have two time derivatives."""
    motions = {drive.motion.name for drive in scene.drives if drive.motion and drive.motion.kind == "input"}
    result = []
    for given in scene.inputs:
        for order in range(3 if given.name in motions else 1):
            unit = given.unit + ("", "/s", "/s^2")[order] if given.unit else ""
            doc = f"{('', 'time derivative of ', 'second time derivative of ')[order]}input {given.name}"
            symbol, shown = run_time_input(given.name, order), rate_name(given.name, DOTS[order])
            result.append(InputSymbol(symbol, identifier(shown), shown, doc, unit))
    return tuple(result)


def output_equations(
    instances: Sequence[OutputInstance], parts: SceneMechanics
) -> tuple[tuple[OutputEquation, ...], tuple[ModelConstant, ...]]:
    """The components of all outputs, and the constants that only these have."""
    equations: list[OutputEquation] = []
    constants: list[ModelConstant] = []
    for output in instances:
        made = output.type.components(output.name, output.values, parts)
        docs = output.type.descriptions(output.values, parts)
        for part, doc in zip(made.components, docs, strict=True):
            shown = joined(output.name, part.label)
            equations.append(OutputEquation(identifier(shown), shown, part.unit, doc, part.expr))
        constants += made.constants
    return tuple(equations), tuple(constants)
