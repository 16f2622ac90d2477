"""Bodies with the same shapes and other numbers integrate these shapes once."""

import pytest

import derive
from derive.mechanics.bodies.beam_functions import BeamFunction


def tapered(count: int) -> derive.Scene:
    rod = {"ansatz": ["1", "xi", "xi^2 + 7*xi^3"], "length": 0.5, "bending_stiffness": 3, "markers": {"end": 1}}
    return derive.scene("tapered", bodies={f"rod_{k}": rod | {"mass": 1 + k} for k in range(count)})


def test_rods_with_the_same_shapes_integrate_them_once(monkeypatch: pytest.MonkeyPatch) -> None:
    calls = []
    integrate = BeamFunction.antiderivative
    monkeypatch.setattr(BeamFunction, "antiderivative", lambda of: calls.append(of) or integrate(of))
    derive.derive(tapered(1))
    first = len(calls)
    mechanism = derive.derive(tapered(4))
    assert first > 5 and len(calls) == first
    assert len(mechanism.instances) == 4 and len(mechanism.kinds) == 1
