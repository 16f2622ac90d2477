"""The benchmarks of scale, batches and integration run, and their implementations agree; times are not checked."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from conftest import ROOT
from derive.lowering.elimination_orders import EliminationRule, work
from derive.spec.model.body import DisplacementOrder


def printed(script: str, *options: str) -> list[str]:
    command = [sys.executable, str(ROOT / "bench" / script), *options, "--flags=-O1", "--repeats", "1"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


@pytest.mark.long
def test_scale() -> None:
    lines = printed("scale.py", "--sizes", "2", "--data", "dense", "--limit", "60", "--accelerations", "2")
    rows = [line.split() for line in lines if line.startswith("dense")]
    makers = ("casadi", "flat", "loops")
    assert [tuple(row[2:4]) for row in rows] == [(i, m) for i in ("mass", "force", "jacobian") for m in makers]
    assert all(float(row[-1]) > 0 for row in rows)
    assert any(line.startswith("straight line, dense 2") for line in lines)
    assert any(line.split()[:2] == ["2", "accel"] for line in lines)


def test_cables_of_exudyn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its rod is ours: four cables with 1000 steps agree with the reference to 0.2 %."""
    monkeypatch.syspath_prepend(str(ROOT / "bench"))
    exudyn, cables = import_module("exudyn"), import_module("exudyn_cables")
    exudyn.config.printToConsole = False
    mechanism, angles, known = cables.crank_slider()
    seconds, sensors = cables.solve(exudyn, mechanism, 4, 1000, 1000)
    rms, largest = cables.errors(mechanism, sensors, angles, known)
    assert seconds > 0 and len(sensors) == 3 and 1.5e-3 < rms < 2.2e-3 and largest < 6e-3


@pytest.mark.long
def test_coordinates() -> None:
    """A crank-slider of rigid bodies has four velocities for eight, and less than half the non-zeros."""
    rows = [line.split(" | ") for line in printed("coordinates.py", "--only", "spatial_crank_slider_rigid")]
    relative, absolute = (row for row in rows if row[0].startswith("| spatial_crank_slider_rigid"))
    assert [relative[2:4], absolute[2:4]] == [["4", "3"], ["8", "7"]]
    assert 2 * int(relative[4]) < int(absolute[4]) and int(relative[5]) < int(absolute[5])


@pytest.mark.long
def test_lowerings() -> None:
    """The values of both lowerings agree, or the script fails; the loops are chosen by prediction, not by times."""
    rows = [line.split(" | ") for line in printed("lowerings.py", str(ROOT / "scenes/four_bar.toml"), "--chains", "6")]
    chosen = {row[0].removeprefix("| "): row[-1].removesuffix(" |") for row in rows if len(row) > 5}
    assert {name: chosen[name] for name in ("weld_6", "revolute_6", "four_bar")} == {
        "weld_6": "instances",
        "revolute_6": "instances",
        "four_bar": "flat",
    }


@pytest.mark.long
def test_python_calls() -> None:
    """All compute the same forces, or the script fails."""
    options = ["--frames", "point", "--states", "5", "--rounds", "1", "--calls", "5"]
    command = [sys.executable, str(ROOT / "bench" / "python_calls.py"), *options]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    names = [line[2:28].strip() for line in done.stdout.splitlines() if line.startswith("  ")]
    assert names[0] == "Tisserand, C, out=" and {"CasADi, buffer", "lambdify, numpy"} < set(names)


@pytest.mark.long
def test_adaptive() -> None:
    """The integrator in C and SciPy take the same steps."""
    command = [sys.executable, str(ROOT / "bench" / "adaptive.py"), "--beams", "1", "--rows", "20", "--runs", "1"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    beams, own, scipy, *_ = done.stdout.splitlines()[-1].split()
    assert beams == "1" and int(own) == int(scipy) > 50


@pytest.mark.long
def test_all_rows_of_speed() -> None:
    """Each row has its figures, and the ratio that follows from them; times are not checked."""
    command = [sys.executable, str(ROOT / "bench" / "all.py"), "--quick", "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    printed = json.loads(done.stdout)
    assert {"machine", "compiler", "python", "flags"} < printed.keys() and printed["quick"]
    rows = printed["rows"]
    every = {"beam_accelerations", "constant_elimination", "loops_by_hand", "python_calls"}
    every |= {"space_mechanisms", "tool_speed"}
    assert {row["module"] for row in rows} >= every
    assert len({(row["name"], row["peer_name"]) for row in rows}) == len(rows)
    for row in rows:
        assert row["ours_ns"] > 0 or row["unit"] == "1", row
        against = row["hand_ns"] or row["peer_ns"]
        assert (row["ratio"] is None) == (against is None) and bool(row["peer_ns"]) == bool(row["peer_name"]), row
        figure = row["ratio"] if row["unit"] == "ns" else row["ours_ns"]
        assert against is None or row["ratio"] == pytest.approx(row["ours_ns"] / against)
        assert row["met"] == (None if None in (figure, row["goal"]) else figure <= row["goal"]), row


def test_a_benchmark_that_fails_is_a_row(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "bench"))
    every, calls = import_module("all"), import_module("python_calls")

    def fails() -> None:
        raise ArithmeticError("other values")

    monkeypatch.setattr(calls, "rows", fails)
    assert every.main(["--json", "--only", "python_calls"]) == 1
    (row,) = json.loads(capsys.readouterr().out)["rows"]
    assert row["error"] == "ArithmeticError: other values" and row["met"] is None


@pytest.mark.long
def test_sweep() -> None:
    command = [sys.executable, str(ROOT / "bench" / "sweep.py"), "--side", "2", "--workers", "1"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "2 initial states" in done.stdout and "4 samples, 1 workers: " in done.stdout.splitlines()[-1]


@pytest.mark.long
def test_batch() -> None:
    (row,) = (line for line in printed("batch.py", "--models", "beam point 2") if line.startswith("beam"))
    assert len(row.split()) == 9


@pytest.mark.long
def test_order_cost() -> None:
    """The program times what it counts, and its `accel` succeeds in all states."""
    command = [sys.executable, str(ROOT / "bench/order_cost.py"), "--shapes", "1", "--frames", "mean", "--runs", "1"]
    done = subprocess.run([*command, "--flags=-O1"], capture_output=True, text=True, check=True)
    size, cost = (
        [cell.strip() for cell in line.split("|")[1:-1]]
        for line in done.stdout.splitlines()
        if line.startswith("| mean | 1 |")
    )
    assert size == ["mean", "1", *("4", "4", "4"), *("5", "7", "9")]
    assert cost[:8] == ["mean", "1", *("10", "10", "51"), *("11", "13", "57")]
    assert len(cost) == 11 and all(float(ns) > 0 for ns in cost[8:])


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> tuple[Any, Any]:
    """The modules of the frames at second order, with one shape."""
    monkeypatch.syspath_prepend(str(ROOT / "bench"))
    second_order = import_module("second_order")
    monkeypatch.setattr(second_order, "SHAPES", 1)
    return second_order, import_module("second_order_page")


OF_PAGE = [(frame, order) for frame in ("chord", "mean", "point", "tangent") for order in DisplacementOrder]
"""The models of the page of frames; the counts of the first one take a third of a second, of others up to two."""


@pytest.mark.parametrize(
    ("frame", "order"), [OF_PAGE[0], *(pytest.param(*model, marks=pytest.mark.long) for model in OF_PAGE[1:])]
)
def test_the_counts_of_the_page_of_frames_are_those_of_the_models(
    frame: str, order: DisplacementOrder, bench: tuple[Any, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    second_order, page = bench
    monkeypatch.setattr(second_order, "SHAPES", 3)
    (of,) = (of for of in second_order.FRAMES if of.kind == frame)
    models = second_order.models(second_order.equations_of(second_order.crank_slider(of, order)))
    safe, best = (models[rule][1] for rule in EliminationRule)
    assert page.counts_text(frame, order, safe, best) in page.PAGE.read_text(encoding="utf-8")


def test_the_page_of_frames_says_of_each_elimination_order_whether_it_is_safe(bench: tuple[Any, Any]) -> None:
    second_order, page = bench
    scene = second_order.crank_slider(second_order.FRAMES[1], DisplacementOrder.TRUNCATED)
    found = []
    for model, counts in second_order.models(second_order.equations_of(scene)).values():
        kkt = model.kkt
        assert kkt is not None and work(kkt.pattern, kkt.order) == counts.flops
        found.append(second_order.Elimination(counts, second_order.is_safe(kkt, counts.coordinates), 0, 1e-7))
    assert [order.safe for order in found] == [True, False]
    row = second_order.Row("chord", DisplacementOrder.TRUNCATED, 7e-4, 0.5, *found)
    rows = [row, replace(row, frame="mean", best=row.safe)]
    last = [line.split("|")[-2].strip() for line in page.cost_table(rows).splitlines()[2:]]
    assert last == ["not safe; none vanish here", "safe"]
    assert "not safe in every state" in page.page(rows).replace("**", "").replace("\n", " ")
    assert "| chord | second, truncated | 0.07 % | 0.500 |" in page.accuracy_table(rows)
    assert "<svg" in page.picture(rows)


@pytest.mark.long
def test_chains(tmp_path: Path) -> None:
    """Straight line, instances and CasADi agree in single calls and batches, or the script fails."""
    figures = tmp_path / "figures.json"
    printed("chains.py", "--counts", "1", "2", "3", "--json", str(figures))
    rows = json.loads(figures.read_text())["figures"]
    assert [(row["count"], row["form"]) for row in rows] == [
        (n, form) for n in (1, 2, 3) for form in ("instances", "flat", "casadi")
    ]
    for row in rows:
        assert row["compiler"] > 0 and row["ns"] > 0 and 0 <= row["tables"] < row["size"]
        assert (row["batch_ns"] is None) == (row["form"] == "casadi") == (row["tables"] == 0)


@pytest.mark.long
def test_rings() -> None:
    (row,) = (line.split("|") for line in printed("rings.py", "--counts", "5") if line.startswith("| 5 "))
    assert float(row[2]) > 0


def test_chains_refuse_other_values(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "bench"))
    chains = import_module("chains")
    same = chains.TimedCall("same", "for (int i = 0; i < 5; i++) out[i] = q[5 * s + i];", 5)
    other = chains.TimedCall("other", "for (int i = 0; i < 5; i++) out[i] = q[5 * s + i] * (1 + 1e-11);", 5)
    arrays = dict(zip(("q", "v"), chains.states(1, 2), strict=True))
    program = chains.Program()
    assert program.times([(same, 1), (same, 1)], arrays, tmp_path, 1)["same"] > 0
    with pytest.raises(ArithmeticError, match=re.escape("other of 1 beams is off by 1.0e-11")):
        program.times([(same, 1), (other, 1)], arrays, tmp_path, 1)


def test_the_tables_of_chains_are_those_of_their_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "bench"))
    page, runs = import_module("chain_page"), import_module("chain_run")
    run = runs.read_run(page.FIGURES)
    readme = page.README.read_text()
    assert page.with_tables(readme, run) == readme
    picture = page.picture(run.figures)
    assert "<svg" in picture and all(name in picture for name in ("straight line", "instances", "CasADi"))
