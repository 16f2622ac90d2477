"""The translational joint: a marker moves on a line through another, without relative rotation of the bodies."""

from __future__ import annotations

from derive.mechanics.multibody.joints.joint_type import Drawing, JointType
from derive.mechanics.multibody.joints.relative_rows import ALONG_AXIS, NORMAL_TO_AXIS, ROTATION, Axes


class Translational(JointType):
    """A translational joint: no displacement normal to an axis fixed in the first body, and a constant rotation."""

    doc = "the second marker stays on a line through the first, and the relative rotation is constant"
    axes = Axes.OF_BODY_1
    removes = (NORMAL_TO_AXIS, ROTATION)
    driven = ALONG_AXIS
    drawing = Drawing(circles=(((0.0, 0.0), 1.0),), guide=True)
