"""The types of specifications: a body alone, a scene of planar bodies, or a scene of bodies in space."""

from __future__ import annotations

from derive.spec.model.beam import PlanarBeam
from derive.spec.model.body import NodalBody, SymbolicBody
from derive.spec.model.scene import Scene
from derive.spec.model.spatial_scene import SpatialScene

AnyScene = Scene | SpatialScene
"""A scene of planar bodies, or of bodies in space."""

Specification = PlanarBeam | NodalBody | SymbolicBody | Scene | SpatialScene
"""The types that `read` returns and `derive` takes: a body alone, or a scene of bodies."""


def check_specification(spec: object) -> None:
    """Raise TypeError if the argument is not a specification, for example the path of a file."""
    if not isinstance(spec, Specification):
        raise TypeError(f"a specification is needed, not {type(spec).__name__}; read a file with derive.read(...)")
