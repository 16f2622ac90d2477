"""Stability of beams in space beside its theory: lateral buckling, blades, and scenes that have none to study."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import derive
from conftest import QUICK, ROOT
from derive.cli.main import main
from derive.cli.specifications import read_scene
from derive.generated_models import generated
from derive.simulation.linear.linearisation import linearise
from derive.simulation.linear.steady_motion import NoSteadyMotion
from derive.simulation.scene_start import steady_motion_of
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.spatial_scene import SpatialScene
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.stability.eigenvalues import Eigenvalues, eigenvalues
from derive.study.stability.model_path import ModelPath, model_path
from derive.study.stability.parameter import ParameterRange, studied

FIRST, SECOND = DisplacementOrder.FIRST_ORDER, DisplacementOrder.TRUNCATED
SHAFT, BLADE = ROOT / "examples/whirling_shaft.toml", ROOT / "examples/rotating_blade.toml"
DATA = ROOT / "tests/second_order/rotating_cantilever.json"
ALONG = {"x": [0, 0, -1], "y": [0, 1, 0]}
"""A frame whose z is along the shaft."""
CRITICAL = np.pi**2
"""The first critical speed of a shaft of unit length, mass and bending stiffness between bearings, rad/s."""


def rod(**changes: Any) -> dict[str, Any]:
    """A shaft of unit length, mass and bending stiffness."""
    markers = {"left": {"at": -1, "rotation": ALONG}, "middle": 0, "right": 1}
    own = {"length": 1, "mass": 1, "bending_stiffness": 1, "rotary_inertia": "1/1000", "frame": "chord", "order": 2}
    return {**own, "markers": markers, **changes}


GROUND: dict[str, Any] = {"left": {"at": (0, 0, 0), "rotation": ALONG}, "right": {"at": (1, 0, 0), "rotation": ALONG}}
RIGHT = {"kind": "point_on_line", "between": ["ground.right", "rod.right"]}


def compiled(scene: SpatialScene) -> Callable[..., Eigenvalues]:
    """The eigenvalues about the steady motion of a scene for values of its parameters."""
    native = derive.load_scene(generated(scene)[1], QUICK)

    def at(**values: float) -> Eigenvalues:
        k = native.setup(values)
        steady = steady_motion_of(scene, native, k)
        return eigenvalues(linearise(native, k, 0.0, steady.q, steady.v, steady.axes).A, steady.spin)

    return at


INERTIA = CRITICAL / 1000
"""J pi^2/(m l^2): the part by which the inertia of the sections about the axis raises critical speeds."""


# ---- models of a ladder


def path(scene: SpatialScene, name: str, low: float, high: float, model: LadderModel, count: int = 4) -> ModelPath:
    """A model over a parameter."""
    made = model_path(studied(scene, ParameterRange(name, low, high, count)), model)
    assert not made.failure and not made.gaps
    return made


def polynomials(count: int, order: DisplacementOrder, frame: str = "tangent", pieces: int = 1) -> LadderModel:
    return LadderModel(Shapes.POLYNOMIALS, count, order, frame, pieces)


def test_the_parameter_may_be_an_element_of_an_initial_velocity() -> None:
    """A shaft that spins freely is lost where a driven one is."""
    scene = derive.spatial_scene(
        "free_spin",
        ground=GROUND,
        bodies={
            "rod": rod(
                ansatz={"kind": "pinned", "count": 1},
                damping={"stiffness": "1/500"},
                start={"angular_velocity": [1, 0, 0]},
            )
        },
        joints={"left": {"kind": "spherical", "between": ["ground.left", "rod.left"]}, "right": RIGHT},
        simulation={"duration": 1, "output": 1},
    )
    sine = LadderModel(Shapes.SINES, 1, SECOND, "chord")
    made = path(scene, "bodies.rod.start.angular_velocity[0]", 0, 15, sine, 3)
    assert made.unit == "rad/s" and made.loss == pytest.approx(CRITICAL / np.sqrt(1 - INERTIA), rel=1e-6)


def lateral(soft: float, torsion: float) -> float:
    """The load of lateral buckling at second order, in EI_3/l^2, for soft = EI_2/EI_3 and torsion = GJ/EI_3.

    The strain energy of third order about the deflection v of the load P is int (EI_3 - EI_2) v'' theta w'' dx with
    EI_3 v'' = P (l - x): that of a beam without deflection with the load P (1 - EI_2/EI_3), whatever GJ is. The energy
    of fourth order, which truncation leaves out, makes of this factor sqrt((1 - EI_2/EI_3)(1 - GJ/EI_3)): the same for
    GJ = EI_2.
    """
    return 4.0126 * float(np.sqrt(soft * torsion)) / (1 - soft)


def cantilever(stiff: float = 1000, torsion: float = 1) -> SpatialScene:
    """A cantilever with EI_2 = 1 that is stiff in the plane of its end load P (N), with EI_3 and GJ."""
    return derive.spatial_scene(
        "cantilever",
        parameters={"P": {"default": 0, "unit": "N"}},
        ground={"wall": (0, 0, 0)},
        bodies={
            "rod": rod(
                bending_stiffness=stiff,
                lateral={"bending_stiffness": 1},
                torsion={"ansatz": ["xi", "xi^2", "xi^3"], "stiffness": torsion},
                ansatz=["1", "xi", "xi^2"],
                markers={"left": -1, "right": 1},
            )
        },
        joints={"root": {"kind": "fixed", "between": ["ground.wall", "rod.left"]}},
        forces={"end": {"at": "rod.right", "force": [0, "-P", 0]}},
        simulation={"duration": 1, "output": 1},
    )


@pytest.mark.long
@pytest.mark.parametrize(
    ("model", "near"),
    [(polynomials(3, SECOND), 1e-2), (polynomials(2, SECOND, "mean", 2), 2e-2), (polynomials(2, FIRST), None)],
    ids=lambda value: value.label if isinstance(value, LadderModel) else None,
)
def test_a_cantilever_buckles_laterally_at_second_order_alone(model: LadderModel, near: float | None) -> None:
    """At 4.013 sqrt(EI GJ)/l^2, from above, also in pieces."""
    lost = path(cantilever(), "P", 0, 6, model).loss
    if near is None:
        assert lost is None
    else:
        assert lost is not None and 0 < lost / (1000 * lateral(1e-3, 1e-3)) - 1 < near


@pytest.mark.long
def test_truncation_has_the_deflection_before_lateral_buckling_without_torsion() -> None:
    """The load is 1.11 times that without deflection, where theory has 1.26 for EI_2, GJ = 0.1, 0.3 EI_3."""
    expected = 10 * lateral(0.1, 0.3)
    lost = path(cantilever(10, 3), "P", 0.8 * expected, 1.2 * expected, polynomials(3, SECOND), 2).loss
    assert lost == pytest.approx(expected, rel=1e-2)


def blade() -> SpatialScene:
    """The blade of the example."""
    scene = read_scene(BLADE)
    assert isinstance(scene, SpatialScene)
    return scene


SPIN = "drives.spin.speed"


@pytest.mark.long
def test_a_blade_of_first_order_is_lost_in_lag_at_its_frequency_at_rest() -> None:
    """At 3.516 sqrt(EI/(m l^3)); flap does not soften, but does not stiffen either."""
    made = path(blade(), SPIN, 0, 6, polynomials(3, FIRST), 3)
    assert made.unit == "rad/s" and made.loss == pytest.approx(3.516, rel=1e-3)
    flaps = [p.eigenvalues.frequencies[0] for p in made.points if p.eigenvalues is not None and p.value > 4]
    assert flaps == pytest.approx([3.516] * len(flaps), rel=1e-3)


@pytest.mark.long
def test_a_blade_of_second_order_stiffens_in_flap_and_in_lag() -> None:
    known = json.loads(DATA.read_text())["inextensible"]
    chosen = [1, 3]
    low, high = (known["mu"][n] for n in chosen)
    made = path(blade(), SPIN, low, high, polynomials(3, SECOND), 2)
    assert made.loss is None
    for point, n in zip(made.points, chosen, strict=True):
        assert point.eigenvalues is not None
        expected = [known["chordwise"][n], known["flapwise"][n]]
        assert point.eigenvalues.frequencies[:2] == pytest.approx(expected, rel=5e-3)


@pytest.mark.long
def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    models = (LadderModel(Shapes.RIGID), LadderModel(Shapes.SINES, 1, SECOND, "chord"))
    monkeypatch.setattr("derive.study.stability.ladder_stability.refinements", lambda _: models)
    monkeypatch.setattr("derive.study.stability.ladder_stability.ladder", lambda *_: models)
    asked = ["study", "stability", str(SHAFT), "--parameter", "spin=0:20:5", "--exact", "14.9468", "--json"]
    assert main([*asked, "--out", str(tmp_path)]) == 0
    said = capsys.readouterr()
    assert "1 sine, truncated: loses its stability at 14.946" in said.err
    rigid, sine = json.loads(said.out)["models"]
    assert rigid["wrong"] == [{"from": 14.9468, "to": 20.0, "stable": True}]
    assert sine["loss"] == pytest.approx(14.9468, rel=1e-5)
    assert "1 sine, truncated" in (tmp_path / "stability.svg").read_text()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"bodies": {"rod": {"mass": 1, "inertia": [1, 1, 1, 0, 0, 0]}}},
            "there is no beam and no finite-element body",
        ),
        (
            {"forces": {"end": {"at": "rod.right", "force": [0, "-P*t", 0]}}},
            "no motion is steady, since these functions",
        ),
    ],
)
def test_scenes_that_have_no_stability_to_study(changes: dict[str, Any], message: str) -> None:
    given = {
        "parameters": {"P": {"default": 0}} if "forces" in changes else {},
        "bodies": {"rod": rod(ansatz=["1", "xi", "xi^2"], markers={"left": -1, "right": 1})},
        "simulation": {"duration": 1, "output": 1},
    }
    scene = derive.spatial_scene("refused", **{**given, **changes})
    with pytest.raises(derive.TisserandError, match=message):
        derive.study_stability(
            scene, ("bodies.rod.start.angular_velocity", 0, 1, 2) if not given["parameters"] else ("P", 0, 1, 2)
        )


def test_a_shaft_that_gravity_bends_does_not_rotate_steadily() -> None:
    """Its weight is along one direction in space."""
    scene = derive.spatial_scene(
        "heavy",
        gravity=(0, -9.81, 0),
        ground=GROUND,
        bodies={"rod": rod(ansatz={"kind": "pinned", "count": 1}, start={"angular_velocity": [2, 0, 0]})},
        joints={"left": {"kind": "spherical", "between": ["ground.left", "rod.left"]}, "right": RIGHT},
    )
    native = derive.load_scene(generated(scene)[1], QUICK)
    with pytest.raises(NoSteadyMotion, match="not those of a rotation of the whole scene"):
        steady_motion_of(scene, native, native.setup())


def test_a_drive_that_turns_a_part_of_the_scene_is_named() -> None:
    """The velocities of this slider crank are those of its drive, and none are given."""
    inertia = [1, 1, 1, 0, 0, 0]
    hub: dict[str, Any] = {"at": (0, 0, 0), "rotation": {"z": [0, 1, 0], "x": [1, 0, 0]}}
    scene = derive.spatial_scene(
        "crank",
        gravity=(0, 0, -1),
        ground={"hub": hub, "right": {"at": (2, 0, -1), "rotation": ALONG}},
        bodies={
            "arm": {"mass": 1, "inertia": inertia, "markers": {"hub": hub, "end": (1, 0, 0)}},
            "rod": {
                "mass": 1,
                "inertia": inertia,
                "markers": {"top": ("-1/2", 0, "1/2"), "right": ("1/2", 0, "-1/2")},
                "start": {"position": (1.5, 0, -0.5)},
            },
        },
        joints={
            "hub": {"kind": "revolute", "between": ["ground.hub", "arm.hub"]},
            "ball": {"kind": "spherical", "between": ["arm.end", "rod.top"]},
            "right": RIGHT,
        },
        drives={"motor": {"joint": "hub", "speed": 3}},
    )
    with pytest.raises(NoSteadyMotion, match="The drive motor gives velocities as well: a mechanism whose parts"):
        compiled(scene)()
