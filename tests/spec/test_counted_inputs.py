"""Numbers of instances that are set, and drives, symbols and inputs with `count`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from test_instances import CHAIN, EXAMPLES, chain

import derive
from conftest import QUICK
from derive.backends.model_files import emit
from derive.cli.specifications import read_changed
from derive.errors import SpecError
from derive.spec.set_values import with_values
from derive.spec.toml.read import parse
from explicit_motion import moved


def test_the_number_of_instances_may_be_set(tmp_path: Path) -> None:
    file = tmp_path / "chain.toml"
    file.write_text((EXAMPLES / "chain_100.toml").read_text())
    scene, changes = read_changed(
        file, [("bodies.link.count", "12"), ("joints.weld.count", "11"), ("bodies.link[3].mass", "2")]
    )
    assert [body.name for body in scene.bodies] == [f"link[{i}]" for i in range(12)] and len(scene.joints) == 12
    assert [str(change) for change in changes][:2] == ["bodies.link.count: 100 -> 12", "joints.weld.count: 99 -> 11"]
    with pytest.raises(SpecError, match=r"29: joints\.weld\.between.*the count of link is 12"):
        read_changed(file, [("bodies.link.count", "12")])
    with pytest.raises(SpecError, match=r"bodies\.link\.count: there are 4, and another number makes another model"):
        with_values(parse(CHAIN), {"bodies.link.count": "5"})


DRIVEN = """\
name = "driven"
[ground.markers]
hook = [0, 0]
[bodies.hub]
count = 3
mass = 1
inertia = 0.1
markers = { a = [0, 0], b = [1, 0] }
start = { position = ["i", 0] }
[joints.first]
kind = "revolute"
between = ["ground.hook", "hub[0].a"]
[joints.pin]
count = 2
kind = "revolute"
between = ["hub[i].b", "hub[i+1].a"]
[drives.motor]
count = 2
joint = "pin[i]"
motion = "0.1*(i + 1)*sin(t)"
[simulation]
duration = 0.1
output = 0.05
"""


def test_drives_may_have_a_count() -> None:
    motion = moved(parse(DRIVEN))
    assert motion["motor[1]"] == pytest.approx(0.2 * np.sin(motion.t))
    assert motion["hub[2]_phi"] - motion["hub[1]_phi"] == pytest.approx(0.2 * np.sin(motion.t), abs=1e-9)
    assert {"motor[0]", "lambda_motor[0]", "lambda_motor[1]"} <= set(motion.columns)


PUSHED = (
    DRIVEN.replace('motion = "0.1*(i + 1)*sin(t)"', 'motion = { input = "turn[i]" }')
    + """
[inputs.turn]
count = 2
unit = "rad"
value = "0.1*(i + 1)*sin(t)"
[inputs.push]
count = 3
unit = "N"
value = "0.3*i"
[forces.push]
count = 3
at = "hub[i].b"
components = [0, { input = "push[i]" }]
"""
)


def test_symbols_may_have_the_index() -> None:
    spec = parse(chain(("length = 0.1\n", 'length = { symbol = "L[i]", default = "0.1 + i/100" }\n')))
    lengths = [body.beam.length for body in spec.bodies]
    assert [length.symbol for length in lengths] == [f"L_{i}" for i in range(4)]
    assert lengths[1].default == 0.11


def test_inputs_may_have_a_count() -> None:
    """They give the motion of the scene in which their values are written, and have names and columns of instances."""
    by_hand = DRIVEN + '[forces.push]\ncount = 3\nat = "hub[i].b"\ncomponents = [0, "0.3*i"]\n'
    np.testing.assert_array_equal(moved(parse(PUSHED)).q, moved(parse(by_hand)).q)
    given = {f"turn[{i}]": lambda t, i=i: 0.1 * (i + 1) * np.array([np.sin(t), np.cos(t), -np.sin(t)]) for i in (0, 1)}
    motion = moved(parse(PUSHED), inputs=given)
    np.testing.assert_allclose(motion["u_turn[1]_dot"], 0.2 * np.cos(motion.t), rtol=1e-14)
    assert [given.name for given in motion.model.inputs][:3] == ["turn_0", "turn_0_dot", "turn_0_ddot"]
    with pytest.raises(SpecError, match=r'components\[1\]: for i = 2: there is no input "push\[2\]"'):
        parse(PUSHED.replace('count = 3\nunit = "N"', 'count = 2\nunit = "N"'))


@pytest.mark.parametrize("lowering", ["flat", "instances"])
def test_loaded_inputs_have_names_of_instances(lowering: str) -> None:
    spec = parse(PUSHED.replace("[ground", f'[scene]\nlowering = "{lowering}"\n[ground'))
    native = derive.load(emit(derive.lower(derive.derive(spec)), spec), QUICK)
    assert native.inputs[2:5] == ("turn[0]_ddot", "turn[1]", "turn[1]_dot") and native.inputs[-1] == "push[2]"
