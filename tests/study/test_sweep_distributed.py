"""A sweep on a local Dask cluster whose workers are killed on purpose."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor, Future
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from sweep_scenes import FLAG, SLIDER, kill_each_third_once, slider

from derive.cli.main import main
from derive.study.sweep import executors
from derive.study.sweep.executors import KILLS
from derive.study.sweep.run import sweep
from derive.study.sweep.samples import grid
from derive.study.sweep.worker import Chunk, Outcome, run_chunk

if TYPE_CHECKING:
    from distributed import LocalCluster

GRID = grid({"EI": [8, 12, 20], "speed": [100, 150, 170]})
OUTPUTS = ("peak", "final:slider_s")


@pytest.fixture(scope="module")
def killed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder in which chunks that kill their worker leave a file."""
    return tmp_path_factory.mktemp("killed")


@pytest.fixture(scope="module")
def cluster(killed: Path) -> Iterator[LocalCluster]:
    """Two worker processes."""
    from distributed import LocalCluster

    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(FLAG, str(killed))
        with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50) as cluster:
            yield cluster


@pytest.mark.long
def test_killed_workers_lose_nothing(cluster: LocalCluster, killed: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from distributed import Client

    expected = sweep(slider(), GRID, OUTPUTS, workers=1)
    monkeypatch.setattr(executors, "run_chunk", kill_each_third_once)
    with Client(cluster) as client:
        result = sweep(slider(), GRID, OUTPUTS, executor=client.get_executor(), chunk=1)
    assert sorted(path.name for path in killed.iterdir()) == ["0", "3", "6"]
    assert result.values.tobytes() == expected.values.tobytes() and not result.failures


class KilledWorkers(Executor):
    """An executor that fails as a Dask client does when the workers of a task end repeatedly, but without delay."""

    def submit(self, function: object, /, chunk: Chunk, *_: object, **__: object) -> Future[tuple[Outcome, ...]]:  # type: ignore[override]
        from distributed import KilledWorker

        future: Future[tuple[Outcome, ...]] = Future()
        if any(sample.number == 7 for sample in chunk.samples):
            future.set_exception(KilledWorker("a task", None, 3))  # type: ignore[arg-type]
        else:
            future.set_result(run_chunk(chunk))
        return future


def test_a_sample_that_kills_its_workers_is_named() -> None:
    result = sweep(slider(), GRID, OUTPUTS, executor=KilledWorkers(), chunk=5)
    assert result.failures == {7: KILLS}
    assert np.isnan(result.values).sum() == len(OUTPUTS)


@pytest.mark.long
def test_the_command_takes_the_address_of_a_scheduler(
    cluster: LocalCluster, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    spec = tmp_path / "slider.toml"
    spec.write_text(SLIDER)
    arguments = ["sweep", str(spec), "--set", "EI=8,12", "--output", "peak", "--out", str(tmp_path)]
    assert main([*arguments, "--scheduler", cluster.scheduler_address]) == 0
    by_cluster = (tmp_path / "slider" / "sweep.csv").read_bytes()
    assert main(arguments) == 0
    assert (tmp_path / "slider" / "sweep.csv").read_bytes() == by_cluster
    capsys.readouterr()
    monkeypatch.setattr("derive.study.sweep.cluster.SECONDS", 1)
    assert main([*arguments, "--scheduler", "tcp://127.0.0.1:1"]) == 2
    assert "no Dask scheduler answers" in capsys.readouterr().err
