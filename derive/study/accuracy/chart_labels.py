"""The names of lines in the chart of a ladder: their colours, and the groups and the positions of labels."""

from __future__ import annotations

from collections.abc import Sequence

from derive.spec.model.body import DisplacementOrder
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.accuracy.measurement import Line

NEAR = 1.05
"""Errors that differ by less than this factor share a label."""
ROOM = 26
"""The largest number of characters of the names of a label."""

COLOURS = {
    DisplacementOrder.FIRST_ORDER: "#d0702a",
    DisplacementOrder.TRUNCATED: "#1f8fbf",
    DisplacementOrder.FULL: "#8661c1",
}
RIGID = "#8c6d46"

ORDER_NAMES = {
    DisplacementOrder.FIRST_ORDER: "first order",
    DisplacementOrder.TRUNCATED: "second order, truncated",
    DisplacementOrder.FULL: "second order, full",
}


OF_COMPONENTS = {
    Shapes.FREE: "#7f9f2f",
    Shapes.CRAIG_BAMPTON: "#2a8a63",
    Shapes.ATTACHMENT: "#b0913a",
    Shapes.GIVEN: "#b25f8f",
}
"""The colours of models of finite-element bodies, by the kinds of their modes."""


def colour(model: LadderModel) -> str:
    """The colour of a model, by its order, or by the kind of its component modes."""
    return RIGID if model.shapes is Shapes.RIGID else OF_COMPONENTS.get(model.shapes, COLOURS[model.order])


def colour_names(models: Sequence[LadderModel]) -> dict[str, str]:
    """The colours of models that are not rigid, by what they stand for."""
    of_beams = {m.order for m in models if m.shapes is not Shapes.RIGID and m.shapes not in OF_COMPONENTS}
    kinds = {model.shapes for model in models}
    orders = {name: COLOURS[order] for order, name in ORDER_NAMES.items() if order in of_beams}
    return orders | {kind.value: tint for kind, tint in OF_COMPONENTS.items() if kind in kinds}


def label_groups(lines: Sequence[Line]) -> list[list[Line]]:
    """The groups of lines with one order and about the same smallest error, from the smallest error on."""
    groups: list[list[Line]] = []
    for line in sorted(lines, key=lambda line: line.best):
        match = next(
            (
                g
                for g in groups
                if line.best <= NEAR * g[0].best
                and colour(g[0].model) == colour(line.model)
                and (g[0].valid, g[0].noted) == (line.valid, line.noted)
            ),
            None,
        )
        if match is None:
            groups.append([line])
        else:
            match.append(line)
    return groups


def group_label(group: Sequence[Line]) -> str:
    """The names of some lines of one order: those for which there is room, adaptive ones first, and how many more."""
    ordered = sorted(group, key=lambda line: line.integrator != "adaptive")
    names = [line.model.label.rsplit(", ", 1)[0] + line.label.removeprefix(line.model.label) for line in ordered]
    shown = [name for n, name in enumerate(names) if len(" · ".join(names[: n + 1])) <= ROOM or n == 0]
    more = f" and {len(names) - len(shown)} more" if len(names) > len(shown) else ""
    return f"{' · '.join(shown)}{more}"


def spread(wanted: Sequence[float], distance: float) -> list[float]:
    """Rising positions at least `distance` apart, closest to `wanted`, which rises, by least squares."""
    blocks: list[tuple[float, int]] = []  # the mean of wanted - number distance, and how many positions share it
    for number, want in enumerate(wanted):
        mean, count = want - number * distance, 1
        while blocks and blocks[-1][0] > mean:
            before, size = blocks.pop()
            mean, count = (before * size + mean * count) / (size + count), size + count
        blocks.append((mean, count))
    shifts = (mean for mean, count in blocks for _ in range(count))
    return [shift + number * distance for number, shift in enumerate(shifts)]


def duration(seconds: float) -> str:
    """The text of a time (s) with three significant digits and its unit."""
    return f"{1e3 * seconds:.3g} ms" if seconds < 0.9995 else f"{grouped(seconds)} s"


def milliseconds(seconds: float) -> str:
    """The text of a time (s) in ms, with at least three significant digits."""
    return grouped(1e3 * seconds)


def grouped(value: float) -> str:
    """The text of a number with at least three significant digits, without an exponent: 0.0123, 1.23, 12 345."""
    return f"{value:.3g}" if value < 999.5 else f"{value:,.0f}".replace(",", " ")
