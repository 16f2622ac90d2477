"""The choice between straight line and loops over instances: its prediction, what it chooses, and who overrides it."""

from __future__ import annotations

import pytest

import derive
from conftest import ROOT
from derive.cli.main import main
from derive.lowering.mechanism_costs import LONG, MechanismCosts, estimate_mechanism_costs
from derive.mechanics.multibody.mechanism import Mechanism
from derive.spec.as_tables import specification_tables
from derive.spec.toml.read import parse

NS_OF_AN_OPERATION = 0.155
"""The measured time of an operation of straight-line code of mechanisms in bench/lowerings.py."""


def scene(name: str) -> derive.Scene:
    spec = derive.read(ROOT / f"{name}.toml")
    assert isinstance(spec, derive.Scene)
    return spec


def mechanism(spec: derive.Scene) -> Mechanism:
    derived = derive.derive(spec)
    assert isinstance(derived, Mechanism)
    return derived


def chain(count: int, **more: object) -> derive.Scene:
    """Pinned beams that hang from the ground."""
    rod = {"ansatz": ["1", "xi", "xi^2", "xi^3"], "markers": {"left": -1, "right": 1}, "bending_stiffness": 1}
    ends = ["ground.origin", *(f"rod_{k}.right" for k in range(count))]
    joints = {f"pin_{k}": {"kind": "revolute", "between": [ends[k], f"rod_{k}.left"]} for k in range(count)}
    return derive.scene(
        "rods", ground={"origin": [0, 0]}, bodies={f"rod_{k}": rod for k in range(count)}, joints=joints, **more
    )


TOML = """
name = "rods"
[scene]
lowering = "auto"
[bodies.rod]
ansatz = ["1", "xi", "xi^2"]
bending_stiffness = 1
"""


@pytest.mark.parametrize("name", ["double_pendulum", "four_bar", "crank_slider_3"])
def test_the_time_of_straight_line_code_is_foreseen(name: str) -> None:
    derived = mechanism(scene(f"scenes/{name}"))
    operations = derive.lower(derived, explicit=True).kernel("accel").operations
    assert estimate_mechanism_costs(derived).flat == pytest.approx(NS_OF_AN_OPERATION * operations, rel=0.15)


def test_equal_bodies_make_loops_and_few_or_different_ones_straight_lines() -> None:
    costs = {count: estimate_mechanism_costs(mechanism(chain(count))) for count in (2, 4, 6, 40)}
    assert [of.lowering for of in costs.values()] == ["flat", *["instances"] * 3]
    assert costs[6].instances < 0.8 * costs[6].flat and costs[40].instances < 0.5 * costs[40].flat
    for name in ("scenes/four_bar", "scenes/crank_slider_3", "examples/andrews_squeezer"):
        assert estimate_mechanism_costs(mechanism(scene(name))).lowering == "flat"


def test_joints_that_depend_on_both_of_their_bodies_take_longer() -> None:
    """Guides that move and pins have as many constraints; seven between inner bodies are in the lanes of vectors."""
    costs = {kind: estimate_mechanism_costs(mechanism(carriages(10, kind))) for kind in ("revolute", "translational")}
    guides, pins = costs["translational"], costs["revolute"]
    assert guides.flat - pins.flat == pytest.approx(6 * 9)
    assert guides.instances - pins.instances == pytest.approx(11 * (1 + 8 * 0.4 + 1))


def carriages(count: int, kind: str) -> derive.Scene:
    """Rigid bodies that follow each other."""
    carriage = {"mass": 1, "inertia": 1, "keep_coordinates": True, "markers": {"left": [-0.3, 0], "right": [0.4, 0]}}
    joints = {
        f"joint_{k}": {"kind": kind, "between": [f"body_{k}.right", f"body_{k + 1}.left"]} for k in range(count - 1)
    }
    return derive.scene("carriages", bodies={f"body_{k}": carriage for k in range(count)}, joints=joints)


def test_code_that_leaves_the_instruction_cache_takes_twice_its_time() -> None:
    """Beams of classes of their own have so much code in both forms; loops over equal ones have as much as of one."""
    beam = {"ansatz": ["1", "xi", "xi^2", "xi^3"], "bending_stiffness": 1}
    alone, few, many = (
        estimate_mechanism_costs(
            mechanism(derive.scene("beams", bodies={f"b_{k}": beam | {"markers": {f"m_{k}": 1}} for k in range(count)}))
        )
        for count in (1, 10, 50)
    )
    assert (few.flat, few.instances) == pytest.approx((10 * alone.flat, 10 * alone.instances))
    assert (many.flat, many.instances) == pytest.approx((2 * 50 * alone.flat, 2 * 50 * alone.instances))
    equal = estimate_mechanism_costs(mechanism(derive.scene("beams", bodies={f"b_{k}": beam for k in range(48)})))
    assert equal.instances == pytest.approx(0.4 * 48 * alone.instances)


def test_what_takes_the_compiler_too_long_is_looped() -> None:
    assert MechanismCosts(900, 950, 34.0).lowering == "instances"
    assert "would take the compiler some 34 s" in MechanismCosts(900, 950, 34.0).reason("auto")
    assert MechanismCosts(900, 950, LONG).lowering == "flat"
    assert [MechanismCosts(100, ns, 2.0).lowering for ns in (91, 89)] == ["flat", "instances"]


@pytest.mark.parametrize("lowering", ["flat", "instances"])
def test_the_specification_has_the_last_word(lowering: str) -> None:
    for count in (2, 6):
        model = derive.lower(derive.derive(chain(count, lowering=lowering)), explicit=True)
        assert model.lowering == lowering
        assert "as the specification asks; predicted evaluation time of the accelerations" in model.choice


def test_the_key_is_written_and_read() -> None:
    spec = chain(2, lowering="instances")
    tables = specification_tables(spec)
    assert tables["scene"] == {"lowering": "instances"} and derive.scene(tables) == spec
    assert "scene" not in specification_tables(chain(2))
    assert parse(TOML).lowering == "auto"


def test_the_choice_is_stated(tmp_path, capsys) -> None:
    path = tmp_path / "rods.toml"
    path.write_text(TOML)
    assert main(["build", str(path), "--out", str(tmp_path)]) == 0
    output = capsys.readouterr().out
    assert "unrolled, " in output and "predicted evaluation time of the accelerations" in output


def test_unknown_lowerings_are_refused(tmp_path, capsys) -> None:
    spec = chain(2, lowering="instances")
    assert "parameter_jacobian" in {k.name for k in derive.lower(derive.derive(spec), sensitivities=True).kernels}
    path = tmp_path / "rods.toml"
    path.write_text(TOML.replace('"auto"', '"loops"'))
    assert main(["build", str(path)]) == 2
    assert 'the lowering of a scene is one of "auto", "flat", "instances", not "loops"' in capsys.readouterr().err
    with pytest.raises(derive.SpecError, match='the lowering is one of "auto", "flat", "loops", not "instances"'):
        derive.symbolic_body("body", 2, frame="given", lowering="instances")
