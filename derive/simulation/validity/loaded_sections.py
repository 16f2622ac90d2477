"""The sections of a beam that something acts on: its ends, and where forces act within it."""

from __future__ import annotations

from collections.abc import Collection

from derive.mechanics.multibody.joints.registry import JOINTS
from derive.spec.model.beam_parts import Marker
from derive.spec.model.markers import MarkerRef
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.scene import Scene

TORQUE = "N m"
"""The unit of multipliers that hold a section against rotation."""


def free_ends(scene: Scene, beam: BeamBody) -> tuple[bool, bool]:
    """Whether nothing acts on the left and on the right end of a beam: no joint, force, spring and attached mass."""
    taken = {marker.at for marker in loaded_sections(scene, beam)} | {mass.at for mass in beam.beam.masses}
    return -1 not in taken, 1 not in taken


def loaded_sections(scene: Scene, beam: BeamBody) -> tuple[Marker, ...]:
    """The markers of a beam at which a joint, a force, a torque or a spring acts, one for each place."""
    return sections(beam, loaded_markers(scene))


def held_ends(scene: Scene, beam: BeamBody) -> tuple[Marker, ...]:
    """The markers at ends of a beam at which a torque can act on it, one for each end."""
    return tuple(marker for marker in sections(beam, turned_markers(scene)) if abs(marker.at) == 1)


def loaded_markers(scene: Scene) -> set[MarkerRef]:
    """The markers of all bodies at which a joint, a force, a torque or a spring acts."""
    elements = (*scene.forces, *scene.torques, *scene.springs)
    acting = {marker for element in elements for marker in element.markers}
    return acting | {marker for joint in scene.joints for marker in (joint.first, joint.second)}


def turned_markers(scene: Scene) -> set[MarkerRef]:
    """The markers of all bodies at which a torque can act."""
    driven = {drive.joint for drive in scene.drives}
    markers = {marker for element in (*scene.torques, *scene.springs) for marker in element.markers}
    for joint in scene.joints:
        known = JOINTS[joint.kind]
        units = {row.force_unit for row in known.removes}
        if known.driven is not None and joint.name in driven:
            units.add(known.driven.force_unit)
        if TORQUE in units:
            markers |= {joint.first, joint.second}
    return markers


def sections(beam: BeamBody, markers: Collection[MarkerRef]) -> tuple[Marker, ...]:
    """The markers of the beam among these, one for each place."""
    return tuple({m.at: m for m in beam.markers if MarkerRef(beam.name, m.name) in markers}.values())
