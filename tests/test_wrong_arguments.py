"""Arguments of the public functions that a newcomer may well get wrong: the message says what is needed instead."""

from typing import Any

import numpy as np
import pytest

import derive
from derive.study.sweep.samples import SamplesError

CORNERS = [[1, 1, 0], [-1, 1, 0], [-1, -1, 0], [1, -1, 0]]
NODES = {
    "positions": CORNERS,
    "mass": np.eye(4),
    "modes": [np.array(CORNERS) / 8**0.5],
    "modal_stiffness": [[100]],
}
BEAM = derive.planar_beam("beam", markers={"tip": 1})
SQUARE = derive.nodal_body("square", NODES, units="SI")
BODY = derive.modal(SQUARE)
BALL = derive.scene(
    "ball", bodies={"ball": {"mass": 1, "inertia": 1}}, simulation={"duration": 1, "output": 0.1}, gravity=(0, -10)
)


@pytest.fixture(scope="module")
def equations() -> Any:
    return derive.derive(BEAM)


@pytest.mark.parametrize(
    ("call", "needed"),
    [
        (lambda: derive.write("beam.c", "out"), r"files that derive.model_files.* are needed, not str"),
        (lambda: derive.write([1], "out"), r"files that derive.model_files.* are needed, not list"),
        (lambda: derive.load(BEAM), "files that derive.model_files.* are needed, not PlanarBeam"),
        (lambda: derive.FixedStep(BEAM), "files that derive.model_files.* are needed, not PlanarBeam"),
        (lambda: derive.modal(BEAM), "finite-element body is needed.*, not PlanarBeam"),
        (lambda: derive.derive_modal(SQUARE), r"derive.modal\(spec\) returns are needed, not NodalBody"),
        (lambda: derive.parameters(SQUARE, SQUARE), r"derive.modal\(spec\) returns are needed, not NodalBody"),
        (lambda: derive.parameters(BODY, SQUARE), "symbolic body is needed.*, not NodalBody"),
        (lambda: derive.casadi_function(BEAM), r"derive.host_model\(spec, sensitivities=True\) is needed, not Planar"),
        (lambda: derive.interpret(BEAM, {}), r'a kernel is needed, such as model.kernel\("mass"\), not PlanarBeam'),
        (lambda: derive.initial_state(SQUARE, None), "a scene is needed, not NodalBody"),
        (lambda: derive.validated({"name": "beam"}), "a specification is needed, not dict"),
        (
            lambda: derive.model_files(BEAM, BEAM),
            r"derive.lower\(derive.derive\(spec\)\) returns is needed, not PlanarBeam",
        ),
        (lambda: derive.time_function(3), "a text is needed.*, not int"),
        (lambda: derive.study_accuracy(BEAM), "a scene is needed, .*, not PlanarBeam"),
        (lambda: derive.study_methods(SQUARE), "a scene is needed, .*, not NodalBody"),
        (lambda: derive.study_stability(BEAM, ("P", 0, 1, 2)), "a scene is needed, .*, not PlanarBeam"),
        (lambda: derive.choose(BEAM), "a scene is needed, .*, not PlanarBeam"),
        (lambda: derive.study_accuracy(BALL, orders="first"), r"several values are needed, such as \['first'\]"),
        (lambda: derive.study_accuracy(BALL, shapes=2), r"shapes: several values are needed, such as \[2\], not 2"),
        (lambda: derive.study_accuracy(BALL, tolerances=1e-3), "tolerances: several values are needed"),
    ],
)
def test_the_type_that_is_needed(call: Any, needed: str) -> None:
    with pytest.raises(TypeError, match=needed):
        call()


@pytest.mark.parametrize(
    ("call", "needed"),
    [
        (lambda: derive.derive_modal(BODY, lowering="loop"), 'auto, flat, loops, not "loop"'),
        (lambda: derive.derive_modal(BODY, gravity=(0, -10)), "gravity has three components, not 2"),
        (
            lambda: derive.study_accuracy(BALL, error=1),
            "error: a number between 0 and 1 is needed.*, not 1",
        ),
        (lambda: derive.study_accuracy(BALL, tolerances=[0]), "tolerances: a number between 0 and 1 is needed"),
        (lambda: derive.study_accuracy(BALL, shapes=[2.5]), "shapes: a whole number from 1 to 12 is needed, not 2.5"),
        (lambda: derive.study_accuracy(BALL, pieces=[65]), "pieces: a whole number from 1 to 64 is needed, not 65"),
        (lambda: derive.study_accuracy(BALL, torsion=[-1]), "torsion: a whole number from 0 to 12 is needed, not -1"),
        (
            lambda: derive.study_accuracy(BALL, component_counts=[0]),
            "component_counts: a whole number from 1 to 200 is",
        ),
        (lambda: derive.study_accuracy(BALL, runs=0), "runs: a whole number from 1 on is needed, not 0"),
        (lambda: derive.study_methods(BALL, states=1), "states: a whole number from 2 on is needed, not 1"),
        (lambda: derive.study_stability(BALL, ("P", 1, 0, 2)), "the first value is a number less than the last"),
        (lambda: derive.study_stability(BALL, ("P", 0, 1, 1)), "a whole number from 2 to 10000 is needed, not 1"),
        (lambda: derive.study_stability(BALL, ("P", 0, 1, 2), exact="never"), "exact: .*\"none\".*, not 'never'"),
        (lambda: derive.study_stability(BALL, "P"), r'parameter: .*\("P", 0, 10, 11\), not \'P\''),
        (lambda: derive.choose(BALL, error="1 %"), "error: a number between 0 and 1 is needed"),
    ],
)
def test_the_value_that_is_needed(call: Any, needed: str) -> None:
    with pytest.raises(ValueError, match=needed):
        call()


@pytest.mark.parametrize(
    "call",
    [
        lambda: derive.grid({}),
        lambda: derive.grid([10, 20]),
        lambda: derive.listed({}),
        lambda: derive.random_samples({}, 3),
        lambda: derive.random_samples({"EI": "uniform(1, 2)"}, 0),
        lambda: derive.random_samples({"EI": "uniform(1, 2)"}, 2.5),
        lambda: derive.sweep(BEAM, {"EI": [1, 2]}, ["peak:beam_phi"], duration=1),
    ],
)
def test_samples_without_names_or_numbers(call: Any) -> None:
    with pytest.raises(SamplesError, match=r"samples need names|whole number from 1 on|are those of derive.grid"):
        call()


@pytest.mark.parametrize(
    ("call", "known"),
    [
        (lambda of: of.marker("tp"), 'did you mean "tip"'),
        (lambda of: of.expanded().row("ph"), "known: c1, c2, phi, alpha1, alpha2"),
        (lambda of: of.expanded().sum_of("alpha_1"), 'did you mean "alpha1"'),
        (lambda _: derive.grid({"EI": [1, 2]}).axis("m"), "known: EI"),
        (lambda _: derive.JOINTS[3], "known: revolute"),
        (lambda _: derive.study_accuracy(BALL, orders=["frist"]), 'did you mean "first"'),
        (lambda _: derive.study_accuracy(BALL, frames=["men"]), 'did you mean "mean"'),
        (lambda _: derive.study_accuracy(BALL, modes=["free"]), "known: free-free, clamped-free"),
        (lambda _: derive.study_accuracy(BALL, component_modes=["fre"]), 'did you mean "free"'),
        (lambda _: derive.study_accuracy(BALL, integrators=["ida"]), "known: rk4, generalised-alpha"),
        (lambda _: derive.study_methods(BALL, integrators=["rk5"]), 'did you mean "rk45"'),
        (lambda _: derive.JOINTS["weld", "fixed"], r"there is no joint .*'weld', 'fixed'"),
    ],
)
def test_unknown_names(call: Any, known: str, equations: Any) -> None:
    with pytest.raises(derive.UnknownNameError, match=known):
        call(equations)


def test_nodes_may_be_lists_and_ragged_ones_are_named() -> None:
    arrays = {key: np.array(rows) for key, rows in NODES.items()}
    assert derive.modal(derive.nodal_body("square", arrays, units="SI")).C3.tolist() == BODY.C3.tolist()
    with pytest.raises(derive.SpecError, match=r"body\.nodes\.positions: .*, not a list"):
        derive.nodal_body("square", {**NODES, "positions": [[1, 2, 3], [4]]}, units="SI")


def test_markers_of_typed_bodies_may_be_a_list_and_have_names_of_their_own() -> None:
    first, second = derive.PointMarker("top", 0, 1), derive.PointMarker("top", 0, 2)
    bodies = [derive.RigidBody("rod", mass=1, inertia=1, markers=[first])]
    assert derive.scene("free", bodies=bodies).bodies[0].markers[0].y == 1
    with pytest.raises(derive.SpecError, match='"top" is taken by another marker'):
        derive.scene("free", bodies=[derive.RigidBody("rod", mass=1, inertia=1, markers=[first, second])])


def test_states_of_other_lengths_are_refused() -> None:
    ball = derive.scene("ball", gravity=(0, -10), bodies={"ball": {"mass": 1, "inertia": 1}})
    native = derive.load_scene(derive.model_files(derive.lower(derive.derive(ball)), ball))
    k = native.setup()
    with pytest.raises(ValueError, match="q: a vector of 3 is needed"):
        derive.integrate(native, k, [0, 0], [0, 0, 0], [0, 1])
    with pytest.raises(ValueError, match="DOP853, RK45"):
        derive.integrate(native, k, [0, 0, 0], [0, 0, 0], [0, 1], method="dop853")
    with pytest.raises(ValueError, match="guess: a vector of 3 is needed"):
        derive.equilibrium(native, k, [0, 0])


def test_kernels_without_an_argument_say_which(equations: Any) -> None:
    with pytest.raises(ValueError, match="mass needs k as well"):
        derive.interpret(derive.lower(equations).kernel("mass"), {"q": [0] * 5})


@pytest.mark.parametrize(
    "study", [derive.study_accuracy, derive.choose, lambda scene: derive.study_stability(scene, ("P", 0, 1, 2))]
)
def test_studies_of_beams_need_a_beam(study: Any) -> None:
    with pytest.raises(derive.SpecError, match="bodies: there is no beam here"):
        study(BALL)
