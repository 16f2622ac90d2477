"""The functions of time of a scene, their parameters, and the times at which they jump."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import fields, replace
from typing import Any, TypeVar

from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.quantity import Parameter
from derive.spec.model.spatial_beam import SpatialBeam
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.specification import AnyScene
from derive.spec.model.time_function import Spline, TimeFunction, break_times, parts

S = TypeVar("S", bound=AnyScene)

SECTIONS = ("joints", "drives", "forces", "torques", "springs")
"""The tables of a scene whose elements may have functions of time."""

LOADED = (BeamBody, FlexibleBody, SpatialBeam)
"""The bodies that may have loads of their own."""

FunctionPath = tuple[str, str, str]
"""The section, the element and the key of a function."""


def time_functions(scene: AnyScene) -> Iterator[tuple[FunctionPath, TimeFunction]]:
    """The functions of time in the equations of a scene, with their section, element and key."""
    for body in scene.bodies:
        for load in body.loads if isinstance(body, LOADED) else ():
            yield ("bodies", body.name, f"loads.{load.name}.time"), load.time
    for section in SECTIONS:
        for element in getattr(scene, section):
            for key, value in {**vars(element), **getattr(element, "values", {})}.items():
                for part in value if isinstance(value, tuple) else (value,):
                    if isinstance(part, TimeFunction):
                        yield (section, element.name, key), part


def with_changed_functions(scene: S, change: Callable[[TimeFunction], TimeFunction]) -> S:
    """A scene whose functions of time in its equations are replaced by the results of `change`."""

    def changed(value: Any) -> Any:
        if isinstance(value, TimeFunction):
            return change(value)
        if isinstance(value, tuple):
            return tuple(map(changed, value))
        return {key: changed(item) for key, item in value.items()} if isinstance(value, Mapping) else value

    def element(of: Any) -> Any:
        return replace(of, **{field.name: changed(getattr(of, field.name)) for field in fields(of)})

    def body(of: Any) -> Any:
        loaded = isinstance(of, LOADED)
        return replace(of, loads=tuple(map(element, of.loads))) if loaded else of

    bodies = map(body, scene.bodies)
    sections: dict[str, Any] = {section: tuple(map(element, getattr(scene, section))) for section in SECTIONS}
    of_scene: Any = scene
    result: S = replace(of_scene, bodies=tuple(bodies), **sections)
    return result


def input_functions(scene: AnyScene) -> Iterator[tuple[FunctionPath, TimeFunction]]:
    """The functions that define run-time inputs in simulations; the generated code does not contain them."""
    for given in scene.inputs:
        if given.function is not None:
            yield ("inputs", given.name, "value"), given.function


def function_parameters(function: TimeFunction) -> Iterator[Parameter]:
    """The parameters of the scene that occur in a function."""
    for part in parts(function):
        if part.parameter is not None:
            yield part.parameter


def splines(functions: Iterable[TimeFunction]) -> tuple[Spline, ...]:
    """The tables that functions read, each once."""
    every = (part.spline for function in functions for part in parts(function))
    return tuple(dict.fromkeys(spline for spline in every if spline is not None))


def breaks(scene: AnyScene, parameters: Mapping[str, float] | None = None) -> tuple[float, ...]:
    """The times (s) at which functions of the scene, or one of their first three derivatives, jump, in order.

    An integrator with steps of high order stops at them and starts anew. `parameters` are those, by symbol, that are
    not at their defaults. See `break_times`, which also finds kinks within the duration of the simulation of the scene.
    """
    end = 0.0 if scene.simulation is None else scene.simulation.duration
    times = (
        time
        for _, function in (*time_functions(scene), *input_functions(scene))
        for time in break_times(function, end, parameters)
    )
    return tuple(sorted({*times}))
