"""The benchmarks of scale and of batches run, and their implementations agree; times are not checked."""

from __future__ import annotations

import subprocess
import sys

from conftest import ROOT


def printed(script: str, *options: str) -> list[str]:
    command = [sys.executable, str(ROOT / "bench" / script), *options, "--flags=-O1", "--repeats", "1"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


def test_scale() -> None:
    lines = printed("scale.py", "--sizes", "2", "--data", "dense", "--limit", "60", "--accelerations", "2")
    rows = [line.split() for line in lines if line.startswith("dense")]
    makers = ("casadi", "flat", "table")
    assert [tuple(row[2:4]) for row in rows] == [(i, m) for i in ("mass", "force", "jacobian") for m in makers]
    assert all(float(row[-1]) > 0 for row in rows)
    assert any(line.startswith("straight line, dense 2") for line in lines)
    assert any(line.split()[:2] == ["2", "accel"] for line in lines)


def test_batch() -> None:
    (row,) = (line for line in printed("batch.py", "--models", "beam point 2") if line.startswith("beam"))
    assert len(row.split()) == 9
