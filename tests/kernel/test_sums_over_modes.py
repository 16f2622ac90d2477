"""Flexible bodies with many modes in loops: sums over modes in loops over tables, compliances of modes as constants."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from both_lowerings import both, check
from clouds import MODES, chain, in_blocks, state
from numpy.typing import NDArray

import derive
from conftest import QUICK
from derive.backends.c.source import CBackend
from derive.ir.analysis import names_read
from derive.ir.expressions import Element, Expr, ScalarRef, walk
from derive.ir.factor_tables import ROW
from derive.ir.indices import LANE
from derive.ir.interpreter import interpret
from derive.ir.loop_nests import Assign, For, Node, every, expressions_of
from derive.ir.model import Model
from derive.ir.statements import ForEach, Let, Work
from derive.ir.sums_over_modes import with_sums_over_modes
from derive.ir.symmetric_tables import MATRIX
from derive.ir.written_out_rows import with_rows_written_out
from derive.lowering.instances.functions.body_motions import MOTIONS
from derive.lowering.instances.functions.constant_modes import ConstantModes, constant_modes
from derive.lowering.instances.lower import lower_instances
from derive.lowering.mechanism_costs import estimate_mechanism_costs, is_predicted
from derive.lowering.model_functions import FORMS
from derive.mechanics.multibody.space.mechanism import SpatialMechanism
from derive.runtime.loading import load_scene
from some_functions import only

KINDS = ("fixed", "revolute", "spherical")
NAMES = ("mass", "force", "accel", "energy", "constraint_jacobian", "project_velocity")
NEEDED = ("mass_force", "momentum", "rates", "constraint_bias", "solve")
"""Functions besides these that the text of C, or a test, asks for."""


@cache
def lowered(
    count: int, alike: bool = False, names: tuple[str, ...] = (*NAMES, *NEEDED)
) -> tuple[Model, list[ConstantModes | None]]:
    """A chain in loops with the functions of these names, and what `constant_modes` returned for its bodies."""
    returned: list[ConstantModes | None] = []

    def noted(*of: Any) -> ConstantModes | None:
        returned.append(constant_modes(*of))
        return returned[-1]

    mechanism = derive.derive(chain(count, ("fixed",), alike))
    assert isinstance(mechanism, SpatialMechanism)
    with only(*names), pytest.MonkeyPatch.context() as patch:
        patch.setattr("derive.lowering.instances.functions.local_system.constant_modes", noted)
        return lower_instances(mechanism, explicit=True), returned


def looped(count: int, alike: bool = False) -> Model:
    return lowered(count, alike)[0]


def of_kinds(kinds: tuple[str, ...]) -> Model:
    mechanism = derive.derive(chain(3, kinds))
    assert isinstance(mechanism, SpatialMechanism)
    with only(*NAMES, *NEEDED):
        return lower_instances(mechanism, explicit=True)


@cache
def summed(count: int, alike: bool = False) -> Model:
    return with_sums_over_modes(looped(count, alike))


def is_load(line: Node) -> bool:
    return isinstance(line, Let) and isinstance(line.expr, Element)


def is_factor(part: Expr) -> bool:
    """Whether a number is one of those that the bodies have in other places too."""
    return isinstance(part, Element) and part.array.startswith("numbers")


def loops_over(variable: str, model: Model, name: str) -> Iterator[For]:
    nodes = every(in_blocks(model.kernel(name))[1])
    return (node for node in nodes if isinstance(node, For) and node.variable == variable)


def loops_over_rows(model: Model, name: str) -> Iterator[For]:
    return loops_over(ROW, model, name)


@pytest.mark.long
@pytest.mark.parametrize(("count", "alike"), [(3, False), (6, False), (3, True)])
def test_loops_over_rows_compute_the_sums(count: int, alike: bool) -> None:
    """Of blocks of bodies that overlap, of fewer bodies than lanes, and of bodies that are alike."""
    model = looped(count, alike)
    changed = summed(count, alike)
    for name in NAMES:
        kernel, nodes = in_blocks(changed.kernel(name))
        expected, found = interpret(model.kernel(name), state(kernel)), interpret(kernel, state(kernel), nodes=nodes)
        for output, values in expected.items():
            assert np.abs(np.subtract(found[output], values)).max() < 2e-13 * np.abs(values).max(), name
    assert [loop.count for loop in loops_over_rows(changed, "accel")] == [12, 12]  # places of markers, and their rates
    loops = [(loop.count, len(loop.body)) for loop in loops_over(MATRIX, changed, "accel")]
    # C5 of the six products of components with J, whose factors are C4; c7 by amplitudes, and by their rates
    assert loops == [(6, MODES + 1), (3, MODES), (3, MODES)]


def test_the_rows_of_a_body_alone_lie_beside_each_other() -> None:
    """The fifth of five bodies is in no vector of bodies: vectors have four of its rows."""
    model = lowered(5, names=("accel",))[0]
    changed = with_sums_over_modes(model)
    rows = {loop.count for loop in loops_over_rows(changed, "accel")}
    assert rows == {12, 20, 36, 44}  # those of vectors of bodies have 12
    columns = [array for array in changed.kernel("accel").constants if array.name.startswith("columns_of_factors")]
    assert columns
    kernel = changed.kernel("accel")
    expected, found = (interpret(of.kernel("accel"), state(kernel)) for of in (model, changed))
    assert np.abs(np.subtract(found["vdot"], expected["vdot"])).max() < 2e-13 * np.abs(expected["vdot"]).max()


def test_rows_have_no_columns_for_the_modes_of_another_body() -> None:
    """A joint needs sums over the modes of both of its bodies, and their loops stay loops in the text of C."""
    model = summed(3)
    for loop in loops_over_rows(model, "accel"):
        (line,) = loop.body
        assert isinstance(line, Assign)
        assert sum(isinstance(part, ScalarRef) for part in walk(line.expr)) <= MODES
    (text,) = (file.text for file in CBackend().files(looped(3), "") if file.path.endswith(".c"))
    heads = [line.strip() for line in text.splitlines() if f"; {ROW} < 12; {ROW}++" in line]
    assert heads and all(head.startswith("TISSERAND_SHORT for") for head in heads)


def test_places_of_markers_have_the_rows_of_their_velocities() -> None:
    """A body computes both for its joints; the constant terms of the places are added behind the loops."""
    loops = [loop for loop in loops_over_rows(summed(3), "accel") if loop.count == 12]
    read = [[part for node in loop.body for expr in expressions_of(node) for part in walk(expr)] for loop in loops]
    tables = {frozenset(filter(is_factor, parts)) for parts in read}
    assert len(loops) == 2  # of the amplitudes, and of their rates
    assert len(tables) == 1


def test_behind_rows_numbers_are_read_where_they_are_needed() -> None:
    """Before loops over rows is what they need alone; a load behind them is read by the next line that is none."""
    _, nodes = in_blocks(summed(3).kernel("accel"))
    blocks = [node.body for node in every(nodes) if isinstance(node, For) and node.variable == LANE]
    with_rows = [body for body in blocks if any(isinstance(line, For) for line in body)]
    for body in with_rows:
        loops = [line for line in body if isinstance(line, For)]
        last = body.index(loops[-1])
        before = [line.name for line in body[:last] if isinstance(line, Let)]
        assert set(before) <= set(names_read(body[: last + 1]))
        lines = body[last + 1 :]
        for k, line in enumerate(lines):
            if isinstance(line, Let) and is_load(line):
                assert line.name in names_read([next(other for other in lines[k:] if not is_load(other))])
    assert with_rows


def test_rows_that_are_written_out_have_the_bits_of_loops() -> None:
    changed = summed(3)
    written = with_rows_written_out(changed)
    for name in NAMES:
        kernel, other = changed.kernel(name), written.kernel(name)
        assert interpret(other, state(other)) == interpret(kernel, state(kernel))
        assert not any(isinstance(item, Work) for s in other.statements if isinstance(s, ForEach) for item in s.body)


@pytest.mark.long
@pytest.mark.parametrize("kinds", [("fixed",), ("cylindrical",), KINDS])
def test_chains_of_bodies_with_many_modes(kinds: tuple[str, ...]) -> None:
    """Loops and straight-line code agree in states in which no constraint is met and all sections turn."""
    check(both(chain(max(2, len(kinds)), kinds), True))


@pytest.mark.parametrize(
    "kinds",
    [("fixed",), *(pytest.param(of, marks=pytest.mark.long) for of in (("spherical", "fixed"), ("prismatic",)))],
)
def test_a_joint_to_the_ground_has_the_code_of_those_between_bodies(kinds: tuple[str, ...]) -> None:
    """Its accelerations are those of M, h, G and gamma, which compute it by itself.

    No constraint is met, nor is its rate: rows along the axes of the first body are other than those of the joints.
    """
    model = looped(3) if kinds == ("fixed",) else of_kinds(kinds)
    arrays = {line.array for s in model.kernel("solve").sections for line in s.body if isinstance(line, Work)}
    assert ({MOTIONS} if kinds != ("prismatic",) else {"q_of_joint_1_and_ground", "v_of_joint_1_and_ground"}) <= arrays
    given = state(model.kernel("solve"))
    q = given["q"]
    assert isinstance(q, list)
    for first in range(3, len(q), 7 + MODES):
        q[first : first + 4] = np.divide(q[first : first + 4], np.linalg.norm(q[first : first + 4])).tolist()

    def values(name: str) -> dict[str, list[float]]:
        kernel = model.kernel(name)
        return interpret(kernel, {a.name: given[a.name] for a in kernel.arguments})

    def matrix(name: str, output: str) -> NDArray[np.float64]:
        of = next(out.pattern for out in model.kernel(name).outputs if out.name == output)
        assert of
        return of.dense(np.array(values(name)[output]))

    G, found = matrix("constraint_jacobian", "G"), values("solve")
    kkt = np.block([[matrix("mass", "M"), -G.T], [G, np.zeros((len(G), len(G)))]])
    expected = np.linalg.solve(kkt, [*np.negative(values("force")["h"]), *values("constraint_bias")["gamma"]])
    assert np.abs(expected - [*found["vdot"], *found["lam"]]).max() < 1e-10 * np.abs(expected).max()


def test_rows_of_like_bodies_are_looped_by_themselves() -> None:
    """With six modes, from three bodies on, and in the code of loops that are asked for: bodies share their numbers."""

    def chosen(scene: derive.SpatialScene) -> str | None:
        mechanism = derive.derive(replace(scene, lowering="auto"))
        assert isinstance(mechanism, SpatialMechanism)
        return estimate_mechanism_costs(mechanism).lowering if is_predicted(mechanism) else None

    two, three = (chain(count, ("fixed",)) for count in (2, 3))
    assert [chosen(two), chosen(three)] == [None, "instances"]
    with only("accel"):
        auto = derive.lower(derive.derive(replace(three, lowering="auto")), explicit=True)
    assert auto.kernel("accel").sections == looped(3).kernel("accel").sections
    assert auto.choice.startswith("looped over instances, the faster form")
    first, *others = three.bodies
    assert isinstance(first, derive.FlexibleBody)
    unlike = replace(three, bodies=(replace(first, body=replace(first.body, modes=2)), *others))
    assert chosen(unlike) == "flat"
    assert chosen(replace(three, joints=(*three.joints, replace(three.joints[0], name="other")))) is None  # a loop


@pytest.mark.long
def test_c_computes_them_and_batches_have_its_bits() -> None:
    model = lower_instances(derive.derive(chain(6, ("fixed",))), explicit=True)
    scene = load_scene((*CBackend().files(model, ""),), QUICK)
    rng, k = np.random.default_rng(5), scene.setup()
    q, v = rng.uniform(-0.3, 0.3, (11, scene.nq)), rng.uniform(-1, 1, (11, scene.nv))
    for name in ("force", "accel"):
        single = [getattr(scene, name)(0.0, *state, k) for state in zip(q, v, strict=True)]
        kernel = model.kernel(name)
        (expected,) = interpret(kernel, {"t": 0.0, "q": q[0].tolist(), "v": v[0].tolist(), "k": k.tolist()}).values()
        assert np.abs(single[0] - expected).max() < 2e-13 * np.abs(expected).max()
        assert getattr(scene, f"{name}_batch")(0.0, q, v, k).tobytes() == np.array(single).tobytes(), name


@pytest.mark.long
def test_c_computes_the_forms_of_chains_for_implicit_integrators() -> None:
    """Residuals and iteration matrices of all forms, in loops, as the interpreter computes them."""
    model = lower_instances(derive.derive(chain(3, ("revolute",))))
    scene = load_scene((*CBackend().files(model, ""),), QUICK)
    rng, k = np.random.default_rng(6), scene.setup()
    assert set(scene.dae) == set(FORMS) - {""} | {"index3"}
    for form in FORMS:
        own = model.kernel(f"residual_{form}" if form else "residual")
        size = own.outputs[0].size
        y, ydot = rng.uniform(-0.3, 0.3, (2, size))
        given = {"t": 0.2, "y": y.tolist(), "ydot": ydot.tolist(), "cj": 30.0, "k": k.tolist()}
        native = scene.dae[form or "index3"]
        found = {"residual": native.residual(0.2, y, ydot, k), "jacobian": native.jacobian(0.2, y, ydot, 30.0, k)}
        for kind, values in found.items():
            kernel = model.kernel(f"{kind}_{form}" if form else kind)
            (expected,) = interpret(kernel, {a.name: given[a.name] for a in kernel.arguments}).values()
            assert np.abs(values - expected).max() < 2e-13 * np.abs(expected).max(), kernel.name


def test_coefficients_take_the_place_of_factors() -> None:
    """A joint hands a body three coefficients for its rotation and three for its modes, however many modes it has."""
    _, of_bodies = lowered(3, False)
    assert of_bodies and all(of_bodies)
    assert {len(row.coefficients) for of in of_bodies if of for row in of.rows} == {1, 3}  # 1 along its own axes
