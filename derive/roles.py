"""Facts that every stage can read: the roles of generalised coordinates, and the sources of formulas."""

from __future__ import annotations

from enum import Enum, StrEnum


class Role(Enum):
    """The kind of a generalised coordinate; the values are those of the descriptor of a generated model.

    Examples:
        >>> import derive
        >>> beam = derive.planar_beam("beam")
        >>> model = derive.lower(derive.derive(beam))
        >>> [coordinate.name for coordinate in model.coordinates if coordinate.role is derive.Role.AMPLITUDE]
        ['alpha1', 'alpha2']
    """

    TRANSLATION = 1
    """Component of the position of the origin of a floating frame in the inertial frame."""
    ROTATION = 2
    """Rotation angle of a floating frame."""
    QUATERNION = 3
    """Component of the unit quaternion of a floating frame, scalar first."""
    DISPLACEMENT = 4
    """Displacement of a body along its guide."""
    AMPLITUDE = 5
    """Amplitude of an assumed mode."""


class Source(StrEnum):
    """The source of a formula that has no equation number in the paper; the value is its text.

    Other formulas have the numbers of their equations in parentheses, such as "(15)", in its place.
    """

    APPENDIX = "appendix"
    """The definitions of the shape integrals and their sums in the appendix of the paper."""
    SECOND_ORDER = "second order"
    """Kinematics of second order, which is beyond the paper."""
    STRETCHING = "stretching"
    """Strain of the axis of a beam, which is beyond the paper."""
    FACTORISATION = "LDL^T"
    """The solution of a linear system by a factorisation."""
