"""Scenes in which everything occurs: joints of each kind in each place, drives, actions, bodies with little left.

They are files of their own in `zoo_scenes`.
"""

from __future__ import annotations

from pathlib import Path

JOINTS, REDUCED, ACTIONS, ELEMENTS, FUNCTIONS, LOADS = (
    (Path(__file__).parent / "zoo_scenes" / f"{name}.toml").read_text()
    for name in ("joints", "reduced", "actions", "elements", "functions", "loads")
)
KEPT = REDUCED.replace('"reduced"', '"kept"')
for _name in ("bob", "flag", "post", "swing", "slider", "cart", "gear"):
    KEPT = KEPT.replace(f"[bodies.{_name}]", f"[bodies.{_name}]\nkeep_coordinates = true")
for _name in ("arm", "pusher"):  # which do without mass where their motion is prescribed
    KEPT = KEPT.replace(f"[bodies.{_name}]", f"[bodies.{_name}]\nkeep_coordinates = true\nmass = 0.3\ninertia = 0.02")
