"""Models in loops explain their zeros as straight-line ones do, those of one body of each kind."""

from __future__ import annotations

import derive
from conftest import ROOT
from derive.lowering.flat.lower import lower as lower_flat
from derive.lowering.instances.lower import lower_instances
from derive.mechanics.multibody.mechanism import Mechanism


def test_the_zeros_of_a_kind_are_those_of_its_first_body() -> None:
    mechanism = derive.derive(derive.read(ROOT / "scenes/double_pendulum.toml"))
    assert isinstance(mechanism, Mechanism)
    flat, looped = lower_flat(mechanism.expanded()), lower_instances(mechanism)
    for every, of_kinds in ((flat.zeros, looped.zeros), (flat.vanished, looped.vanished)):
        *first, others = of_kinds
        assert first and list(first) == [zero for zero in every if "upper" in zero.what and "lower" not in zero.what]
        assert (others.what, others.reason) == ("those of another body", "as those of upper")
