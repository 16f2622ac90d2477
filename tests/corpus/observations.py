"""Random observations of a scene: outputs of all kinds, plots, and the settings of its simulation."""

from __future__ import annotations

from typing import Any

from corpus.draft import Draft, Table
from corpus.draws import rounded
from derive.extensions import Key, KeyType
from derive.mechanics.multibody.outputs.registry import OUTPUTS

STEPS = 300
"""About the largest number of radians of its fastest oscillation that a scene is simulated."""


def observe(draft: Draft) -> None:
    """Draw outputs and plots, and set duration and accuracy."""
    draws = draft.draws
    duration = rounded(min(draws.between(0.3, 1.5) / draft.rate, STEPS / draft.stiff), 2)
    for _ in range(draws.choice([0, 1, 2, 3, 4])):
        _output(draft)
    _plots(draft)
    rows = draws.choice([10, 20, 40])
    simulation: Table = {"duration": duration, "output": rounded(duration / rows, 2)}
    if draws.chance(0.3):
        simulation["tolerance"] = draws.choice([1e-6, 1e-8, 1e-10])
    if draws.chance(0.1):
        columns = _columns(draft)
        column = draws.choice(columns) if columns and draws.chance(0.5) else "t"
        limit = rounded(duration * draws.between(0.4, 0.9), 2) if column == "t" else draws.choice(["0", "1/3", "-pi/4"])
        simulation["until"] = f"{column} {draws.choice(['>', '<', '=']) if column != 't' else '>'} {limit}"
    draft.section("simulation").update(simulation)


# ---- outputs ----


def _output(draft: Draft) -> None:
    """An output of a kind that the scene can have, each key from what its type declares."""
    draws = draft.draws
    kind = draws.choice([kind for kind, output in OUTPUTS.items() if all(_possible(draft, key) for key in output.keys)])
    table: Table = {"kind": kind}
    for key in OUTPUTS[kind].keys:
        if key.required or draws.chance(0.5):
            table[key.name] = _value(draft, key, kind)
    draft.section("outputs")[draft.name("outputs")] = table


def _possible(draft: Draft, key: Key) -> bool:
    options: dict[KeyType, Any] = {
        KeyType.BEAM_MARKER: draft.beams,
        KeyType.JOINT: draft.joints,
        KeyType.DRIVE: draft.tables.get("drives"),
        KeyType.SPRING: draft.tables.get("springs"),
    }
    return not key.required or bool(options.get(key.type, True))


def _value(draft: Draft, key: Key, kind: str) -> Any:
    draws = draft.draws
    match key.type:
        case KeyType.MARKER:
            return draws.choice(draft.markers(ground=key.name == "frame"))
        case KeyType.BEAM_MARKER:
            return draws.choice(draft.markers(beams=True))
        case KeyType.MARKER_PAIR:
            apart = [
                (a, b)
                for a in draft.markers(ground=True)
                for b in draft.markers()
                if a != b and draft.position(a) != draft.position(b)
            ]
            return list(draws.choice(_distant(draft, apart)))
        case KeyType.JOINT:
            return draws.choice([*draft.joints])
        case KeyType.DRIVE:
            return draws.choice([*draft.tables["drives"]])
        case KeyType.SPRING:
            return draws.choice([*draft.tables["springs"]])
        case KeyType.POSITIVE:
            return rounded(draws.between(0.2, 1.0) * draft.size, 2)
        case KeyType.QUANTITY:
            return draft.quantity(rounded(0.02 * draft.size * draws.sign(), 2), key.unit)
        case KeyType.CHOICE:
            return draws.choice(key.choices)
        case _:
            raise NotImplementedError(f"the corpus knows no value for the key {key.name} of the output {kind}")


def _distant(draft: Draft, pairs: list[tuple[str, str]]) -> list[tuple[str, str]]:
    """The pairs of markers that are far apart, so that the angle between them exists along the motion."""

    def apart(pair: tuple[str, str]) -> float:
        (x1, y1), (x2, y2) = map(draft.position, pair)
        return max(abs(x1 - x2), abs(y1 - y2))

    return [pair for pair in pairs if apart(pair) > 0.2 * draft.size] or pairs


# ---- plots ----


def _columns(draft: Draft) -> list[str]:
    """The columns of the outputs."""
    columns = []
    for name, table in draft.tables.get("outputs", {}).items():
        columns += [f"{name}_{label}" if label else name for label in OUTPUTS[table["kind"]].labels]
    return columns


def _plots(draft: Draft) -> None:
    draws = draft.draws
    chosen = [beam for beam in draft.beams if "middle" in beam.markers or "inside" in beam.markers]
    if chosen and draws.chance(0.85):
        beam = draws.choice(chosen)
        marker = draws.choice([name for name in beam.markers if name not in ("left", "right")])
        plot: Table = {"deflection": f"{beam.name}.{marker}", "chord": [f"{beam.name}.left", f"{beam.name}.right"]}
        plot["divided_by"] = beam.length
        if draft.tables.get("drives") and draws.chance(0.3):
            plot["over"] = draws.choice([*draft.tables["drives"]])
        _cut(draft, plot)
        if draws.chance(0.1):
            _reference(draft, plot)
        draft.section("plots")[draft.name("plots")] = plot
    columns = _columns(draft)
    if columns and draws.chance(0.4):
        shown = draws.some(columns, 0.6)[:4]
        plot = {"y": shown if len(shown) > 1 or (shown and draws.chance(0.5)) else columns[0]}
        if draws.chance(0.3):
            plot["x"] = draws.choice(["t", *columns])
        if draws.chance(0.1):
            _cut(draft, plot)
        if isinstance(plot["y"], str) and draws.chance(0.15):
            _reference(draft, plot)
        draft.section("plots")[draft.name("plots")] = plot


def _cut(draft: Draft, plot: Table) -> None:
    """Plots of a beam in several numbers of pieces, if it can be cut."""
    draws, bodies = draft.draws, draft.section("bodies")
    for beam in draft.beams:
        table = bodies[beam.name]
        whole = "ends" in table or isinstance(table.get("ansatz"), dict) or "ratio" in table.get("damping", {})
        if not whole and draws.chance(0.05):
            plot["cut"], plot["pieces"] = beam.name, draws.choice([[1, 2], [2], [1, 3]])
            return


def _reference(draft: Draft, plot: Table) -> None:
    draws = draft.draws
    name = f"measured{len(draft.files)}.csv"
    rows = [f"{rounded(0.01 * i / draft.rate, 4):g},{rounded(1e-3 * draws.between(-1, 1), 3):g}" for i in range(12)]
    draft.files[name] = "\n".join(["x_axis,y_axis", *rows]) + "\n"
    plot["reference"] = {"file": name, "x": "x_axis", "y": "y_axis"}
