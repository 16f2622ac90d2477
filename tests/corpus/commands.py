"""Every command on a scene of the corpus, in process, with its streams captured and all that it writes in a folder.

`build` and `simulate` run on every scene, and `simulate` once more with one of the other integrators in turn. Each
scene gets one of the light commands (`LIGHT` and an export), each fourth one of the `HEAVY` ones, and each with an odd
seed `modes`, in rotation over the seeds: 100 scenes run each other integrator 17 times, each light command about 5
times (exports for all platforms, which compile for ten seconds, once), each heavy one 4 times, with options that make
it short, and `modes` 50 times. Studies get what they need, see `studied_scenes.py`.
"""

from __future__ import annotations

import contextlib
import csv
import io
import json
import math
import re
import resource
import signal
import traceback
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from corpus import studied_scenes
from corpus.generator import CorpusScene
from corpus.refusals import refusal
from corpus.spatial_scenes import FIRST
from derive.cli.main import main
from derive.export.registry import INTERFACES
from derive.simulation.integration.registry import INTEGRATORS
from derive.spec.model.instances import identifier

LIMIT = 90.0
"""The longest CPU time of a command, s, without that of compilers; 66 s have been seen where processors are shared."""
LIMIT_OF_CHOICE = 240.0
"""The longest CPU time of `choose`, s, which derives and runs dozens of models."""
SAME = 1e-6
"""The largest distance of positions and quaternions by two integrators, relative to the largest of them above 1."""


@dataclass(frozen=True)
class Finding:
    """Something wrong: the command, a cause by which findings are grouped, and the details."""

    command: str
    cause: str
    text: str


@dataclass
class Outcome:
    """The outcome of a command: its arguments, exit code (None after an exception), streams, and CPU seconds."""

    arguments: list[str]
    code: int | None
    out: str
    error: str
    seconds: float
    files: list[str] = field(default_factory=list)
    exception: str = ""
    cause: str = ""


Arguments = list[str]


def arguments_of(scene: CorpusScene, path: Path, folder: Path) -> Iterator[Arguments]:
    """The commands of a scene."""
    spec, seed = str(path), scene.seed
    yield ["build", spec, "--out", str(folder / "build")]
    yield ["simulate", spec, "--out", str(folder / "simulate"), "--json"]
    yield _simulate(spec, folder, other_integrator(seed), scene)
    if seed % 2 == 1:
        moving = "drives" in scene.tables or (seed % 3 == 0 and "bodies" in scene.tables)
        state = ["--at", f"{_duration(scene) / 3:.6g}"] if moving else []
        yield ["modes", spec, "--out", str(folder / "modes"), *state]
    turn, which = divmod(seed, len(LIGHT) + len(INTERFACES))
    interfaces = (kind if turn % 4 == 0 else kind.removesuffix("-all") for kind in INTERFACES)
    light = [*LIGHT, *map(_export, interfaces)]
    yield light[which](scene, spec, folder)
    if seed % 4 == 0:
        yield HEAVY[seed // 4 % len(HEAVY)](scene, spec, folder)


def _duration(scene: CorpusScene) -> float:
    from fractions import Fraction

    return float(Fraction(scene.tables.get("simulation", {}).get("duration", 1.0)))


def other_integrator(seed: int) -> str:
    """The integrator with which a scene runs besides the default one."""
    others = [name for name in INTEGRATORS if name not in ("adaptive", "scipy")]
    return others[seed % len(others)]


def _simulate(spec: str, folder: Path, integrator: str, scene: CorpusScene) -> Arguments:
    duration = _duration(scene)
    short = (
        ["--duration", f"{duration / 10:.6g}", "--output", f"{duration / 50:.6g}"]
        if "simulation" in scene.tables
        else []
    )
    step = ["--step", f"{duration / 2000:.6g}"] if integrator == "rk4" and "body" in scene.tables else []
    return ["simulate", spec, "--integrator", integrator, "--out", str(folder / integrator), *short, *step]


Command = Callable[[CorpusScene, str, Path], Arguments]


def _export(kind: str) -> Command:
    return lambda scene, spec, folder: ["export", spec, "--to", kind, "--out", str(folder / "export")]


def _report(*more: str) -> Command:
    return lambda scene, spec, folder: ["report", spec, "--out", str(folder / "report" / "page.html"), *more]


def _sweep(scene: CorpusScene, spec: str, folder: Path) -> Arguments:
    name, value = changeable(scene)
    first: Any = next(iter(scene.tables.get("plots", {}).values()), None)
    y = first.get("y") if first else None
    output = f"peak:{y[0]}" if isinstance(y, list) else "peak" if first else f"final:{_column(scene)}"
    values = f"{value:.6g},{1.1 * value:.6g}"
    return [
        "sweep",
        spec,
        "--set",
        f"{name}={values}",
        "--output",
        output,
        "--workers",
        "1",
        "--out",
        str(folder / "sweep"),
    ]


def _stability(scene: CorpusScene, spec: str, folder: Path) -> Arguments:
    at_rest, path = studied_scenes.resting(scene, Path(spec))
    name, value = changeable(at_rest)
    span = f"{0.8 * value:.6g}:{1.2 * value:.6g}:3"
    orders = "first,truncated" if scene.seed >= FIRST else "first,full"  # full terms in space take long to derive
    short = ["--orders", orders, "--shapes", "2", "--pieces", "2", "--sines", "1", "--component-counts", "2"]
    return ["study", "stability", path, "--parameter", f"{name}={span}", *short, "--out", str(folder / "study")]


def _study(*words: str) -> Command:
    return lambda scene, spec, folder: ["study", words[0], spec, *words[1:], "--out", str(folder / "study")]


def _pivots(scene: CorpusScene, spec: str, folder: Path) -> Arguments:
    return ["study", "pivots", spec, "--pieces", "1,2"]


def _frames(scene: CorpusScene, spec: str, folder: Path) -> Arguments:
    return ["study", "frames", spec, "--pieces", "1", "--runs", "1", "--chart", str(folder / "study" / "frames.svg")]


def _accuracy(scene: CorpusScene, spec: str, folder: Path) -> Arguments:
    short = [
        "--shapes",
        "2",
        "--pieces",
        "2",
        "--sines",
        "1",
        "--component-counts",
        "2",
        "--tolerances",
        "1e-4",
        "--runs",
        "1",
    ]
    _, plotted = studied_scenes.plotted(scene, Path(spec))
    return ["study", "accuracy", plotted, "--own-reference", *short, "--out", str(folder / "study")]


def _choose(scene: CorpusScene, spec: str, folder: Path) -> Arguments:
    _, plotted = studied_scenes.plotted(scene, Path(spec))
    return ["choose", plotted, "--error", "0.1", "--out", str(folder / "chosen" / "chosen.toml")]


LIGHT: tuple[Command, ...] = (
    _report(),
    _report("--markdown", "--tex"),
    lambda scene, spec, folder: ["compare", spec, "--picture", str(folder / "compare" / "picture.svg")],
    lambda scene, spec, folder: ["build", spec, "--sensitivities", "--out", str(folder / "sensitivities")],
    _sweep,
    _sweep,
    lambda scene, spec, folder: ["check", spec, "--out", str(folder / "build")],
)
"""Commands of a second or two, with the exports."""

HEAVY: tuple[Command, ...] = (
    _frames,
    _pivots,
    _study("methods", "--steps", "300", "--states", "5"),
    _stability,
    _accuracy,
    _choose,
)
"""The studies, in all forms, and the choice of a model."""


def changeable(scene: CorpusScene) -> tuple[str, float]:
    """A parameter of a scene and its value, or a key with a number."""
    symbols = {name: value for name, value in parameters(scene.tables).items() if value > 0}
    if symbols:
        name = sorted(symbols)[scene.seed % len(symbols)]
        return name, symbols[name]
    for body, table in scene.tables.get("bodies", {}).items():
        for key in ("bending_stiffness", "inertia", "mass"):
            if key in table and not isinstance(table[key], list):
                return f"bodies.{body}.{key}", float(_number(table[key]))
    return "simulation.tolerance", 1e-7


def _number(value: Any) -> float:
    from fractions import Fraction

    return float(Fraction(value))


def parameters(tables: Any) -> dict[str, float]:
    """All parameters of a specification with their defaults, wherever they are written."""
    result: dict[str, float] = {}
    if isinstance(tables, dict):
        if "symbol" in tables:
            result[tables["symbol"]] = _number(tables.get("default", 1.0))
        for name, table in tables.get("parameters", {}).items():
            result[name] = _number(table["default"])
        for value in tables.values():
            result |= parameters(value)
    if isinstance(tables, list):
        for value in tables:
            result |= parameters(value)
    return result


def _column(scene: CorpusScene) -> str:
    bodies = scene.tables.get("bodies", {"beam": {}})
    beams = {name: table for name, table in bodies.items() if "length" in table}  # rigid ones may be carried by a drive
    name, table = next(iter((beams or bodies).items()))
    return identifier(name, "1" if table.get("pieces", 1) != 1 else "", "phi")


# ---- running ----


class TooLong(BaseException):
    """A command has taken more than LIMIT."""


def run(arguments: Arguments, folder: Path) -> Outcome:
    """Run a command; warnings of Python and NumPy go to the captured standard error."""
    out, error = io.StringIO(), io.StringIO()
    before, started = _files(folder), cpu()
    code, exception, why = None, "", ""

    def stop(*_: Any) -> None:
        raise TooLong

    old = signal.signal(signal.SIGPROF, stop)
    limit = LIMIT_OF_CHOICE if arguments[0] == "choose" else LIMIT
    signal.setitimer(signal.ITIMER_PROF, limit)
    try:
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(error), warnings.catch_warnings():
            warnings.simplefilter("always")
            code = main(arguments)
    except SystemExit as stopped:
        code = stopped.code if isinstance(stopped.code, int) else 1
    except TooLong:
        exception, why = f"more than {limit:g} s", "too long"
    except Exception as failure:
        exception, why = traceback.format_exc(limit=-6), cause(failure)
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, old)
    new = sorted(_files(folder) - before)
    return Outcome(arguments, code, out.getvalue(), error.getvalue(), cpu() - started, new, exception, why)


def cause(failure: Exception) -> str:
    """The type of an exception and where it was raised in the package."""
    frames = [frame for frame in traceback.extract_tb(failure.__traceback__) if "/derive/" in frame.filename]
    at = f" in {frames[-1].filename.rpartition('/derive/')[2]}:{frames[-1].name}" if frames else ""
    return f"{type(failure).__name__}{at}: {general(str(failure))}"


def general(text: str) -> str:
    """A message without names and numbers, so that those of one cause are alike."""
    text = re.sub(r"\S*/", "", text)
    text = re.sub(r'"[^"]*"', '"..."', text)
    text = re.sub(r"[-+]?\d[\d.]*(e[-+]?\d+)?", "#", text)
    return re.sub(r"\b\w+\.\w+(\.\w+)*\b", "a.b", text)[:160]


def cpu() -> float:
    own, children = resource.getrusage(resource.RUSAGE_SELF), resource.getrusage(resource.RUSAGE_CHILDREN)
    return own.ru_utime + own.ru_stime + children.ru_utime + children.ru_stime


def _files(folder: Path) -> set[str]:
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}


# ---- judging ----


def findings(scene: CorpusScene, outcome: Outcome, folder: Path) -> Iterator[Finding]:
    """Yield the findings on the outcome of a command."""
    name = " ".join(word for word in outcome.arguments[:2] if "/" not in word)
    if "--to" in outcome.arguments or "--integrator" in outcome.arguments:
        name += (
            " "
            + outcome.arguments[outcome.arguments.index("--to" if "--to" in outcome.arguments else "--integrator") + 1]
        )
    if outcome.exception:
        yield Finding(name, outcome.cause, outcome.exception)
        return
    if outcome.code == 0:
        reports = outcome.arguments[0] in ("study", "choose")  # which write a line for each model
        unexpected = [
            line for line in outcome.error.splitlines() if ": note: the linkage cannot be turned through" not in line
        ]
        if unexpected and not (reports and "Warning" not in outcome.error):
            yield Finding(name, f"standard error after success: {general(unexpected[0])}", outcome.error)
        if not outcome.out.strip():
            yield Finding(name, "no output after success", "")
        yield from _wrong_files(name, outcome, folder)
        if outcome.arguments[0] == "simulate" and "--json" in outcome.arguments:
            yield from _silent_changes(name, scene, json.loads(outcome.out), folder)
    elif outcome.code == 2:
        if outcome.files:
            yield Finding(name, "files written by a command that failed", " ".join(outcome.files))
        if not outcome.error.strip():
            yield Finding(name, "no message with exit code 2", "")
        elif refusal(outcome.error) is None:
            last = outcome.error.strip().splitlines()[-1]
            yield Finding(name, f"refused: {general(last)}", outcome.error)
    elif not (outcome.code == 1 and outcome.arguments[0] == "choose" and "no model" in outcome.out):
        yield Finding(name, f"exit code {outcome.code}", outcome.out[-2000:] + outcome.error[-2000:])


def _wrong_files(name: str, outcome: Outcome, folder: Path) -> Iterator[Finding]:
    """Findings on files: listed ones that are missing, empty ones, and numbers that are none."""
    for file in outcome.files:
        path = folder / file
        if not path.stat().st_size and path.name != "py.typed":
            yield Finding(name, "an empty file", file)
        if path.suffix == ".json":
            try:
                json.loads(path.read_text(), parse_constant=_no_constant)
            except ValueError as error:
                yield Finding(name, f"JSON: {general(str(error))}", file)
        known = "without values (nan)" in outcome.out  # a sweep tells of samples that failed
        if path.suffix == ".csv" and re.search(r"\b(nan|inf)\b", path.read_text()) and not known:
            yield Finding(name, "a CSV file with nan or inf", file)
    if outcome.arguments[0] in ("build", "simulate", "modes", "export", "report", "sweep") and not outcome.files:
        yield Finding(name, "no files after success", outcome.out)


def other_motions(seed: int, folder: Path) -> Iterator[Finding]:
    """A finding if the other integrator of a scene in space moves bodies elsewhere than the default one.

    Its run is shorter, see `_simulate`; its last row is one of both tables. A run that notes its coarse step
    says itself that it is wrong.
    """
    name = other_integrator(seed)
    if any("is too coarse" in note for path in (folder / name).rglob("*.json") for note in _notes(path)):
        return
    tables = [next(iter(sorted((folder / of).rglob("*.csv"))), None) for of in ("simulate", name)]
    if None in tables:
        return  # one of them is refused
    default, other = ([*csv.DictReader(_rows(table))] for table in tables if table)
    end = float(other[-1]["t"])
    row = min(default, key=lambda of: abs(float(of["t"]) - end))
    poses = [column for column in row if re.search(r"_[ce]\d$", column)]
    size = max([1.0, *(abs(float(row[column])) for column in poses)])
    worst = max((abs(float(row[column]) - float(other[-1][column])) for column in poses), default=0.0) / size
    if not math.isclose(float(row["t"]), end, rel_tol=1e-9) or not worst < SAME:
        yield Finding(f"simulate --integrator {name}", "not the motion of the default", f"t = {end:g}: {worst:.2g}")


def _notes(record: Path) -> list[str]:
    return list(json.loads(record.read_text()).get("notes", []))


def _rows(table: Path) -> list[str]:
    return [line for line in table.read_text().splitlines() if not line.startswith("#")]


def _no_constant(text: str) -> None:
    raise ValueError(f"{text} is no JSON")


def _silent_changes(name: str, scene: CorpusScene, summary: dict[str, Any], folder: Path) -> Iterator[Finding]:
    """Differences between what is written and what was computed of which no line tells."""
    simulation = scene.tables["simulation"]
    if not math.isclose(summary["duration"], _number(simulation["duration"]), rel_tol=1e-12):
        yield Finding(name, "another duration", str(summary["duration"]))
    (table,) = (folder / "simulate").rglob("*.csv")
    lines = _rows(table)
    end = float(lines[-1].split(",")[0])
    if "until" not in simulation and not math.isclose(end, summary["duration"], rel_tol=1e-9):
        yield Finding(name, "the table ends before the duration", f"{end} {summary['duration']}")
    run = next(run for run in summary["runs"] if run.get("notes") is not None)
    notes = "\n".join([*run["notes"], *summary["warnings"]])
    for value in run.get("initial_values", []):
        size = max(1.0, abs(value["specified"]))
        if not value["guess"] and abs(value["value"] - value["specified"]) > 1e-9 * size and value["name"] not in notes:
            yield Finding(name, "an initial value that no line says to be changed", str(value))
