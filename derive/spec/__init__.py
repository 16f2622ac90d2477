"""Specifications of bodies and scenes: frozen data that `derive` takes, from TOML by `read` or from Python."""

from derive.spec.body import (
    BodyFrame,
    Damping,
    Frame,
    Gravity,
    Marker,
    NodalBody,
    NodeData,
    NodeMarker,
    Parameter,
    PlanarBeam,
    Polynomial,
    Quantity,
    SymbolicBody,
)
from derive.spec.errors import Problem, SpecError
from derive.spec.read import json_schema, nodal_body, parse, planar_beam, read, symbolic_body
from derive.spec.scene import Scene
from derive.spec.specification import Specification

__all__ = [
    "BodyFrame",
    "Damping",
    "Frame",
    "Gravity",
    "Marker",
    "NodalBody",
    "NodeData",
    "NodeMarker",
    "Parameter",
    "PlanarBeam",
    "Polynomial",
    "Problem",
    "Quantity",
    "Scene",
    "SpecError",
    "Specification",
    "SymbolicBody",
    "json_schema",
    "nodal_body",
    "parse",
    "planar_beam",
    "read",
    "symbolic_body",
]
