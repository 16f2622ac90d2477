"""Notes on bodies that spin fast in the models of a study, a line for each body."""

from __future__ import annotations

from collections.abc import Iterable, Mapping


def spin_notes(models: Iterable[tuple[str, Mapping[str, str]]]) -> list[str]:
    """A line for each body: the note of the first model in which it spins fast, and all models in which it does.

    models: their labels, and their notes by the names of bodies.
    """
    first: dict[str, str] = {}
    labels: dict[str, list[str]] = {}
    for label, notes in models:
        for body, note in notes.items():
            first.setdefault(body, note)
            labels.setdefault(body, []).append(label)
    return [f"{note} ({'; '.join(dict.fromkeys(labels[body]))})" for body, note in first.items()]
