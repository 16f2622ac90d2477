"""Random scenes in space that start in a steady rotation: a shaft, and bodies on it that stiff springs hold.

The velocities of the start are those of one rotation about the shaft, which is along gravity if there is gravity.
Springs about joints and bushings are much stiffer than weight and centrifugal forces, so that the steady state is near.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from corpus.draws import rounded

if TYPE_CHECKING:
    from corpus.spatial_scenes import SolidBody, SpatialDraft

STIFF = 50.0
"""The stiffness of springs over that at which weight and centrifugal forces would bend them by about 1."""
HELD = ("revolute", "spherical", "bushing")
"""How a body is held: on a hinge with a spring about it, on a ball with a bushing, or by a bushing alone."""


def steady_scene(draft: SpatialDraft) -> None:
    """Draw a shaft on the ground, one to three bodies on it and on each other, and velocities of their rotation."""
    draws, gravity = draft.draws, draft.draws.chance(0.6)
    draft.section("scene")["start"] = "steady"
    if gravity:
        draft.section("scene")["gravity"] = [0, 0, -9.81]
    axis = np.array([0.0, 0.0, 1.0]) if gravity else draft.direction()
    through, spin = draft.vector(draft.size), rounded(draft.rate * draws.between(0.5, 2) * draws.sign(), 2)
    shaft = draft.body(flexible=False)
    draft.joint("revolute", draft.ground, shaft, through, axes_along(axis))
    before = [shaft]
    for _ in range(draws.whole(1, 3)):
        body = draft.body(flexible=False)
        base = draws.choice(before)
        _hold(draft, base, body, spin)
        before.append(body)
    for body in before:
        velocity, turning = np.cross(spin * axis, body.x - through), body.R.T @ (spin * axis)
        draft.section("bodies")[body.name]["start"] = {
            "position": [float(x) for x in body.x],
            "rotation": draft.written_rotation(body.R),
            "velocity": [rounded(float(x), 15) for x in velocity],
            "angular_velocity": [rounded(float(x), 15) for x in turning],
        }


def axes_along(z: np.ndarray) -> np.ndarray:
    """Axes of which the third is a unit vector."""
    x = np.cross(np.eye(3)[int(np.argmin(np.abs(z)))], z)
    x = x / np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])


def _hold(draft: SpatialDraft, base: SolidBody, body: SolidBody, spin: float) -> None:
    """Connect a body to another one by a joint with a spring, or by a bushing."""
    kind = draft.draws.choice([*HELD])
    at, axes = base.x + draft.vector(draft.size), draft.rotation()
    per_length = STIFF * 10 * (9.81 / draft.size + spin**2)  # of bodies of up to 5 kg, and of what they carry
    turning, name = rounded(per_length * draft.size**2, 2), draft.name("springs")
    if kind == "revolute":
        joint = draft.joint(kind, base, body, at, axes)
        ends = draft.section("joints")[joint]["between"]
        table = {"kind": "rotational", "between": ends, "stiffness": turning, "damping": rounded(0.01 * turning, 2)}
    else:
        ends = [draft.marker(base, at, axes), draft.marker(body, at, axes)]
        if kind == "spherical":
            draft.section("joints")[draft.name("joints")] = {"kind": kind, "between": ends}
        stiffness = [0 if kind == "spherical" else rounded(per_length, 2)] * 3 + [turning] * 3
        table = {"kind": "bushing", "between": ends, "stiffness": stiffness}
    draft.section("springs")[name] = table
