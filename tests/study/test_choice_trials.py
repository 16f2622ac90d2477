"""The models that `tisserand choose` tries of a lone beam, with errors that are made up."""

from __future__ import annotations

from dataclasses import replace

import pytest
from made_up_choice import (
    BASE,
    FIRST,
    FULL,
    RIGID,
    TRUNCATED,
    MadeUpRuns,
    MadeUpTrials,
    chain,
    clamped,
    decreasing,
    polynomials,
    reference_of,
    sines,
    trials_of,
)

from conftest import ROOT
from derive.simulation.observables.beams import beam_bodies
from derive.simulation.validity.monitors import Cause, Monitor
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.specification import AnyScene
from derive.spec.toml.read import read
from derive.study.accuracy.ladder_model import LadderModel, Shapes, mixed
from derive.study.accuracy.predicted_cost import PredictedCost
from derive.study.choice import one_beam, trials
from derive.study.choice.body_candidates import candidates, cannot_do, suits
from derive.study.choice.modes_of_bodies import ModesOfBodies
from derive.study.choice.one_beam import try_one_beam
from derive.study.choice.search import cheapest_model
from derive.study.choice.several_beams import try_several_beams
from derive.study.choice.trials import Trials


def test_shapes_that_suit_the_ends_come_first() -> None:
    assert suits(sines(1), frozenset()) and not suits(sines(1), frozenset({1}))
    assert suits(clamped(1), frozenset({-1})) and not suits(clamped(1), frozenset({-1, 1}))
    assert not suits(polynomials(2), frozenset({-1})) and suits(polynomials(2), frozenset({-1, 1}))
    assert suits(polynomials(3), frozenset()) and suits(polynomials(2, 2), frozenset()) and suits(RIGID, frozenset())
    scene = chain(1)
    models = candidates(scene, beam_bodies(scene)[0], PredictedCost(scene), ModesOfBodies(scene))
    assert models[:3] == (RIGID, sines(1), sines(2)) and models[-1].shapes is not Shapes.SINES
    assert models.index(polynomials(3)) < models.index(polynomials(1)) < models.index(clamped(4))


def test_errors_of_a_kind_rule_out_others_of_it() -> None:
    errors = {polynomials(2): 0.2, sines(1): 0.3, sines(2): 0.3, sines(3): 0.25, sines(1, FULL): 0.5}
    assert cannot_do(polynomials(1), errors, 0.1) and not cannot_do(polynomials(1), errors, 0.15)
    assert not cannot_do(polynomials(3), errors, 0.1) and not cannot_do(polynomials(1, 2), errors, 0.1)
    assert cannot_do(sines(4), errors, 0.1)  # two shapes more have not helped
    several = {polynomials(2, 1): 0.9, polynomials(2, 2): 0.9}
    assert cannot_do(polynomials(2, 3), several, 0.1) and not cannot_do(polynomials(3, 3), several, 0.1)
    assert not cannot_do(polynomials(2, 3), several, 0.13)  # 0.9 (2/3)^4 is within 1.5 times it
    assert not cannot_do(sines(4), errors | {sines(3): 0.2}, 0.1) and not cannot_do(sines(2, FULL), errors, 0.1)


@pytest.mark.parametrize(("best", "tried"), [(0.16, [1, 8]), (0.05, [1, 8, 2, 3])], ids=["hopeless", "good"])
def test_the_most_modes_tell_whether_fewer_need_a_trial(
    best: float, tried: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Free modes of a body that joints hold stagnate: two models show it, where five were tried."""
    scene = read(ROOT / "examples" / "spatial_crank_slider.toml")
    assert isinstance(scene, AnyScene)

    def errors(model: LadderModel, _: float) -> dict[str, float]:
        of_free = best if model.count > 2 else 0.6
        return {"rod": {Shapes.FREE: of_free, Shapes.RIGID: 0.9}.get(model.shapes, 0.5 / (1 + model.count))}

    runs = MadeUpRuns(scene, errors)
    try_one_beam(trials_of(monkeypatch, runs, 0.08, reference_of((LadderModel(Shapes.CRAIG_BAMPTON, 6), 0.05))))
    assert [model.count for model in runs.asked if model.shapes is Shapes.FREE] == tried
    assert runs.asked[:2] == [RIGID, LadderModel(Shapes.CRAIG_BAMPTON, 6)], "what is derived already comes first"


def test_a_lone_beam_gets_the_cheapest_shapes_and_first_order_where_it_is_good(monkeypatch: pytest.MonkeyPatch) -> None:
    """Models that the reference has shown to be wrong are not derived, nor any that is predicted to be dearer."""

    def errors(model: LadderModel, _: float) -> dict[str, float]:
        return {"b0": {Shapes.SINES: 0.01, Shapes.RIGID: 0.5}.get(model.shapes, 0.2)}

    runs = MadeUpRuns(chain(1), errors)
    search = trials_of(monkeypatch, runs, 0.1, reference_of((sines(1), 0.2)))
    try_one_beam(search)
    assert runs.asked == [RIGID, polynomials(3), sines(2), sines(2, FIRST)]
    assert search.good[0].model == sines(2, FIRST)


def test_nothing_is_truncated_where_truncation_limits_the_error(monkeypatch: pytest.MonkeyPatch) -> None:
    def errors(model: LadderModel, _: float) -> dict[str, float]:
        return {"b0": 0.01 if model.order is FULL else 0.12}

    runs = MadeUpRuns(chain(1), errors)
    search = trials_of(monkeypatch, runs, 0.05, reference_of(truncation=0.1))
    try_one_beam(search)
    assert search.good[0].model == sines(1, FULL)
    assert len(runs.asked) < 8 and not any(model.pieces > 1 for model in runs.asked)
    small = trials_of(monkeypatch, MadeUpRuns(chain(1), errors), 0.05, reference_of(truncation=0.01))
    try_one_beam(small)
    assert not small.good and all(line.model.order is not FULL for line in small.lines)


@pytest.mark.parametrize(("of_first", "shapes"), [(0.13, 4), (0.145, 3)], ids=["decided", "too far off"])
def test_a_reference_that_leaves_open_whether_a_cheaper_model_is_good_is_refined(
    of_first: float, shapes: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At 15 % the crank-slider got second order, which is dearer: 12 % of first order and 2.7 % of the reference."""

    def errors(model: LadderModel, _: float) -> dict[str, float]:
        few = 0.025 if model.shapes is Shapes.POLYNOMIALS and model.count < 3 else 0.0
        return {"b0": 0.5 if model == RIGID else of_first if model.order is FIRST else few}

    runs, lines = MadeUpRuns(chain(1), errors), list[str]()
    monkeypatch.setattr(trials, "measured", MadeUpTrials(runs).measured)
    monkeypatch.setattr(Trials, "timed", lambda self: self.lines)
    choice = cheapest_model(runs, 0.15, lines.append)
    assert choice.chosen is not None and choice.reference.model == polynomials(shapes, 2)
    assert (choice.chosen[0].model == sines(1, FIRST)) == (shapes == 4)
    reason = "with an error of 2.5 % it leaves open whether 1 sine, first is good, and is refined"
    assert any(line.endswith(reason) for line in lines) == (shapes == 4)
    assert choice.chosen[1].rms + choice.reference.error <= 0.15


def test_full_variants_of_models_of_the_reference_are_no_candidates(monkeypatch: pytest.MonkeyPatch) -> None:
    """A full model of four shapes and three twists took 46 s of 140 s, and was no better."""
    runs = MadeUpRuns(chain(1), lambda model, _: {"b0": 0.12})
    search = trials_of(monkeypatch, runs, 0.05, reference_of((polynomials(6), 0.09), truncation=0.1))
    try_one_beam(search)
    assert sines(1, FULL) in runs.asked and polynomials(6, order=FULL) not in runs.asked


def test_a_lone_beam_without_a_good_candidate_gets_a_model_of_the_reference(monkeypatch: pytest.MonkeyPatch) -> None:
    """Full models of beams in pieces are not derived: the search on a rod in space came to no end."""

    def errors(model: LadderModel, tolerance: float) -> dict[str, float]:
        return {"b0": 0.001 if model.pieces > 1 else 0.12 if model.order is TRUNCATED else 0.3}

    def wrong(model: LadderModel, tolerance: float) -> dict[str, float]:
        return {"b0": 0.001 if model in (polynomials(3, 2), polynomials(2, 3)) else 0.12}

    runs, refused = MadeUpRuns(chain(1), errors), Monitor("b0", 1, Cause.BENDING_MOMENT, TRUNCATED, 0.3, 0.2, 0.0)
    measured = MadeUpTrials(
        MadeUpRuns(chain(1), wrong), lambda of: refused if of == polynomials(3, 2) else None
    ).measured
    monkeypatch.setattr(trials, "measured", measured)
    monkeypatch.setattr(Trials, "timed", lambda self: self.lines)
    choice = cheapest_model(runs, 0.1)
    assert choice.chosen is not None and choice.chosen[0].model == polynomials(2, 3)
    full = [line.model for line in choice.tried if line.model.order is FULL]
    assert full and all(model.pieces == 1 for model in full)


def test_a_model_of_a_beam_that_a_monitor_doubts_is_replaced(monkeypatch: pytest.MonkeyPatch) -> None:
    matter = {"b0": 0.003, "b1": 1e-5}
    warning = Monitor("b0", 1, Cause.BENDING_MOMENT, TRUNCATED, 0.3, 0.2, 0.0)

    def implied(model: LadderModel) -> Monitor | None:
        return warning if model.of("b0").shapes is Shapes.SINES else None

    runs = MadeUpRuns(chain(2), decreasing(matter))
    search = trials_of(monkeypatch, runs, 0.002, reference_of(), implied=implied)
    try_several_beams(search, BASE)
    assert mixed({"b0": sines(1), "b1": RIGID}) in search  # within the error, and doubted
    assert mixed({"b0": polynomials(3, order=FIRST), "b1": RIGID}) == search.good[0].model


@pytest.mark.parametrize(("cause", "sure"), [(Cause.BENDING_MOMENT, False), (Cause.TWISTING_MOMENT, True)])
def test_more_shapes_of_torsion_do_not_help_a_beam_whose_bending_is_doubted(
    cause: Cause, sure: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A third of the models of a fork with two legs were derived and run for nothing."""
    warning = Monitor("b0", 1, cause, TRUNCATED, 0.3, 0.2, 0.0)
    runs = MadeUpRuns(chain(2), decreasing({"b0": 0.003, "b1": 1e-5}))
    search = trials_of(monkeypatch, runs, 0.002, reference_of(), implied=lambda _: warning)
    search.run(mixed({"b0": replace(sines(1), torsion=1), "b1": RIGID}))
    assert search.is_doubted("b0", replace(sines(1), torsion=1)) and not search.is_doubted("b1", RIGID)
    assert search.is_doubted("b0", replace(sines(1), torsion=2)) is not sure


def test_more_shapes_of_bending_do_not_help_a_beam_whose_torsion_is_doubted(monkeypatch: pytest.MonkeyPatch) -> None:
    """A rod in space went through all models with one shape of torsion, each of which the same monitor doubted."""
    warning = Monitor("b0", 1, Cause.TWISTING_MOMENT, TRUNCATED, 0.3, 0.2, 0.0)
    runs = MadeUpRuns(chain(1), decreasing({"b0": 0.003}))
    search = trials_of(monkeypatch, runs, 0.002, reference_of(), implied=lambda _: warning)
    search.run(replace(sines(1), torsion=1))
    alike = replace(sines(3), torsion=1), replace(clamped(2), torsion=1), replace(sines(1, FULL), torsion=1)
    assert all(search.is_doubted("b0", model) for model in alike)
    other = replace(sines(3), torsion=2), replace(polynomials(2, 2), torsion=1), RIGID
    assert not any(search.is_doubted("b0", model) for model in other)


@pytest.mark.parametrize("cause", [Cause.DEFLECTION, Cause.MASS_MATRIX])
def test_no_shapes_help_a_piece_that_bends_too_far(cause: Cause, monkeypatch: pytest.MonkeyPatch) -> None:
    """A rod in space went from two sines to four, and the same monitors doubted each."""
    warning = Monitor("b0", 1, cause, TRUNCATED, 0.07, 0.05, 0.0)
    runs = MadeUpRuns(chain(1), decreasing({"b0": 0.003}))
    search = trials_of(monkeypatch, runs, 0.01, reference_of(), implied=lambda _: warning)
    search.run(sines(2))
    assert search.is_doubted("b0", sines(4)) and search.is_doubted("b0", polynomials(5))
    assert not any(search.is_doubted("b0", of) for of in (RIGID, sines(2, FULL), polynomials(2, 2)))
    near = trials_of(monkeypatch, runs, 0.04, reference_of(), implied=lambda _: warning)
    near.run(sines(2))
    assert near.is_doubted("b0", sines(2)) and not near.is_doubted("b0", sines(4)), "within the error nearly"


def test_what_costs_half_of_a_good_model_of_the_reference_or_more_is_not_derived(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Three beams with two shapes took as long to derive as the three with three shapes that were good."""

    def errors(model: LadderModel, _: float) -> dict[str, float]:
        return {"b0": 0.5}

    runs = MadeUpRuns(chain(1), errors)
    good = polynomials(2, 2)
    search = trials_of(monkeypatch, runs, 0.05, reference_of((good, 0.01)))
    try_one_beam(search)
    cost = search.cost.operations
    dear = [model for model in runs.asked if model not in (polynomials(3), RIGID) and cost(model) > cost(good) / 2]
    assert sines(1) in runs.asked and not dear and polynomials(4) not in runs.asked


def test_modes_that_are_hardly_cheaper_are_derived(monkeypatch: pytest.MonkeyPatch) -> None:
    """They take seconds to derive: the rod of a slider-crank got six vibrations where four were good."""
    scene = read(ROOT / "examples" / "spatial_crank_slider.toml")
    assert isinstance(scene, AnyScene)

    def errors(model: LadderModel, _: float) -> dict[str, float]:
        return {"rod": 0.02 if model.shapes is Shapes.CRAIG_BAMPTON and model.count >= 4 else 0.6}

    search = trials_of(monkeypatch, MadeUpRuns(scene, errors), 0.05, reference_of())
    try_one_beam(search)
    four, six = (LadderModel(Shapes.CRAIG_BAMPTON, count) for count in (4, 6))
    assert six in search and search.good[0].model == four
    assert search.cost.operations(four) > one_beam.WORTH * search.cost.operations(six)


def test_a_blade_gets_the_cheap_mode_that_no_monitor_doubts(monkeypatch: pytest.MonkeyPatch) -> None:
    """At 3 % a spinning blade got two beams of 1500 times the operations.

    Models in one piece, which the reference had shown to be good and monitors doubted, ruled out all others. The errors
    are those of that search.
    """
    scene = read(ROOT / "examples" / "spun_up_blade.toml")
    assert isinstance(scene, AnyScene)
    three, two = (replace(polynomials(count), torsion=count - 1) for count in (3, 2))
    in_pieces = [replace(model, pieces=2) for model in (three, two)]
    known = {three: 0.0016, two: 0.0076, in_pieces[0]: 0.0, in_pieces[1]: 0.0011}
    of_kind = {Shapes.CLAMPED_FREE: 0.0068, Shapes.SINES: 0.33, Shapes.RIGID: 0.9}

    def errors(model: LadderModel, _: float) -> dict[str, float]:
        return {"blade": known.get(model, of_kind.get(model.shapes, 0.002))}

    def implied(model: LadderModel) -> Monitor | None:
        warning = Monitor("blade", 1, Cause.TWISTING_MOMENT, TRUNCATED, 0.3, 0.08, 0.0)
        return warning if model.torsion and model != in_pieces[0] else None

    search = trials_of(monkeypatch, MadeUpRuns(scene, errors), 0.03, reference_of(*known.items()), implied=implied)
    try_one_beam(search)
    best = search.good[0].model
    assert (best.shapes, best.count, best.torsion) == (Shapes.CLAMPED_FREE, 1, 0)


def test_what_shapes_of_bending_miss_is_missing_beside_other_shapes_of_torsion() -> None:
    """The ladder of one twist was climbed again with two, and with nothing truncated, from the first sine on."""

    def twisted(count: int, torsion: int, order: DisplacementOrder = TRUNCATED) -> LadderModel:
        return replace(sines(count, order), torsion=torsion)

    errors = {twisted(1, 1): 0.13, twisted(2, 1): 0.063, twisted(3, 1): 0.055}
    assert cannot_do(twisted(1, 2), errors, 0.01) and cannot_do(twisted(1, 1, FULL), errors, 0.01)
    assert not cannot_do(twisted(2, 2), errors, 0.01) and not cannot_do(twisted(3, 2), errors, 0.01)
    assert cannot_do(twisted(4, 1), {**errors, twisted(3, 2): 0.03}, 0.01)  # a twist is missing
    assert not cannot_do(replace(polynomials(2, 2), torsion=1), {**errors, twisted(3, 2): 0.03}, 0.01)


def test_more_full_models_are_not_tried_where_one_is_hardly_better() -> None:
    """Full models of a rod in space took half of the time of a search, which they did not bring further."""
    full = sines(2, FULL)
    few = {sines(2): 0.018, full: 0.032}
    assert cannot_do(sines(3, FULL), few, 0.01) and not cannot_do(sines(3), few, 0.01)
    assert not cannot_do(sines(1, FULL), {sines(2): 0.05, full: 0.012}, 0.01)
    assert not cannot_do(sines(3, FULL), {sines(2): 0.05, full: 0.03}, 0.01)  # it helps
