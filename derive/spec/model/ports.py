"""The ports of a scene: run-time inputs of the generated code, and outputs computed from the state."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from derive.short_text import record_text


@dataclass(frozen=True)
class SceneOutput:
    """A quantity that is computed from the state."""

    # Its kind is a name of the registry of outputs; the values are those of the keys of the kind.
    name: str
    kind: str
    values: Mapping[str, object] = field(default_factory=dict, hash=False)
    __repr__ = record_text
