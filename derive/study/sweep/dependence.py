"""The parameters on which the initial state of a scene depends: it is computed once for all values of the others."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction
from typing import Any, TypeVar

from derive.ir.analysis import reads
from derive.ir.model import Model
from derive.ir.statements import Let, Require, Statement, Store
from derive.spec.model.planar_bodies import BeamBody, SceneBody
from derive.spec.model.quantity import Parameter
from derive.spec.model.scene_functions import function_parameters, input_functions, time_functions
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene

KERNELS = ("mass", "constraints", "constraint_rates", "constraint_jacobian", "poses")
"""The functions of a model that `initial_state` calls, unless it computes a static equilibrium."""

T = TypeVar("T")


def initial_parameters(scene: AnyScene, model: Model) -> frozenset[str]:
    """The symbols of the parameters that the initial state, the size and the breaks of a scene may depend on.

    A parameter is left out only if none of the compiled functions that compute the initial state reads it, and if it
    stands nowhere in the scene but in bending stiffnesses, damping, forces and gravity, which nothing else reads. In
    space all parameters count.
    """
    if isinstance(scene, SpatialScene) or scene.start is not None:  # a static equilibrium depends on all forces
        return frozenset(parameter.name for parameter in model.parameters)
    geometry = (scene.ground, tuple(map(_without_stiffness, scene.bodies)), scene.joints, scene.drives)
    functions = (function for _, function in (*time_functions(scene), *input_functions(scene)))
    in_functions = {p.symbol for function in functions for p in function_parameters(function)}
    return frozenset({*_symbols(geometry), *in_functions, *_read(model)})


def _without_stiffness(body: SceneBody) -> SceneBody:
    if not isinstance(body, BeamBody):
        return body
    beam = dataclasses.replace(body.beam, bending_stiffness=Fraction(1), damping=None)
    return dataclasses.replace(body, beam=beam, loads=())


def _symbols(value: Any) -> Iterator[str]:
    """The symbols of all parameters in a value."""
    if isinstance(value, Parameter):
        yield value.symbol
    for item in _parts(value):
        yield from _symbols(item)


def _parts(value: Any) -> tuple[Any, ...]:
    if isinstance(value, tuple):
        return value
    if isinstance(value, Mapping):
        return tuple(value.values())
    return tuple(vars(value).values()) if dataclasses.is_dataclass(value) else ()


def _read(model: Model) -> frozenset[str]:
    """The parameters that reach the functions of KERNELS through the constants of `setup`; all if that is not known."""
    setup, symbols = model.kernel("setup"), frozenset(parameter.name for parameter in model.parameters)
    kernels = [kernel for kernel in model.kernels if kernel.name in KERNELS]
    arrays = any(argument.arrays for kernel in (setup, *kernels) for argument in kernel.arguments)
    if arrays or any(_is_loop(s) for kernel in (setup, *kernels) for s in kernel.statements):
        return symbols
    known: dict[str, frozenset[str]] = {
        name: frozenset({parameter.name})
        for parameter, name in zip(model.parameters, setup.arguments[0].elements, strict=True)
    }
    constants: dict[int, frozenset[str]] = {}
    for statement in setup.statements:
        read = frozenset(symbol for name in reads(statement) for symbol in known.get(name, symbols))
        match statement:
            case Let(name=name):
                known[name] = read
            case Store(index=index):
                constants[index] = read
    result: set[str] = set()
    for kernel in kernels:
        for argument in kernel.arguments:
            if argument.name == "k":
                result.update(*(constants[i] for i, name in argument.named_elements if name in kernel.used))
    return frozenset(result)


def _is_loop(statement: Statement) -> bool:
    return not isinstance(statement, Let | Store | Require)


def with_defaults(value: T, defaults: Mapping[str, float]) -> T:
    """A specification, or a part of one, whose parameters have other defaults, by their symbols."""
    old: Any = value
    if isinstance(old, Parameter):
        default = defaults.get(old.symbol, old.default)
        return value if default == old.default else dataclasses.replace(old, default=default)  # type: ignore[return-value]
    if isinstance(old, tuple):
        items = tuple(with_defaults(item, defaults) for item in old)
        return value if _same(items, old) else items  # type: ignore[return-value]
    if isinstance(old, Mapping):
        values = [with_defaults(item, defaults) for item in old.values()]
        return value if _same(values, old.values()) else dict(zip(old, values, strict=True))  # type: ignore[return-value]
    if dataclasses.is_dataclass(old) and not isinstance(old, type):
        fields = {field.name: getattr(old, field.name) for field in dataclasses.fields(old)}
        others = {name: with_defaults(item, defaults) for name, item in fields.items()}
        changed = {name: item for name, item in others.items() if item is not fields[name]}
        return dataclasses.replace(old, **changed) if changed else value  # type: ignore[return-value]
    return value


def _same(first: Iterable[Any], second: Iterable[Any]) -> bool:
    return all(a is b for a, b in zip(first, second, strict=True))
