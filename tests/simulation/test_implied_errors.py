"""Errors that monitors imply, against converged models: a part of `bench/monitors.py`."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from conftest import ROOT

NAMES = ("struck_1_4_1_1", "step_0_5", "column_m2_0", "slider_150")


@pytest.mark.long
def test_estimates_are_within_a_factor_of_the_truth(monkeypatch: pytest.MonkeyPatch) -> None:
    """The median and 80 % within 2, and 90 % within 4, of models of four scenes of different kinds."""
    monkeypatch.syspath_prepend(str(ROOT / "bench"))
    import monitor_scenes
    import monitors

    try:
        ratios = []
        for scene in monitor_scenes.scenes():
            if scene.name in NAMES:
                known = [row for row in monitors.rows(scene) if "rms" in row]
                ratios += [
                    min(monitors.implied(row)[0], 1.0) / min(row["rms"], 1.0) for row in known if monitors.reliable(row)
                ]
        assert len(ratios) > 40
        assert 0.5 < np.median(ratios) < 2
        off = np.abs(np.log(ratios))
        assert np.mean(off < np.log(2)) > 0.8 and np.mean(off < np.log(4)) > 0.9
    finally:
        for name in ("monitor_scenes", "monitors"):
            sys.modules.pop(name, None)
