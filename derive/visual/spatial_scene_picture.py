"""The drawing of a scene in space at t = 0 with undeformed bodies and the symbols of its joints."""

from __future__ import annotations

import numpy as np

from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS
from derive.simulation.configurations import quaternion_of
from derive.simulation.observables.spatial_player_data import BodyPath
from derive.simulation.observables.spatial_scene_player import PICTURE_TRIANGLES, drawn_bodies, ground_points, ties
from derive.spec.model.beam_pieces import in_pieces
from derive.spec.model.spatial_scene import SpatialJoint, SpatialScene
from derive.visual.spatial_mechanism import JointMark, JointSymbol, spatial_picture
from derive.visual.undeformed_spatial_poses import SpatialPosesByName, initial_spatial_poses, spatial_frame

DISPLACEMENTS = frozenset("xyz")
"""The relative motions of a joint that are no rotations."""


def undeformed_picture(scene: SpatialScene) -> str:
    """The picture of a scene at t = 0 with undeformed bodies, which needs no compiled model."""
    scene = in_pieces(scene)
    poses, bodies = initial_spatial_poses(scene), drawn_bodies(scene, PICTURE_TRIANGLES)
    paths = [
        BodyPath(poses[body.name][0][None], quaternion_of(poses[body.name][1])[None], np.zeros((1, len(body.phi))))
        for body in bodies
    ]
    marks = joint_marks(scene, poses)
    return spatial_picture(f"{scene.name} at t = 0", bodies, paths, ground_points(scene), ties(scene), marks)


def joint_marks(scene: SpatialScene, poses: SpatialPosesByName) -> list[JointMark]:
    """The symbols of joints at their second markers, but of those that ties show."""
    marks = []
    for joint in scene.joints:
        if not SPATIAL_JOINTS[joint.kind].keeps_distance:
            first, second = (spatial_frame(scene, end, poses) for end in (joint.first, joint.second))
            marks.append(JointMark(f"{joint.name}: {joint.kind}", _symbol(joint), second.position, first.axes[:, 2]))
    return marks


def _symbol(joint: SpatialJoint) -> JointSymbol:
    """The symbol of the relative motions that a joint leaves."""
    free = {*(SPATIAL_JOINTS[joint.kind].free(joint) or ())}
    rotations = len(free - DISPLACEMENTS)
    if free & DISPLACEMENTS:
        return JointSymbol.GUIDE_THAT_TURNS if rotations else JointSymbol.GUIDE
    return (JointSymbol.WELD, JointSymbol.HINGE, JointSymbol.UNIVERSAL, JointSymbol.BALL)[rotations]
