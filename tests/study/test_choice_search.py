"""The search of `tisserand choose` with errors that are made up: which models it runs, and what it claims."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise, product

import numpy as np
import pytest

from conftest import ROOT
from derive.runtime.compiler import RUN_FLAGS, UNOPTIMISED
from derive.simulation.observables.beams import beam_bodies
from derive.simulation.observables.plots import PlotCurve
from derive.simulation.validity.monitors import Cause, Monitor
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.markers import MarkerRef
from derive.spec.model.plots import ColumnCurves, Deflection, Plot
from derive.spec.model.scene import Scene
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene
from derive.spec.toml.read import parse, read
from derive.study.accuracy.ladder_model import LadderModel, Shapes, mixed
from derive.study.accuracy.measurement import CompiledLadderModel, Curves, Line, Point, compiled, motion
from derive.study.accuracy.modelled_bodies import flexible_members
from derive.study.accuracy.predicted_cost import PredictedCost
from derive.study.accuracy.reference import rms_difference
from derive.study.choice import trials, trusted_reference
from derive.study.choice.beam_shares import BeamShare, BeamShares
from derive.study.choice.body_candidates import candidates, cannot_do, suits
from derive.study.choice.combinations import combinations
from derive.study.choice.full_scene import without_rotary_inertia
from derive.study.choice.model_runs import ModelRuns
from derive.study.choice.modes_of_bodies import ModesOfBodies
from derive.study.choice.one_beam import try_one_beam
from derive.study.choice.rigid_shares import hardly_matter, rigid_shares
from derive.study.choice.search import cheapest_model
from derive.study.choice.several_beams import try_several_beams
from derive.study.choice.trials import Trials
from derive.study.choice.trusted_reference import COARSE, FINE, Agreement, NotConverged, TrustedReference

RIGID = LadderModel(Shapes.RIGID)
TRUNCATED, FULL, FIRST = DisplacementOrder.TRUNCATED, DisplacementOrder.FULL, DisplacementOrder.FIRST_ORDER


def sines(count: int, order: DisplacementOrder = TRUNCATED) -> LadderModel:
    return LadderModel(Shapes.SINES, count, order, "chord")


def clamped(count: int) -> LadderModel:
    return LadderModel(Shapes.CLAMPED_FREE, count, TRUNCATED, "tangent")


def polynomials(count: int, pieces: int = 1, order: DisplacementOrder = TRUNCATED) -> LadderModel:
    return LadderModel(Shapes.POLYNOMIALS, count, order, "mean", pieces)


BASE = polynomials(4)


def chain(beams: int) -> Scene:
    """A chain of beams between pins."""
    lines = ["ground.markers = { pin = [0, 0] }"]
    for n in range(beams):
        before = "ground.pin" if n == 0 else f"b{n - 1}.right"
        lines += [
            f"[bodies.b{n}]\nmass = 1\nlength = 1\nbending_stiffness = {10 + n}",
            "markers = { left = -1, middle = 0, right = 1 }",
            f"start = {{ position = [{n + 0.5}, 0], angle = 0 }}",
            f'[joints.j{n}]\nkind = "revolute"\nbetween = ["{before}", "b{n}.left"]',
        ]
    lines.append("[simulation]\nduration = 1\noutput = 0.01")
    lines.append('[plots.it]\ndeflection = "b0.middle"\nchord = ["b0.left", "b0.right"]')
    scene = parse('name = "chain"\n' + "\n".join(lines))
    assert isinstance(scene, Scene)
    return scene


Errors = Callable[[LadderModel, float], dict[str, float]]
"""The errors of a model in a run with a tolerance, which each beam adds independently, by its name."""


class MadeUpRuns(ModelRuns):
    """Runs whose curves have errors that are made up; asked: the models that were run, once each."""

    def __init__(
        self, scene: AnyScene, errors: Errors, seconds: Callable[[LadderModel], float] = lambda _: 0.1
    ) -> None:
        super().__init__(scene, scene.plots, lambda _: None)
        self.names = [body.name for body in flexible_members(scene)]
        self.errors, self._time = errors, seconds
        self.asked: list[LadderModel] = []

    def compiled(self, model: LadderModel, monitored: bool = True) -> CompiledLadderModel:
        if model not in self.asked:
            self.asked.append(model)
        return model  # type: ignore[return-value]

    def curves(self, model: LadderModel, tolerance: float, monitored: bool = False) -> Curves:
        self.compiled(model, monitored)
        self._seconds[model] = self._time(model)
        errors = self.errors(model, tolerance)
        y = np.array([1.0, *(errors[name] for name in self.names)])
        y[1:] *= np.sqrt(len(y))  # rms
        self._curves[model, tolerance] = (PlotCurve("it", y, y, None),)
        return self._curves[model, tolerance]


# ---- references ----


def converging(model: LadderModel, tolerance: float) -> dict[str, float]:
    """Shapes and beams help, truncation is worst in one beam, and larger steps change most in many beams."""
    shapes = 0.2 * 4.0**-model.count / model.pieces**3
    truncation = 0.004 / model.pieces**2 if model.order is TRUNCATED else 0.0
    steps = 4e-4 * model.pieces if tolerance == COARSE else 0.0
    return {"b0": shapes + truncation + steps}


def test_a_larger_error_needs_no_other_references() -> None:
    """The search goes from dear to cheap; the first reference needs five models, two of a beam for its truncation."""
    asked: dict[float, list[LadderModel]] = {}
    for error in (0.009, 0.01, 0.03, 0.1):
        runs = MadeUpRuns(chain(1), converging)
        known = trusted_reference.trusted_reference(runs, error, lambda _: None)
        assert known.difference <= error / 3 and known.error <= error / 1.5
        assert known.agreements[3].label.startswith("larger steps")
        asked[error] = runs.asked
    assert all(set(fewer) <= set(more) for more, fewer in pairwise(asked.values()))
    few = {polynomials(3, 2), polynomials(3), polynomials(2, 2), polynomials(2), polynomials(2, order=FULL)}
    assert set(asked[0.1]) == few


@pytest.mark.parametrize("slow", [1, 1e6], ids=["at the finest", "where the next one takes too long"])
@pytest.mark.parametrize("beams", [1, 2])
def test_the_error_that_a_message_promises_is_confirmed(slow: float, beams: int) -> None:
    """It counts all comparisons, also that with larger steps, of a reference that a search for it comes to.

    A second beam is rigid where the larger error allows it.
    """

    def seconds(model: LadderModel) -> float:
        return 0.1 * (slow if model.of("b0").pieces > 2 else 1)

    def errors(model: LadderModel, tolerance: float) -> dict[str, float]:
        first = converging(model.of("b0"), tolerance) if model.of("b0") != RIGID else {"b0": 0.5}
        return {**first, "b1": 2e-4 if model.of("b1") == RIGID else 0.0}

    def searched(error: float) -> TrustedReference:
        runs = MadeUpRuns(chain(beams), errors, seconds)
        rigid = hardly_matter(rigid_shares(runs, error, lambda _: None), error)
        assert bool(rigid) == (beams > 1 and error > 1e-3)
        return trusted_reference.trusted_reference(runs, error, lambda _: None, rigid)

    with pytest.raises(NotConverged, match=r"Ask for an error of [\d.]+ % or more") as caught:
        searched(1e-4)
    assert ("would need" in str(caught.value)) == (slow > 1)
    promised = re.search(r"an error of ([\d.]+) % or more", str(caught.value))
    assert promised is not None
    error = float(promised[1]) / 100
    known = searched(error)
    assert known.suffices(error) and not known.suffices(error / (1.3 if beams == 1 else 2.6))


@pytest.mark.parametrize(("of_shapes", "error", "again"), [(0.2, 0.15, False), (25, 0.6, True)])
def test_more_beams_have_fewer_shapes_where_these_hardly_matter(of_shapes: float, error: float, again: bool) -> None:
    """Their error is known from fewer beams, with the law by which it falls; it has their model in its label."""

    def errors(model: LadderModel, _: float) -> dict[str, float]:
        return {"b0": 0.2 / model.pieces**3 + of_shapes * 4.0**-model.count / model.pieces**2}

    runs = MadeUpRuns(chain(1), errors)
    known = trusted_reference.trusted_reference(runs, error, lambda _: None)
    assert known.model == polynomials(3 if again else 2, 3) and (polynomials(3, 3) in runs.asked) == again
    shapes = next(a for a in known.agreements if a.label.startswith("fewer shapes"))
    assert shapes.error == pytest.approx(of_shapes * 3 * 4.0**-3 / 9, rel=0.05)
    assert (polynomials(3, 2).label in shapes.label) == (not again)


@pytest.mark.parametrize(("of_kind", "counts"), [(1e-3, [14]), (0.03, [14, 18])], ids=["agree", "differ"])
def test_modes_of_another_kind_confirm_a_reference_that_agrees_with_fewer_modes(
    of_kind: float, counts: list[int]
) -> None:
    """They refine nothing else, so that coarser references need none of them; where they differ they are refined."""
    scene = read(ROOT / "examples" / "spatial_crank_slider.toml")
    assert isinstance(scene, AnyScene)

    def errors(model: LadderModel, _: float) -> dict[str, float]:
        of_other = of_kind * (model.count < 18) * (model.shapes is Shapes.ATTACHMENT)
        return {"rod": 0.5 * 0.7**model.count + of_other}

    runs = MadeUpRuns(scene, errors)
    known = trusted_reference.trusted_reference(runs, 0.06, lambda _: None)
    assert known.model == LadderModel(Shapes.CRAIG_BAMPTON, counts[-1])
    assert [model.count for model in runs.asked if model.shapes is Shapes.ATTACHMENT] == counts
    assert [a.label.split(":")[0] for a in known.agreements] == ["fewer modes", "other modes", "larger steps"]


@pytest.mark.parametrize("error", [0.1, 0.009, 0.006])
@pytest.mark.parametrize(("power", "more"), [(2, 0), (2, 0.7), (1.7, 0)], ids=["law", "few are better", "slower"])
def test_the_error_of_a_reference_covers_pieces_that_converge_slowly(power: float, more: float, error: float) -> None:
    """Four beams differ from three by 0.78 of their error, which falls with the square of the number of beams.

    A rod of a slider-crank in space in few pieces was better than by this law.
    """

    def of_pieces(model: LadderModel, _: float) -> dict[str, float]:
        return {"b0": 0.05 / (model.pieces**power + more)}

    known = trusted_reference.trusted_reference(MadeUpRuns(chain(1), of_pieces), error, lambda _: None)
    assert known.difference <= error / 3 and known.error >= 0.05 / (known.model.pieces**power + more) * (1 - 1e-3)


def test_errors_of_a_reference_that_point_the_same_way_add_up() -> None:
    """The largest of them was taken for all."""
    agreements = (Agreement("fewer beams", 0.002, 1.5), Agreement("fewer shapes", 0.004, 0.25))
    known = TrustedReference((), BASE, agreements)
    assert known.error == pytest.approx(0.004) and known.difference == 0.002
    assert known.suffices(0.0061) and not known.suffices(0.0059)


@pytest.mark.parametrize(("ratio", "up"), [(0.00312, 0.0032), (0.14201, 0.15), (0.003, 0.0031), (0.0999, 0.1)])
def test_a_promised_error_is_rounded_up(ratio: float, up: float) -> None:
    assert trusted_reference.rounded_up(ratio) == pytest.approx(up)


def test_what_differs_most_is_refined_and_full_models_of_two_beams_only_where_truncation_matters() -> None:
    def of_beams(model: LadderModel, _: float) -> dict[str, float]:
        return {"b0": 0.2 / model.pieces**3 + (1e-4 if model.order is TRUNCATED else 0.0)}

    def of_truncation(model: LadderModel, _: float) -> dict[str, float]:
        return {"b0": 0.08 / model.pieces**3 if model.order is TRUNCATED else 0.0}

    for errors, full, truncation in ((of_beams, [1], 1e-4), (of_truncation, [1, 2], 0.08)):
        runs = MadeUpRuns(chain(1), errors)
        known = trusted_reference.trusted_reference(runs, 0.07, lambda _: None)
        assert known.model == polynomials(2, 3) and known.truncation == pytest.approx(truncation)
        assert [model.pieces for model in runs.asked if model.order is FULL] == full
        assert max(model.count for model in runs.asked) == 3


def test_rotary_inertia_that_a_full_model_cannot_have_does_not_prevent_a_reference() -> None:
    text = 'axial = { ansatz = ["xi"], stiffness = 1e6 }\nmasses = { tip = { at = 1, mass = 1, inertia = 0.1 } }\n'
    scene = chain(1)
    (beam,) = scene.bodies
    stretching = parse(
        'name = "a"\n[bodies.b]\nmass = 1\nlength = 1\nbending_stiffness = 1\nmarkers = { left = -1 }\n' + text
    )
    assert isinstance(stretching, Scene)
    lean = without_rotary_inertia(stretching)
    assert [mass.inertia for body in beam_bodies(lean) for mass in body.beam.masses] == [0]
    assert without_rotary_inertia(scene).bodies == (beam,)


# ---- beams that hardly matter ----


def test_beams_that_hardly_matter_are_rigid_in_references() -> None:
    """The error of the reference has their shares."""

    def errors(model: LadderModel, tolerance: float) -> dict[str, float]:
        of_first = converging(model.of("b0"), tolerance)["b0"] if model.of("b0") != RIGID else 0.5
        return {"b0": of_first, "b1": 0.002 if model.of("b1") == RIGID else 0.0}

    runs = MadeUpRuns(chain(2), errors)
    rigid = rigid_shares(runs, 0.1, lambda _: None)
    assert [(of.beam, of.share) for of in rigid] == [("b0", pytest.approx(0.5, rel=0.02)), ("b1", pytest.approx(0.002))]
    small = hardly_matter(rigid, 0.1)
    assert [of.beam for of in small] == ["b1"] and hardly_matter(rigid, 0.03) == ()
    runs.asked.clear()
    known = trusted_reference.trusted_reference(runs, 0.1, lambda _: None, small)
    assert all(model.of("b1") == RIGID != model.of("b0") for model in runs.asked)
    assert ("b1 flexible", pytest.approx(0.002)) in [(a.label, a.difference) for a in known.agreements]
    assert known.model == mixed({"b0": polynomials(3, 2), "b1": RIGID})
    none = (BeamShare("b0", RIGID, 1e-5), BeamShare("b1", RIGID, 2e-5))
    assert [of.beam for of in hardly_matter(none, 0.1)] == ["b0"]


def test_bodies_with_models_of_different_kinds_keep_them_beside_one_that_hardly_matters() -> None:
    """The model of the rod was that of both rods, whose kind is the finest."""
    scene = read(ROOT / "examples" / "spatial_crank_slider.toml")
    assert isinstance(scene, SpatialScene)
    (rod,) = flexible_members(scene)
    assert isinstance(rod, FlexibleBody)
    two = replace(scene, bodies=(*scene.bodies, replace(rod, name="loose")))
    scales = {"rod": 0.5, "loose": 1e-4}
    runs = MadeUpRuns(two, lambda model, _: {name: of * 0.7 ** model.of(name).count for name, of in scales.items()})
    small = (BeamShare("loose", RIGID, 1e-4),)
    known = trusted_reference.trusted_reference(runs, 0.06, lambda _: None, small)
    assert known.model == mixed({"rod": LadderModel(Shapes.CRAIG_BAMPTON, 14), "loose": RIGID})


def test_many_beams_are_made_rigid_in_groups() -> None:
    """One of fourteen that matters is found by halving, with less than a run for each beam."""
    matter = {f"b{n}": 0.3 if n == 4 else 1e-6 for n in range(14)}
    runs = MadeUpRuns(chain(14), decreasing(matter))
    shares = {of.beam: of.share for of in rigid_shares(runs, 0.1, lambda _: None)}
    assert len(runs.asked) <= 10 and len(shares) == 14
    assert shares["b4"] == pytest.approx(0.3, rel=1e-3)
    assert all(share == pytest.approx(1e-6) for beam, share in shares.items() if beam != "b4")
    assert len(hardly_matter(rigid_shares(runs, 0.1, lambda _: None), 0.1)) == 13


# ---- candidates ----


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


# ---- trials ----


@dataclass
class MadeUpTrials:
    """Lines of made-up runs: the error of all beams, and the operations that `PredictedCost` predicts for them."""

    runs: MadeUpRuns
    implied: Callable[[LadderModel], Monitor | None] = lambda _: None

    def measured(self, of: LadderModel, *_: object) -> Line:
        rms = float(np.sqrt(sum(e**2 for e in self.runs.errors(of, FINE).values())))
        operations = int(PredictedCost(self.runs.scene).operations(of) * (1.0 if of.order is not FIRST else 0.8)) + 1
        return Line(of, 1, (Point(1e-3, rms, rms, (1e-3,) * 3, 10, operations),), self.implied(of))


def trials_of(
    monkeypatch: pytest.MonkeyPatch, runs: MadeUpRuns, error: float, known: TrustedReference, **how: object
) -> Trials:
    monkeypatch.setattr(trials, "measured", MadeUpTrials(runs, **how).measured)  # type: ignore[arg-type]
    return Trials(runs, known, error)


def reference_of(*errors: tuple[LadderModel, float], truncation: float = 0.0) -> TrustedReference:
    return TrustedReference((), BASE, (Agreement("fewer beams", 0.001),), errors, truncation)


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


# ---- combinations ----


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


def decreasing(matter: dict[str, float]) -> Errors:
    """Sines halve the error of a rigid beam with each shape, which is 1e-5 where a beam does not matter."""

    def errors(model: LadderModel, _: float) -> dict[str, float]:
        return {name: _beam_error(model.of(name), matter.get(name, 1e-5)) for name in matter}

    return errors


def _beam_error(model: LadderModel, rigid: float) -> float:
    if model in (BASE, polynomials(3)):
        return 0.0
    wrong = 3.0 if model.order is FIRST else 1.0
    return rigid if model.shapes is Shapes.RIGID else wrong * rigid / (20 * 2**model.count)


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
