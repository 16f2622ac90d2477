"""Loading of models: the generated C is compiled into a shared library, and a library is opened."""

from __future__ import annotations

import ctypes
import tempfile
from collections.abc import Sequence
from pathlib import Path

from derive.artifacts import File, write
from derive.runtime.compiled_model import Native
from derive.runtime.compiler import FLAGS, compile_shared
from derive.runtime.native_body import NativeBody
from derive.runtime.native_scene import NativeScene


def load(files: Sequence[File], flags: Sequence[str] = FLAGS) -> NativeScene | NativeBody:
    """Compile the C of one model in a temporary folder and load it.

    files: those of `model_files`. flags: of the compiler. Returns a NativeScene for a scene, else a NativeBody. Raises
    CompilerError, and ValueError if there is no C file.
    """
    with tempfile.TemporaryDirectory(prefix="tisserand-") as folder:
        write(files, Path(folder))
        sources = [Path(folder) / file.path for file in files if file.path.endswith(".c")]
        if not sources:
            raise ValueError("there is no C file among these files")
        library = ctypes.CDLL(str(compile_shared(sources, Path(folder) / "model.so", flags)))
        return native_model(library, sources[0].stem)


def native_model(library: ctypes.CDLL, name: str) -> NativeScene | NativeBody:
    """The model of that name in a library that is loaded: a NativeScene or a NativeBody, as its descriptor says."""
    is_scene = Native(library, name).is_scene
    return NativeScene(library, name) if is_scene else NativeBody(library, name)


def load_scene(files: Sequence[File], flags: Sequence[str] = FLAGS) -> NativeScene:
    """Compile and load a scene, as `load` does. Raises ValueError if the model is that of a body."""
    native = load(files, flags)
    if not isinstance(native, NativeScene):
        raise ValueError(f"{native.name} is a body, not a scene")
    return native
