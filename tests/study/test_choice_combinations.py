"""Combinations of models of several beams in `tisserand choose`, with errors that are made up."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import pairwise, product

import numpy as np
import pytest
from made_up_choice import (
    BASE,
    FIRST,
    RIGID,
    MadeUpRuns,
    chain,
    decreasing,
    polynomials,
    reference_of,
    sines,
    trials_of,
)

from derive.runtime.compiler import RUN_FLAGS, UNOPTIMISED
from derive.simulation.observables.beams import beam_bodies
from derive.spec.model.markers import MarkerRef
from derive.spec.model.plots import ColumnCurves, Deflection, Plot
from derive.spec.model.scene import Scene
from derive.study.accuracy.ladder_model import LadderModel, mixed
from derive.study.accuracy.measurement import compiled, motion
from derive.study.accuracy.predicted_cost import PredictedCost
from derive.study.accuracy.reference import rms_difference
from derive.study.choice.beam_shares import BeamShare, BeamShares
from derive.study.choice.combinations import combinations
from derive.study.choice.model_runs import ModelRuns
from derive.study.choice.rigid_shares import rigid_shares
from derive.study.choice.search import cheapest_model
from derive.study.choice.several_beams import try_several_beams


def share_table(scene: Scene, *models: LadderModel, seed: int = 1) -> dict[str, list[BeamShare]]:
    """Random shares of the beams."""
    random = np.random.default_rng(seed)
    names = [beam.name for beam in beam_bodies(scene)]
    return {name: [BeamShare(name, model, float(10 ** random.uniform(-4, -2))) for model in models] for name in names}


def test_combinations_are_the_cheapest_for_their_error() -> None:
    """The search returns the combinations that no other beats in both."""
    scene = chain(3)
    cost = PredictedCost(scene)
    for seed in range(5):
        shares = share_table(scene, RIGID, sines(1), sines(2), polynomials(3), polynomials(2, 2), seed=seed)
        found = combinations(scene, shares, 0.01, cost)
        every = []
        for chosen in product(*shares.values()):
            error = float(np.sqrt(sum(of.share**2 for of in chosen)))  # type: ignore[operator]
            if error <= 0.01:
                every.append((cost.operations(mixed({of.beam: of.model for of in chosen})), error))
        best: list[tuple[float, float]] = []
        for operations, error in sorted(every):
            if not best or error < best[-1][1]:
                best.append((operations, error))
        assert [(of.operations, of.error) for of in found] == [pytest.approx(of) for of in best]
        assert all(of.operations == pytest.approx(cost.operations(of.model)) for of in found)


def test_the_work_for_combinations_is_proportional_to_the_beams(monkeypatch: pytest.MonkeyPatch) -> None:
    """Thirty beams with eight models each have 8^30 combinations; the errors and the budget are met."""
    scene = chain(30)
    models = (RIGID, sines(1), sines(2), sines(3), polynomials(3), polynomials(4), polynomials(2, 2), polynomials(3, 2))
    found = combinations(scene, share_table(scene, *models), 0.01, PredictedCost(scene))
    assert 5 < len(found) < 1000
    assert all(cheap.operations < dear.operations and cheap.error > dear.error for cheap, dear in pairwise(found))
    assert combinations(scene, share_table(scene, *models), 1e-6, PredictedCost(scene)) == ()


@pytest.mark.parametrize("beams", [3, 14, 30])
def test_the_beams_that_matter_bend(beams: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Few runs for those that matter, two of them here, and fewer than one for each of the others."""
    matter = {f"b{n}": {0: 0.3, 2: 0.5}.get(n, 1e-5) for n in range(beams)}
    runs = MadeUpRuns(chain(beams), decreasing(matter))
    search = trials_of(monkeypatch, runs, 0.05, reference_of())
    shares = try_several_beams(search, BASE, rigid_shares(runs, 0.05, lambda _: None))
    chosen = search.good[0]
    assert chosen.points[0].rms <= 0.049
    assert search.flexible(chosen.model) == ["b0", "b2"]
    assert chosen.model.of("b0") == sines(1, FIRST) and len(shares) <= beams + 4
    assert len(runs.asked) <= 22 and len({(of.beam, of.model) for of in shares}) == len(shares)


def test_a_beam_without_a_good_model_gets_that_of_the_base(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing else is within the error; shares that vanish do not keep the search going."""

    def errors(model: LadderModel, _: float) -> dict[str, float]:
        return {"b0": 0.0 if model.of("b0") == BASE else 0.4, "b1": 0.0}

    search = trials_of(monkeypatch, MadeUpRuns(chain(2), errors), 0.05, reference_of())
    try_several_beams(search, BASE)
    assert search.good[0].model == mixed({"b0": BASE, "b1": RIGID})


def test_beams_that_matter_share_what_is_left_of_the_error() -> None:
    scene = chain(3)
    runs = MadeUpRuns(scene, decreasing({"b0": 0.3, "b1": 0.001, "b2": 0.5}))
    shares = BeamShares(runs, BASE, PredictedCost(scene))
    targets = shares.targets(0.03)
    left = np.sqrt(0.03**2 - 0.001**2)
    assert targets["b0"] == targets["b2"] == pytest.approx(left / np.sqrt(2))
    shares.refine("b0", targets["b0"])
    assert [of.model for of in shares.of("b0")] == [RIGID, sines(1)]
    shares.refine("b0", targets["b0"], lambda beam, model: model == sines(1))
    assert shares.of("b0")[-1].model == sines(2)


def test_a_plot_of_several_columns_is_a_plot_for_each_of_them() -> None:
    scene = chain(1)
    several = Plot("both", ColumnCurves(("b0_phi", "b0_phidot")))
    runs = ModelRuns(scene, (several,), lambda _: None)
    assert [plot.quantity for plot in runs.bare] == [ColumnCurves(("b0_phi",)), ColumnCurves(("b0_phidot",))]
    curves = runs.curves(RIGID, 1e-3)  # the scene with two plots of one name would be refused
    assert len(curves) == 2 and runs.curves(RIGID, 1e-3) is curves


def test_code_that_is_not_optimised_has_the_same_bits() -> None:
    model, scene = sines(1), chain(1)
    runs = [motion(compiled(scene, model, monitored=False, flags=flags), 1e-6) for flags in (UNOPTIMISED, RUN_FLAGS)]
    assert np.array_equal(runs[0].solution.q, runs[1].solution.q)


@pytest.mark.long
def test_three_beams_of_which_one_bends() -> None:
    """The first and the last are fifty times as stiff; the claim is checked with a finer model than any."""
    scene = chain(3)
    stiff = tuple(
        replace(body, beam=replace(body.beam, bending_stiffness=Fraction(10 if body.name == "b1" else 500)))
        for body in beam_bodies(scene)
    )
    plot = Plot("it", Deflection(MarkerRef("b1", "middle"), (MarkerRef("b1", "left"), MarkerRef("b1", "right")), None))
    simulation = replace(scene.simulation, duration=0.3, output=0.003)  # type: ignore[type-var]
    gravity = (Fraction(0), Fraction(-10))
    scene = replace(scene, bodies=stiff, plots=(plot,), simulation=simulation, gravity=gravity)
    runs = ModelRuns(scene, scene.plots, lambda _: None)
    choice = cheapest_model(runs, 0.05)
    assert choice.chosen is not None
    line, point = choice.chosen
    assert line.model.of("b0") == line.model.of("b2") == RIGID != line.model.of("b1")
    difference = rms_difference(runs.curves(polynomials(4, 2), 1e-8), runs.curves(line.model, point.tolerance))
    assert difference is not None and difference < 0.05
