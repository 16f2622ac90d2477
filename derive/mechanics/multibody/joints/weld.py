"""The weld: two markers coincide, and the bodies do not rotate against each other."""

from __future__ import annotations

from derive.mechanics.multibody.joints.joint_type import Drawing, JointType
from derive.mechanics.multibody.joints.relative_rows import ALONG_E1, ALONG_E2, ROTATION


class Weld(JointType):
    """A weld: no displacement between the markers, and a constant relative rotation."""

    doc = "the markers coincide and the relative rotation is constant"
    removes = (ALONG_E1, ALONG_E2, ROTATION)
    drawing = Drawing(lines=(((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)),))
