"""The reference of `tisserand choose` with errors that are made up: its models, and what it claims."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import pairwise

import pytest
from made_up_choice import (
    BASE,
    FULL,
    RIGID,
    TRUNCATED,
    MadeUpRuns,
    chain,
    converging,
    decreasing,
    polynomials,
    reference,
)

from conftest import ROOT
from derive.simulation.observables.beams import beam_bodies
from derive.spec.model.scene import Scene
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene
from derive.spec.toml.read import parse, read
from derive.study.accuracy.ladder_model import LadderModel, Shapes, mixed
from derive.study.accuracy.modelled_bodies import flexible_members
from derive.study.choice.beam_shares import BeamShare
from derive.study.choice.full_scene import without_rotary_inertia
from derive.study.choice.reference_errors import Agreement, TrustedReference
from derive.study.choice.reference_models import MOST_BEAMS
from derive.study.choice.rigid_shares import hardly_matter, rigid_shares
from derive.study.choice.trusted_reference import NotConverged, rounded_up


def test_a_larger_error_needs_no_other_references() -> None:
    """The search goes from dear to cheap; the first reference needs five models, two of a beam for its truncation."""
    asked: dict[float, list[LadderModel]] = {}
    for error in (0.009, 0.01, 0.03, 0.1):
        runs = MadeUpRuns(chain(1), converging)
        known = reference(runs, error)
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
        return reference(runs, error, rigid)

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
    known = reference(runs, error)
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
    known = reference(runs, 0.06)
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

    known = reference(MadeUpRuns(chain(1), of_pieces), error)
    assert known.difference <= error / 3 and known.error >= 0.05 / (known.model.pieces**power + more) * (1 - 1e-3)


def test_the_most_beams_get_no_more_shapes_where_these_hardly_matter() -> None:
    """A rod in space at 0.3 % got more shapes for minutes where only more beams than are tried would have helped."""

    def of_pieces(model: LadderModel, _: float) -> dict[str, float]:
        return {"b0": 0.05 / model.pieces**2 + 1e-5 * 4.0**-model.count}

    runs = MadeUpRuns(chain(1), of_pieces)
    with pytest.raises(NotConverged, match=r"finer ones are not tried. Ask for an error of 0\.\d+ % or more"):
        reference(runs, 1e-3)
    assert max(model.pieces for model in runs.asked) == MOST_BEAMS
    assert max(model.count for model in runs.asked) == polynomials(3).count


def test_errors_of_a_reference_that_point_the_same_way_add_up() -> None:
    """The largest of them was taken for all."""
    agreements = (Agreement("fewer beams", 0.002, 1.5), Agreement("fewer shapes", 0.004, 0.25))
    known = TrustedReference((), BASE, agreements)
    assert known.error == pytest.approx(0.004) and known.difference == 0.002
    assert known.suffices(0.0061) and not known.suffices(0.0059)


@pytest.mark.parametrize(("ratio", "up"), [(0.00312, 0.0032), (0.14201, 0.15), (0.003, 0.0031), (0.0999, 0.1)])
def test_a_promised_error_is_rounded_up(ratio: float, up: float) -> None:
    assert rounded_up(ratio) == pytest.approx(up)


def test_what_differs_most_is_refined_and_full_models_of_two_beams_only_where_truncation_matters() -> None:
    def of_beams(model: LadderModel, _: float) -> dict[str, float]:
        return {"b0": 0.2 / model.pieces**3 + (1e-4 if model.order is TRUNCATED else 0.0)}

    def of_truncation(model: LadderModel, _: float) -> dict[str, float]:
        return {"b0": 0.08 / model.pieces**3 if model.order is TRUNCATED else 0.0}

    for errors, full, truncation in ((of_beams, [1], 1e-4), (of_truncation, [1, 2], 0.08)):
        runs = MadeUpRuns(chain(1), errors)
        known = reference(runs, 0.07)
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
    known = reference(runs, 0.1, small)
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
    known = reference(runs, 0.06, small)
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
