"""The choice between straight line and loops: its count of operations, where it turns, and who overrides it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

import derive
from conftest import ROOT
from derive.cli.main import main
from derive.lowering.cost_model import estimate_costs, flat_operations
from derive.mechanics.bodies.spatial_body import modal_body, parametric_body


@pytest.mark.parametrize(("n", "frame"), [(2, "given"), (4, "mean"), (5, "given"), (6, "mean")])
def test_operations_are_foreseen(n: int, frame: str) -> None:
    spec = derive.symbolic_body("b", n, frame=frame, damping=True, lowering="flat")
    counted = derive.lower(derive.derive(spec)).kernel("force").operations
    assert flat_operations(parametric_body(spec)) == pytest.approx(counted, rel=0.1)


def test_operations_of_the_block_are_foreseen() -> None:
    spec = derive.read(ROOT / "scenes/block.toml")
    counted = derive.lower(derive.derive(spec)).kernel("force").operations
    assert counted == 499
    assert flat_operations(modal_body(derive.modal(spec))) == pytest.approx(counted, rel=0.1)


def test_zeros_make_straight_lines_and_many_shapes_make_loops() -> None:
    spec = derive.read(ROOT / "scenes/block.toml")
    block = derive.modal(spec)
    assert estimate_costs(modal_body(block)).lowering == "flat"
    for n, lowering in ((1, "flat"), (2, "loops"), (8, "loops"), (100, "loops")):
        given = derive.symbolic_body("b", n, frame="given")
        assert estimate_costs(parametric_body(given)).lowering == lowering


@pytest.mark.parametrize("lowering", ["flat", "loops"])
def test_the_specification_has_the_last_word(lowering: str) -> None:
    spec = replace(derive.read(ROOT / "scenes/block.toml"), lowering=lowering)
    model = derive.lower(derive.derive(spec))
    assert model.lowering == lowering
    assert "as the specification asks" in model.choice and "predicted evaluation time" in model.choice


def test_derivatives_by_parameters_unroll_what_is_left_to_the_program() -> None:
    equations = derive.derive(derive.symbolic_body("b", 2, frame="given"))
    model = derive.lower(equations, sensitivities=True)
    assert (derive.lower(equations).lowering, model.lowering) == ("loops", "flat")
    assert model.choice == "unrolled, for derivatives by parameters"
    assert "parameter_jacobian" in [kernel.name for kernel in model.kernels]
    loops = derive.derive(derive.symbolic_body("b", 2, frame="given", lowering="loops"))
    with pytest.raises(derive.SpecError, match="loops have no derivatives by parameters"):
        derive.lower(loops, sensitivities=True)


def test_the_choice_is_said_with_its_numbers() -> None:
    model = derive.lower(derive.derive(derive.read(ROOT / "scenes/block.toml")))
    assert model.choice.startswith("unrolled, the faster form; predicted evaluation time of h: 4")
    header = (ROOT / "generated/block/block.h").read_text()
    assert " ".join(model.choice.split()[:8]) in " ".join(header.replace(" * ", " ").split())


def test_a_body_that_does_not_fit_is_refused() -> None:
    """A block with modes twice as large has c8 = 4, which the model with orthonormal modes takes to be 1."""
    spec = derive.read(ROOT / "scenes/block.toml")
    anything = derive.read(ROOT / "scenes/body_symbolic.toml")
    block = derive.modal(spec)
    assert derive.parameters(block, anything)[0] == block.mass
    with pytest.raises(ValueError, match="takes c8 to be the unit matrix"):
        derive.parameters(replace(block, c8=4 * block.c8), anything)
    with pytest.raises(ValueError, match="takes c2 to vanish"):
        derive.parameters(replace(block, c2=block.c2 + 1.0), anything)
    with pytest.raises(ValueError, match="has 8 modes and block 3"):
        derive.parameters(derive.modal(replace(spec, modes=3)), anything)


def test_straight_lines_that_are_too_long_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec = tmp_path / "long.toml"
    text = 'name = "lengthy"\n[body]\nintegrals = "symbolic"\nmodes = 40\nframe = "given"\nlowering = "flat"\n'
    spec.write_text(text)
    assert main(["build", str(spec), "--out", str(tmp_path)]) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"{spec}:6: body.lowering: unrolled, the forces alone would take some 3")
