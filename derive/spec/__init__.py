"""Specifications of deformable bodies: `read` and `planar_beam` make the frozen data that `derive` takes."""

from derive.spec.body import Frame, Marker, Parameter, PlanarBeam, Polynomial, Quantity
from derive.spec.errors import Problem, SpecError
from derive.spec.read import json_schema, parse, planar_beam, read

__all__ = [
    "Frame",
    "Marker",
    "Parameter",
    "PlanarBeam",
    "Polynomial",
    "Problem",
    "Quantity",
    "SpecError",
    "json_schema",
    "parse",
    "planar_beam",
    "read",
]
