"""Rows of speed: the figures of a benchmark as dicts, which `all.py` collects from the function `rows` of each module.

A row has the keys `name`, `unit`, `ours_ns`, `peer_ns`, `peer_name`, `hand_ns`, `ratio`, `goal` and `note`. The three
times are in `unit`, which is ns unless the row says otherwise; what was not measured is None, and `note` says why.
`ratio` is ours over the time of code written by hand where there is such code, otherwise over that of the best peer.
`goal` is what the ratio is to be at most, or in a row that is not in ns the figure itself.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

Row = dict[str, Any]


def row(
    name: str,
    ours: float,
    *,
    peers: Mapping[str, float] | None = None,
    hand: float | None = None,
    goal: float | None = None,
    unit: str = "ns",
    note: str = "",
) -> Row:
    """A row with the best of the peers, whose times (in `unit`) are given by their names."""
    best = min(peers or {}, key=lambda peer: (peers or {})[peer], default="")
    peer = peers[best] if peers and best else None
    against = peer if hand is None else hand
    return {
        "name": name,
        "unit": unit,
        "ours_ns": ours,
        "peer_ns": peer,
        "peer_name": best,
        "hand_ns": hand,
        "ratio": None if against is None else ours / against,
        "goal": goal,
        "note": note,
    }


def is_met(given: Row) -> bool | None:
    """Whether a row reaches its goal; None where it has no goal, or no figure that the goal is about."""
    figure = given.get("ratio" if given.get("unit", "ns") == "ns" else "ours_ns")
    return None if figure is None or given.get("goal") is None else bool(figure <= given["goal"])
