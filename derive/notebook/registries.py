"""The HTML of registries with the keys of their members, and of models as hosts see them with their variables."""

from __future__ import annotations

from typing import Any

from derive.export.host_model import HostModel, HostVariable
from derive.notebook.parts import Writers, folded, head, joined, lines, table
from derive.registry import Registry
from derive.short_text import counted


def registry_html(registry: Registry[Any]) -> str:
    """A registry: its members with their descriptions, and the keys of a specification that they take."""
    rows = [
        (name, _doc(member), ", ".join(key.name for key in getattr(member, "keys", ())))
        for name, member in registry.items()
    ]
    keyed = any(keys for _, _, keys in rows)
    columns = (registry.kind, "meaning", *(["keys"] if keyed else []))
    return joined(
        head(f"Registry ({registry.kind})", counted(len(registry), "member")),
        table(columns, rows if keyed else [row[:2] for row in rows], left=3, most=max(1, len(rows))),
    )


def _doc(member: Any) -> str:
    """The first line of the description of a member."""
    text = getattr(member, "doc", None) or getattr(member, "__doc__", None) or ""
    return str(text).strip().split("\n", 1)[0].split(". ", 1)[0]


def host_model_html(model: HostModel) -> str:
    """A model as hosts see it: its states, inputs, outputs and parameters, with units and start values."""
    groups = {
        "States": model.states,
        "Inputs": model.inputs,
        "Outputs": model.outputs,
        "Parameters": model.parameters,
        "Multipliers": model.multipliers,
    }
    return joined(
        head(model.name, model.model.doc),
        "".join(folded(f"{title}: {len(of)}", _variables(of)) for title, of in groups.items() if of),
        lines(model.notes),
    )


def _variables(variables: tuple[HostVariable, ...]) -> str:
    rows = [(v.name, v.unit, v.doc, "" if v.start is None else f"{v.start:g}") for v in variables]
    return table(("name", "unit", "meaning", "start"), rows, left=3, most=len(rows))


WRITERS: Writers = {
    Registry: registry_html,
    HostModel: host_model_html,
}
