"""The player of a motion: an HTML page with its data and scripts inside, which needs no network."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from derive.artifacts import MARK
from derive.rendering import render


def player_page(data: Mapping[str, Any], warnings: Sequence[str] = ()) -> str:
    """The text of a page that plays a motion, with warnings above it.

    `data` is that of `derive.simulation.observables.player_data`.
    """
    return _page("player.html", str(data["name"]), data, warnings)


def spatial_player_page(data: Mapping[str, Any], warnings: Sequence[str] = ()) -> str:
    """The text of a page that plays the motion of bodies in space, with warnings above it.

    `data` is that of `derive.simulation.observables.spatial_player_data`.
    """
    return _page("spatial.html", str(data["name"]), data, warnings)


def motions_page(title: str, motions: Sequence[Mapping[str, Any]]) -> str:
    """The text of a page that plays one of several motions at a time, which the reader selects by their names."""
    return _page("player.html", title, {"motions": motions})


def spatial_motions_page(title: str, bodies: Mapping[str, Any], motions: Sequence[Mapping[str, Any]]) -> str:
    """The text of a page that plays one of several motions of bodies in space, whose own data are `bodies`."""
    return _page("spatial.html", title, {"common": bodies, "motions": motions})


def _page(template: str, title: str, island: object, warnings: Sequence[str] = ()) -> str:
    content = {
        "mark": MARK,
        "title": escape(title),
        "motion": json_island(island),
        "warnings": [escape(text) for text in warnings],
    }
    return render(f"player/{template}.jinja", content)


def json_island(data: object) -> str:
    """JSON that is safe within a script element, whatever its texts are."""
    text = json.dumps(data, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")
