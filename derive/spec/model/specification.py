"""What `read` may return: a body alone, or a scene of bodies."""

from __future__ import annotations

from derive.spec.model.body import NodalBody, PlanarBeam, SymbolicBody
from derive.spec.model.scene import Scene

Specification = PlanarBeam | NodalBody | SymbolicBody | Scene
