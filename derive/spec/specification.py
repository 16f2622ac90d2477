"""What `read` may return: a body alone, or a scene of bodies."""

from __future__ import annotations

from derive.spec.body import NodalBody, PlanarBeam, SymbolicBody
from derive.spec.scene import Scene

Specification = PlanarBeam | NodalBody | SymbolicBody | Scene
