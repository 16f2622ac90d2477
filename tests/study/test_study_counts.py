"""Counts of the crank-slider with 1, 2 and 3 beams in both frames."""

from __future__ import annotations

import pytest

import derive
from conftest import ROOT
from derive.ir.patterns import pattern
from derive.lowering.elimination_orders import EliminationRule, work
from derive.lowering.flat.lower import lower
from derive.simulation.observables.beams import beam_bodies
from derive.study.variants import OperationCounts, operation_counts, variant

SCENE = derive.read(ROOT / "scenes/crank_slider_3.toml")

# coordinates, multipliers, nnz(M), nnz(KKT), fill-in, LDL^T, LDL^T in code, force, accel
EXPECTED = {
    ("mean", 1): (6, 4, 6, 40, 6, 127, 81, 14, 231),
    ("point", 1): (6, 4, 16, 50, 7, 181, 135, 27, 339),
    ("mean", 2): (11, 7, 11, 89, 17, 352, 241, 28, 565),
    ("point", 2): (11, 7, 31, 109, 19, 468, 368, 54, 800),
    ("mean", 3): (16, 10, 16, 138, 29, 594, 411, 42, 922),
    ("point", 3): (16, 10, 46, 168, 32, 772, 609, 81, 1284),
}


@pytest.mark.long
@pytest.mark.parametrize(("frame", "pieces"), EXPECTED)
def test_counts(frame: str, pieces: int) -> None:
    """A smaller number is progress: write it above."""
    equations = derive.derive(variant(SCENE, pieces, frame).scene).expanded()
    assert operation_counts(equations, lower(equations, explicit=True)) == OperationCounts(*EXPECTED[frame, pieces])


@pytest.mark.parametrize(("frame", "fill", "flops"), [("mean", 22, 511), ("point", 19, 607)])
def test_matched_orders_fill_in_less(frame: str, fill: int, flops: int) -> None:
    """With three beams the point frame gains more, so that the frames are nearer to each other in their best orders."""
    equations = derive.derive(variant(SCENE, 3, frame).scene).expanded()
    model = lower(equations, elimination=EliminationRule.MATCHED, explicit=True)
    counts = operation_counts(equations, model, EliminationRule.MATCHED)
    assert (counts.fill, counts.flops) == (fill, flops)


def test_a_variant_is_what_a_specification_with_its_frame_gives(tmp_path) -> None:
    text = (ROOT / "scenes/crank_slider_3.toml").read_text()
    changed = text.replace('frame = "mean"', 'frame = "point"').replace("pieces = 3 ", "pieces = 2 ")
    (tmp_path / "crank_slider_A.csv").write_text((ROOT / "scenes/crank_slider_A.csv").read_text())
    (tmp_path / "scene.toml").write_text(changed)
    (rod,) = beam_bodies(derive.read(tmp_path / "scene.toml"))
    assert beam_bodies(variant(SCENE, 2, "point").scene) == (rod,)
    assert variant(SCENE, 3, "mean").scene == SCENE


def test_operations_of_a_factorisation_by_hand() -> None:
    """Full, 3 x 3: 3 divisions, 2 + 1 products for L, and a product and a sum for each of the 3 + 1 entries below."""
    full = pattern(3, 3, {(i, j) for i in range(3) for j in range(i + 1)}, symmetric=True)
    assert work(full, (0, 1, 2)) == 3 + 3 + 2 * 4
