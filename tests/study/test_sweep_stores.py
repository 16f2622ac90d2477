"""Stores of sweeps: interrupted, damaged, shared and stale ones."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from pathlib import Path

import pytest
from sweep_scenes import slider
from test_sweep import GRID, OUTPUTS, same

from derive.spec.set_values import with_values
from derive.study.sweep.run import sweep
from derive.study.sweep.samples import grid
from derive.study.sweep.store import SampleStore, StaleStore


def interrupted(store: Path, threads: Executor, after: int = 4) -> None:
    """Leave a store with so many finished samples."""

    def progress(finished: int, total: int) -> None:
        if finished >= after:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sweep(slider(), GRID, OUTPUTS, executor=threads, chunk=1, store=store, progress=progress)


def test_an_interrupted_sweep_goes_on(tmp_path: Path, threads: Executor) -> None:
    store, expected = tmp_path / "store", sweep(slider(), GRID, OUTPUTS, executor=threads)
    interrupted(store, threads)
    with store.open("ab") as file:
        file.write(b'{"n": 8, "v": ["0x1.')  # the process was killed while it wrote
    with pytest.raises(StaleStore, match="4 finished samples; continue it with --resume"):
        sweep(slider(), GRID, OUTPUTS, executor=threads, store=store)
    result = sweep(slider(), GRID, OUTPUTS, executor=threads, store=store, resume=True)
    assert result.resumed == 4 and same(result, expected)
    again = sweep(slider(), GRID, OUTPUTS, executor=threads, store=store, resume=True)
    assert again.resumed == 9 and same(again, expected)


@pytest.mark.parametrize(
    "damage",
    [
        lambda line: b'{"n": 1}',
        lambda line: b"[]",
        lambda line: b"\xff\x00" + line,
        lambda line: line[: len(line) // 2],
        lambda line: line.replace(b"0x1.", b"0x1.1"),
    ],
    ids=["no values", "a list", "bytes", "half a line", "another number"],
)
def test_a_damaged_line_is_left_out_and_its_sample_computed_again(
    damage: Callable[[bytes], bytes], tmp_path: Path, threads: Executor
) -> None:
    store, expected = tmp_path / "store", sweep(slider(), GRID, OUTPUTS, executor=threads)
    interrupted(store, threads)
    head, first, second, *rest = store.read_bytes().splitlines()
    assert damage(second) != second
    store.write_bytes(b"".join(line + b"\n" for line in (head, first, damage(second), *rest)))
    result = sweep(slider(), GRID, OUTPUTS, executor=threads, store=store, resume=True)
    assert (result.resumed, result.damaged) == (3, 1) and same(result, expected)


def test_two_sweeps_do_not_write_to_one_store(tmp_path: Path) -> None:
    store = SampleStore(tmp_path / "store", {}, resume=False)
    with pytest.raises(StaleStore, match="another sweep writes there"):
        SampleStore(tmp_path / "store", {}, resume=True)
    store.close()
    assert SampleStore(tmp_path / "store", {}, resume=True).finished == ()


@pytest.mark.parametrize("part", ["the specification", "the samples", "the outputs"])
def test_a_stale_store_is_refused(part: str, tmp_path: Path, threads: Executor) -> None:
    store = tmp_path / "store"
    interrupted(store, threads)
    before = store.read_bytes()
    scene, samples, outputs = slider(), GRID, OUTPUTS
    match part:
        case "the specification":
            scene, _ = with_values(scene, {"simulation.tolerance": "1e-7"})
        case "the samples":
            samples = grid({"EI": [8, 12, 20], "speed": [100, 150, 171]})
        case "the outputs":
            outputs = OUTPUTS[1:]
    with pytest.raises(StaleStore, match=f"{part} changed"):
        sweep(scene, samples, outputs, executor=threads, store=store, resume=True)
    assert store.read_bytes() == before
    store.write_text("something else\n")
    with pytest.raises(StaleStore, match="no store of a sweep"):
        sweep(slider(), GRID, OUTPUTS, executor=threads, store=store, resume=True)
