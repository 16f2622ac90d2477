"""Whirling shafts beside their theory: frequencies, damping of the material, two stiffnesses, inertia of sections."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from test_space_stability import ALONG, CRITICAL, GROUND, INERTIA, RIGHT, compiled, rod

import derive
from derive.study.stability.eigenvalues import Eigenvalues


@cache
def whirling(order: int) -> Callable[..., Eigenvalues]:
    """A shaft with one half sine wave that turns at `spin`, with the damping of its material and of the air.

    inner (s): the factor of the stiffness; outer (N s/m): of a damper that stands still at the middle; other (N m^2):
    the bending stiffness about the second axis.
    """
    outer = {"symbol": "outer", "default": 0}
    scene = derive.spatial_scene(
        "whirling",
        ground={**GROUND, "middle": ("1/2", 0, 0)},
        bodies={
            "coupling": {"markers": {"shaft": {"at": (0, 0, 0), "rotation": ALONG}}},
            "rod": rod(
                ansatz={"kind": "pinned", "count": 1},
                lateral={"bending_stiffness": {"symbol": "other", "default": 1}},
                damping={"stiffness": {"symbol": "inner", "default": 0}},
                order=order,
            ),
        },
        joints={
            "motor": {"kind": "revolute", "between": ["ground.left", "coupling.shaft"]},
            "left": {"kind": "general", "removes": ["x", "y", "z", "rz"], "between": ["coupling.shaft", "rod.left"]},
            "right": RIGHT,
        },
        drives={"speed": {"joint": "motor", "speed": {"symbol": "spin", "default": 1}}},
        springs={
            "air": {
                "kind": "bushing",
                "between": ["ground.middle", "rod.middle"],
                "stiffness": [0] * 6,
                "damping": [0, outer, outer, 0, 0, 0],
            }
        },
        start="steady",
    )
    return compiled(scene)


def test_a_shaft_without_damping_whirls_at_its_frequency_beside_the_spin() -> None:
    """Forwards and backwards: p^2 -+ e spin p - w^2 = 0 in axes that stand still, with e = J pi^2/(m l^2)."""
    for spin in (3.0, 12.0):
        at = whirling(2)(spin=spin)
        forward, backward = (np.roots([1, -sign * INERTIA * spin, -(CRITICAL**2)]).max() for sign in (1, -1))
        assert at.growing == 0
        assert at.frequencies == pytest.approx(sorted([abs(forward - spin), backward + spin]), rel=1e-6)


def test_the_damping_of_the_material_makes_a_shaft_unstable_above_its_critical_speed() -> None:
    """Forward whirl at p = spin/s grows if p is above its frequency, with s = 1 + outer/inner damping of the mode."""
    inner, of_mode = 0.002, CRITICAL**2 / 2
    for outer in (0.0, 0.05):
        s = 1 + outer / (inner * of_mode)
        lost = s * CRITICAL / np.sqrt(1 - s * INERTIA)
        below, above = (whirling(2)(spin=part * lost, inner=inner, outer=outer) for part in (1 - 1e-4, 1 + 1e-4))
        assert (below.growing, above.growing) == (0, 1)


def test_a_shaft_with_two_stiffnesses_is_unstable_between_both_critical_speeds() -> None:
    low, high = (np.sqrt(stiffness) * CRITICAL / np.sqrt(1 - INERTIA) for stiffness in (1.0, 1.2))
    spins = [(1 - 1e-4) * low, (1 + 1e-4) * low, (1 - 1e-4) * high, (1 + 1e-4) * high]
    assert [whirling(2)(spin=spin, other=1.2).growing for spin in spins] == [0, 1, 1, 0]


def test_first_order_has_half_of_what_the_inertia_of_the_sections_adds() -> None:
    """The displacements t x p of first order alone turn the inertia J with the sections by half."""
    lost = CRITICAL / np.sqrt(1 - INERTIA / 2)
    assert [whirling(1)(spin=part * lost, inner=0.002).growing for part in (1 - 1e-4, 1 + 1e-4)] == [0, 1]
