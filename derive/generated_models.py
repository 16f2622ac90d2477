"""The model and the files of a specification, which are kept in the cache between runs."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

from derive.artifacts import File
from derive.backends.model_files import BACKENDS, emit, explicit_files, fingerprint
from derive.ir.model import Model
from derive.kept_objects import kept_object
from derive.mechanics.multibody.bodies.registry import BODIES
from derive.mechanics.multibody.forces.registry import FORCES
from derive.mechanics.multibody.joints.registry import JOINTS
from derive.mechanics.multibody.outputs.registry import MONITORS, OUTPUTS
from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS
from derive.mechanics.multibody.space.outputs import SPATIAL_OUTPUTS
from derive.mechanics.multibody.space.springs import SPATIAL_SPRINGS
from derive.spec.model.specification import AnyScene, Specification

OPEN = (JOINTS, BODIES, FORCES, OUTPUTS, MONITORS, SPATIAL_JOINTS, SPATIAL_SPRINGS, SPATIAL_OUTPUTS, BACKENDS)
"""The registries whose members from outside the package change models."""

Generated = tuple[Model, tuple[File, ...]]


MODULES = ("sympy", "casadi", "jinja2", "derive.derivation", "derive.model_lowering", "derive.backends.c.source_text")
"""The modules that derive a model and write its C, with all that they load. A kept model needs none of them."""


def load_derivation() -> None:
    """Load `MODULES`, which takes a second, so that processes that are forked afterwards have them."""
    for name in MODULES:
        import_module(name)


def generated(spec: Specification) -> Generated:
    """The model of a specification, and its files. Raises SpecError as `derive` does.

    Both are kept in the cache, unless kinds of joints, bodies, forces or outputs are registered from outside, whose
    code may change.
    """
    return _kept("model", spec, lambda: _made(spec))


def generated_explicit(scene: AnyScene) -> Generated:
    """The model of a scene with the kernels that explicit integration calls, and its C, kept in the cache as well.

    It has the iteration matrix as well if the scene starts in equilibrium or in steady motion.
    """
    return _kept("explicit model", scene, lambda: _made(scene, explicit=True))


def _kept(kind: str, spec: Specification, made: Callable[[], Generated]) -> Generated:
    """The result of `made`, which is kept for `kind` and `spec` unless a registry has members from outside."""
    return made() if any(registry.extended for registry in OPEN) else kept_object(kind, fingerprint(spec), made)


def _made(spec: Specification, explicit: bool = False) -> Generated:
    from derive.derivation import derive
    from derive.model_lowering import lower

    model = lower(derive(spec), explicit=explicit)
    return model, explicit_files(model, spec) if explicit else emit(model, spec)
