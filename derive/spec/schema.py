"""A whole specification as a pydantic model, which also makes the JSON schema for editors."""

from __future__ import annotations

from typing import Annotated

from pydantic import ConfigDict, Field

from derive.spec.beam_tables import BeamTable
from derive.spec.body_tables import BodyInput
from derive.spec.tables import Name, Table


class Specification(Table):
    """A deformable body, from which Tisserand makes C and Python kernels: either a beam or a body in space."""

    model_config = ConfigDict(json_schema_extra={"oneOf": [{"required": ["beam"]}, {"required": ["body"]}]})

    name: Annotated[Name, Field(description="The name of the model: of its files, and in front of all its functions.")]
    beam: BeamTable | None = None
    body: BodyInput | None = None
