"""The model and the files of a specification, which are kept in the cache between runs."""

from __future__ import annotations

import hashlib
import io
import pickle
import platform
from collections.abc import Callable
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

from derive import cache as kept
from derive.artifacts import File
from derive.backends.model_files import BACKENDS, emit, explicit_files, fingerprint
from derive.garbage_collection import paused
from derive.ir.model import Model
from derive.mechanics.multibody.bodies.registry import BODIES
from derive.mechanics.multibody.forces.registry import FORCES
from derive.mechanics.multibody.joints.registry import JOINTS
from derive.mechanics.multibody.outputs.registry import MONITORS, OUTPUTS
from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS
from derive.mechanics.multibody.space.outputs import SPATIAL_OUTPUTS
from derive.mechanics.multibody.space.springs import SPATIAL_SPRINGS
from derive.rendering import templates_folder
from derive.spec.model.specification import AnyScene, Specification
from derive.version import VERSION

TRUSTED = (
    "derive.artifacts",
    "derive.backends.source_map",
    "derive.ir.expressions",
    "derive.ir.indices",
    "derive.ir.kernel",
    "derive.ir.model",
    "derive.ir.packing",
    "derive.ir.patterns",
    "derive.ir.statements",
    "derive.roles",
    "derive.spec.model.time_function",
    "fractions",
)
"""The modules whose classes a kept model consists of; no others are loaded."""

PACKAGES = ("sympy", "casadi", "numpy", "scipy", "jinja2")

OPEN = (JOINTS, BODIES, FORCES, OUTPUTS, MONITORS, SPATIAL_JOINTS, SPATIAL_SPRINGS, SPATIAL_OUTPUTS, BACKENDS)
"""The registries whose members from outside the package change models."""

Generated = tuple[Model, tuple[File, ...]]


def generated(spec: Specification) -> Generated:
    """The model of a specification, and its files. Raises SpecError as `derive` does.

    Both are kept in the cache, unless kinds of joints, bodies, forces or outputs are registered from outside, whose
    code may change.
    """
    return _kept("model", spec, lambda: _made(spec))


def generated_explicit(scene: AnyScene) -> Generated:
    """The model of a scene with the kernels that explicit integration calls, and its C, kept in the cache as well.

    It is complete if the scene starts in equilibrium, which is computed with the iteration matrix.
    """
    if scene.start is not None:
        return generated(scene)
    return _kept("explicit model", scene, lambda: _made(scene, explicit=True))


def _kept(kind: str, spec: Specification, made: Callable[[], Generated]) -> Generated:
    """The result of `made`, from the cache if it is there; otherwise it is kept there for `kind` and `spec`."""
    if any(registry.extended for registry in OPEN):
        return made()
    name = kept.key(kind, fingerprint(spec), package_hash(), *_versions())
    data = kept.read(name)
    if data is not None:
        try:
            with paused():  # the search would go through the many objects again and again while they are read
                result: Generated = _Reader(io.BytesIO(data)).load()
        except (pickle.UnpicklingError, AttributeError, EOFError, ImportError):  # it has been written by other means
            pass
        else:
            return result
    result = made()
    kept.write(name, pickle.dumps(result, pickle.HIGHEST_PROTOCOL))
    return result


def _made(spec: Specification, explicit: bool = False) -> Generated:
    from derive.derivation import derive, lower  # not needed for what is kept

    model = lower(derive(spec), explicit=explicit)
    return model, explicit_files(model, spec) if explicit else emit(model, spec)


@cache
def package_hash() -> str:
    """The SHA-256 of all source files and templates of this package."""
    digest = hashlib.sha256()
    for folder, pattern in ((Path(__file__).parent, "**/*.py"), (templates_folder(), "**/*")):
        for path in sorted(folder.glob(pattern)):
            if path.is_file():
                digest.update(f"{path.relative_to(folder)}\0".encode() + hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()


def _versions() -> tuple[str, ...]:
    return VERSION, platform.python_version(), *(f"{name} {version(name)}" for name in PACKAGES)


class _Reader(pickle.Unpickler):
    """An unpickler that reads classes of the trusted modules alone, so that a file cannot call anything else."""

    def find_class(self, module: str, name: str) -> Any:
        """The class of that name. Raises UnpicklingError for anything else."""
        result = super().find_class(module, name) if module in TRUSTED else None
        if not (isinstance(result, type) and result.__module__ == module):
            raise pickle.UnpicklingError(f"{module}.{name} is no part of a model")
        return result
