"""The tables of run-time inputs, and of outputs, whose kinds and keys are those of the registry of outputs."""

from __future__ import annotations

from functools import cache
from typing import Annotated

from pydantic import Field, create_model, model_validator

from derive.mechanics.multibody.outputs.output_type import OutputType
from derive.mechanics.multibody.outputs.registry import OUTPUTS
from derive.spec.model.ports import SceneOutput
from derive.spec.model.scene import SceneInput
from derive.spec.parsing import values
from derive.spec.tables.declared_keys import check_keys, fields_of_kinds, key_values, kind_field
from derive.spec.tables.markers import Time
from derive.spec.tables.shared import TomlTable, Unit


class InputTable(TomlTable):
    """A run-time input of the generated code, which forces, torques and drives refer to by its name."""

    unit: Unit = None
    value: Annotated[
        Time | None, Field(description="What the input is in simulations: a number, or a function of t.")
    ] = None

    @model_validator(mode="after")
    def check(self) -> InputTable:
        """Refuse an input whose function contains another input."""
        if self.value is not None and self.value.kind == "input":
            raise values.WrongValueError("the value of an input is a number or a function of t, not another input")
        return self

    def input(self, name: str) -> SceneInput:
        """The model of the input that the derivation takes."""
        return SceneInput(name, self.unit or "", self.value)


class OutputTable(TomlTable):
    """A quantity that is computed from the state."""

    kind: str

    @model_validator(mode="after")
    def check(self) -> OutputTable:
        """Refuse keys that do not go with the kind."""
        check_keys(self, self.kind, OUTPUTS, "output")
        return self

    def output(self, name: str) -> SceneOutput:
        """The model of the output that the derivation takes."""
        return SceneOutput(name, self.kind, key_values(OUTPUTS[self.kind].keys, self))


def output_table() -> type[OutputTable]:
    """The table of an output, with the kinds and keys of all outputs that are registered now."""
    return _output_table(tuple(OUTPUTS.items()))


@cache
def _output_table(outputs: tuple[tuple[str, OutputType], ...]) -> type[OutputTable]:
    types = dict(outputs)
    kind, keys = kind_field(types, "the output"), fields_of_kinds(types)
    return create_model("OutputTable", __base__=OutputTable, __doc__=OutputTable.__doc__, kind=kind, **keys)
