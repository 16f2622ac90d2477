"""The revolute joint: two markers coincide, and the bodies rotate freely against each other."""

from __future__ import annotations

from derive.mechanics.multibody.joints.joint_type import Drawing, JointType
from derive.mechanics.multibody.joints.relative_rows import ALONG_E1, ALONG_E2, ROTATION


class Revolute(JointType):
    """A revolute joint: no displacement between the markers; a drive prescribes the relative rotation."""

    doc = "the markers coincide"
    removes = (ALONG_E1, ALONG_E2)
    driven = ROTATION
    drawing = Drawing(circles=(((0.0, 0.0), 1.0),))
