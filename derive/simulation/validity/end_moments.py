"""How well the shapes of a beam represent its bending moment: where it vanishes, and where two pieces meet.

The bending moment EI v'' of the exact deflection vanishes at free and pinned ends, and is the same on both sides of a
weld between two pieces. Shapes fulfil this only as far as they can represent the deflection: the curvature of two
polynomials of degree 2 and 3 is linear, that of a rod between two pins is not.
"""

from __future__ import annotations

from collections.abc import Iterator

from derive.mechanics.multibody.joints.registry import JOINTS
from derive.spec.model.scene import BeamBody, Scene

SECTIONS = 9
"""Sections of a piece in which the largest bending moment is looked for, both ends among them."""
TORQUE = "N m"
"""The unit of multipliers that hold a section against rotation."""


def held_ends(scene: Scene, beam: BeamBody) -> Iterator[int]:
    """The ends, -1 and 1, at which a torque can act on the beam."""
    driven = {drive.joint for drive in scene.drives}
    markers = [marker for element in (*scene.torques, *scene.springs) for marker in element.markers]
    for joint in scene.joints:
        known = JOINTS[joint.kind]
        units = {m.force_unit for m in known.multipliers}
        if known.driven is not None and joint.name in driven:
            units.add(known.driven.force_unit)
        if TORQUE in units:
            markers += [joint.first, joint.second]
    for marker in beam.markers:
        if abs(marker.at) == 1 and any((m.body, m.marker) == (beam.name, marker.name) for m in markers):
            yield int(marker.at)
