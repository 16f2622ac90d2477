"""The descriptor of a generated model as ctypes see it: the structures of its header, member by member."""

from __future__ import annotations

import ctypes
from typing import Any

from derive.function_names import OF_MODELS
from derive.ir.model import element_names
from derive.ir.patterns import Pattern
from derive.roles import Role


class VariableStruct(ctypes.Structure):
    """The C structure `tisserand_variable`."""

    _fields_ = [
        ("name", ctypes.c_char_p),
        ("unit", ctypes.c_char_p),
        ("doc", ctypes.c_char_p),
        ("value", ctypes.c_double),
        ("size", ctypes.c_int),
        ("role", ctypes.c_int),
    ]


class PatternStruct(ctypes.Structure):
    """The C structure `tisserand_pattern`."""

    _fields_ = [
        *((name, ctypes.c_int) for name in ("rows", "cols", "nnz", "symmetric")),
        ("colptr", ctypes.POINTER(ctypes.c_int)),
        ("rowidx", ctypes.POINTER(ctypes.c_int)),
        ("fill", ctypes.CFUNCTYPE(ctypes.c_int, ctypes.POINTER(ctypes.c_int), ctypes.POINTER(ctypes.c_int))),
    ]


Doubles = ctypes.c_void_p
"""An array of doubles, which callers give as the address of an array: a typed pointer takes longer than many calls."""


def _function(*arguments: Any) -> Any:
    return ctypes.CFUNCTYPE(ctypes.c_int, *arguments)


class MarkerStruct(ctypes.Structure):
    """The C structure `tisserand_marker`."""

    _fields_ = [
        ("name", ctypes.c_char_p),
        ("dimension", ctypes.c_int),
        ("pattern", ctypes.POINTER(PatternStruct)),
        ("evaluate", _function(*[Doubles] * 6)),
        ("load", _function(*[Doubles] * 4)),
        ("rotation_pattern", ctypes.POINTER(PatternStruct)),
        ("derivatives", ctypes.POINTER(PatternStruct)),
        ("rotation", _function(*[Doubles] * 5)),
        ("jacobian_of_rotation", _function(*[Doubles] * 4)),
    ]


class MarkerClassStruct(ctypes.Structure):
    """The C structure `tisserand_marker_class`."""

    _fields_ = [
        ("name", ctypes.c_char_p),
        ("count", ctypes.c_int),
        ("dimension", ctypes.c_int),
        ("names", ctypes.POINTER(ctypes.c_char_p)),
        ("columns", ctypes.POINTER(ctypes.c_int)),
        ("pattern", ctypes.POINTER(PatternStruct)),
        ("evaluate", _function(ctypes.c_int, *[Doubles] * 6)),
        ("load", _function(ctypes.c_int, *[Doubles] * 4)),
    ]


_T = ctypes.c_double


class DaeStruct(ctypes.Structure):
    """The C structure `tisserand_dae`."""

    _fields_ = [
        ("name", ctypes.c_char_p),
        ("size", ctypes.c_int),
        ("pattern", ctypes.POINTER(PatternStruct)),
        ("residual", _function(_T, *[Doubles] * 4)),
        ("jacobian", _function(_T, Doubles, Doubles, _T, Doubles, Doubles)),
    ]


class SceneStruct(ctypes.Structure):
    """The C structure `tisserand_scene`."""

    _fields_ = [
        ("nbodies", ctypes.c_int),
        ("multipliers", ctypes.POINTER(VariableStruct)),
        ("bodies", ctypes.POINTER(ctypes.c_char_p)),
        ("pattern", ctypes.POINTER(PatternStruct)),
        ("forms", ctypes.POINTER(DaeStruct)),
        ("nforms", ctypes.c_int),
        ("constraints", _function(_T, *[Doubles] * 3)),
        ("constraint_rates", _function(_T, *[Doubles] * 4)),
        ("constraint_jacobian", _function(_T, *[Doubles] * 3)),
        ("constraint_bias", _function(_T, *[Doubles] * 4)),
        ("solve", _function(_T, *[Doubles] * 5)),
        ("project_velocity", _function(_T, *[Doubles] * 4)),
        ("poses", _function(_T, *[Doubles] * 3)),
    ]


class PortsStruct(ctypes.Structure):
    """The C structure `tisserand_ports`."""

    _fields_ = [
        ("nu", ctypes.c_int),
        ("nout", ctypes.c_int),
        ("u", ctypes.POINTER(VariableStruct)),
        ("out", ctypes.POINTER(VariableStruct)),
        ("pattern", ctypes.POINTER(PatternStruct)),
        ("outputs", _function(_T, *[Doubles] * 6)),
        ("outputs_jacobian", _function(_T, *[Doubles] * 6)),
    ]


class RequestedStruct(ctypes.Structure):
    """The C structure `tisserand_requested`."""

    _fields_ = [
        *((f"{name}_pattern", ctypes.POINTER(PatternStruct)) for name in ("centre", "momentum")),
        ("inverse_dynamics", _function(_T, *[Doubles] * 5)),
        ("gravity_compensation", _function(_T, *[Doubles] * 3)),
        ("centre_of_mass", _function(*[Doubles] * 7)),
        ("centroidal_momentum", _function(*[Doubles] * 5)),
        *((f"of_{name}", ctypes.POINTER(PatternStruct)) for name in OF_MODELS),
        ("inverse_dynamics_jacobian", _function(_T, *[Doubles] * 5)),
        ("gravity_compensation_jacobian", _function(_T, *[Doubles] * 3)),
        ("centre_of_mass_jacobian", _function(*[Doubles] * 4)),
        ("centroidal_momentum_jacobian", _function(*[Doubles] * 4)),
        ("inverse_dynamics_batch", _function(ctypes.c_int, _T, *[Doubles] * 5)),
        ("gravity_compensation_batch", _function(ctypes.c_int, _T, *[Doubles] * 3)),
        ("centre_of_mass_batch", _function(ctypes.c_int, *[Doubles] * 7)),
        ("centroidal_momentum_batch", _function(ctypes.c_int, *[Doubles] * 5)),
    ]


class ModelStruct(ctypes.Structure):
    """The C structure `tisserand_model`."""

    _fields_ = [
        ("abi", ctypes.c_int),
        ("name", ctypes.c_char_p),
        ("hash", ctypes.c_char_p),
        *((n, ctypes.c_int) for n in ("nq", "nv", "np", "nk", "nlambda")),
        *((f"variables_{n}", ctypes.c_int) for n in "qvpk"),
        *((n, ctypes.c_int) for n in ("nmarkers", "nenergy", "nmomentum")),
        *((n, ctypes.POINTER(VariableStruct)) for n in ("q", "v", "p", "k")),
        *((n, ctypes.POINTER(PatternStruct)) for n in ("mass_pattern", "jacobian_pattern")),
        ("markers", ctypes.POINTER(MarkerStruct)),
        ("defaults", _function(Doubles)),
        ("start", _function(Doubles, Doubles)),
        ("setup", _function(Doubles, Doubles)),
        ("mass", _function(Doubles, Doubles, Doubles)),
        ("force", _function(_T, *[Doubles] * 4)),
        ("mass_force", _function(_T, *[Doubles] * 5)),
        ("accel", _function(_T, *[Doubles] * 4)),
        ("energy", _function(*[Doubles] * 4)),
        ("momentum", _function(*[Doubles] * 4)),
        ("rates", _function(*[Doubles] * 4)),
        ("residual", _function(_T, *[Doubles] * 4)),
        ("jacobian", _function(_T, Doubles, Doubles, _T, Doubles, Doubles)),
        ("mass_batch", _function(ctypes.c_int, *[Doubles] * 3)),
        ("force_batch", _function(ctypes.c_int, _T, *[Doubles] * 4)),
        ("mass_force_batch", _function(ctypes.c_int, _T, *[Doubles] * 5)),
        ("accel_batch", _function(ctypes.c_int, _T, *[Doubles] * 4)),
        *((f"{n}_batch", _function(ctypes.c_int, *[Doubles] * 4)) for n in ("energy", "momentum", "rates")),
        ("scene", ctypes.POINTER(SceneStruct)),
        ("ports", ctypes.POINTER(PortsStruct)),
        ("parameter_pattern", ctypes.POINTER(PatternStruct)),
        ("parameter_jacobian", _function(_T, *[Doubles] * 4)),
        ("solve_kkt", _function(_T, *[Doubles] * 6)),
        ("requested", ctypes.POINTER(RequestedStruct)),
    ]


def names_of(variables: Any, count: int) -> tuple[str, ...]:
    """Names of variables; the elements of an array are numbered from 1."""
    names: list[str] = []
    for i in range(count):
        names += element_names(variables[i].name.decode(), variables[i].size)
    return tuple(names)


def roles_of(variables: Any, count: int) -> tuple[Role, ...]:
    """Roles of coordinates, one for each element of an array. Raises ValueError for a variable without a role."""
    return tuple(Role(variables[i].role) for i in range(count) for _ in range(variables[i].size))


def pattern_of(p: PatternStruct) -> Pattern:
    """The compressed columns of a pattern, written by its `fill` if they are not stored."""
    colptr, rowidx = p.colptr, p.rowidx
    if not colptr:
        colptr, rowidx = (ctypes.c_int * (p.cols + 1))(), (ctypes.c_int * p.nnz)()
        p.fill(colptr, rowidx)
    return Pattern(p.rows, p.cols, tuple(colptr[: p.cols + 1]), tuple(rowidx[: p.nnz]), bool(p.symmetric))
