"""Loading of models: the generated C is compiled into a shared library, which is kept in the cache, and opened."""

from __future__ import annotations

import ctypes
import json
import platform
import tempfile
from collections.abc import Sequence
from pathlib import Path

from derive import cache
from derive.artifacts import File, check_files, write
from derive.progress_line import sized_work
from derive.runtime.compiler import FLAGS, OWN_SYMBOLS, compile_shared, compiler_identity
from derive.runtime.native_scene import NativeScene


def load(files: Sequence[File], flags: Sequence[str] = FLAGS) -> NativeScene:
    """Compile the C of one model in a temporary folder and load it; the cache keeps compiled libraries.

    Arguments:
        files: those of `model_files`.
        flags: of the compiler, such as those of `vector_flags`.

    Returns:
        The compiled model; that of a body has no joints, inputs and outputs.

    Raises:
        CompilerError: if there is no compiler, or if it refuses the code.
        ValueError: if there is no C file among the files.
        TypeError: for anything but files.

    Examples:
        >>> import derive
        >>> beam = derive.planar_beam("beam")
        >>> native = derive.load(derive.model_files(derive.lower(derive.derive(beam)), beam))
        >>> k = native.setup(EI=30)
        >>> native.accel(0.0, [0, 0, 0.5, 0.01, 0], [0, 0, 3, 0, 0], k).round(2) + 0.0
        array([   0.  ,    0.  ,    0.  , -215.91,    0.  ])
    """
    check_files(files)
    with tempfile.TemporaryDirectory(prefix="tisserand-") as folder:
        write(files, Path(folder))
        sources = [Path(folder) / file.path for file in files if file.path.endswith(".c")]
        if not sources:
            raise ValueError("there is no C file among these files")
        return NativeScene(shared_library(sources, Path(folder), flags), sources[0].stem)


def shared_library(
    sources: Sequence[Path], folder: Path, flags: Sequence[str] = FLAGS, link: Sequence[str] = ()
) -> ctypes.CDLL:
    """Compile C files, which are below a folder with all that they include, and load the library; see `_compiled`."""
    return ctypes.CDLL(str(_compiled(sources, folder, flags, link)))


def library_data(sources: Sequence[Path], folder: Path, flags: Sequence[str] = FLAGS) -> bytes:
    """The library of C files as bytes, which `load_data` loads in another process on a machine of the same kind."""
    return _compiled(sources, folder, flags, ()).read_bytes()


def load_data(library: bytes) -> ctypes.CDLL:
    """Load a library that `library_data` returned. Raises OSError on a machine that it was not compiled for."""
    with tempfile.TemporaryDirectory(prefix="tisserand-") as folder:
        path = Path(folder) / "model.so"
        path.write_bytes(library)
        return ctypes.CDLL(str(path))


def model_library(files: Sequence[File], flags: Sequence[str] = FLAGS) -> tuple[str, bytes]:
    """The name and the library of the one model in these files, see `load`. Raises CompilerError."""
    with tempfile.TemporaryDirectory(prefix="tisserand-") as folder:
        write(files, Path(folder))
        (source,) = (Path(folder) / file.path for file in files if file.path.endswith(".c"))
        return source.stem, library_data([source], Path(folder), flags)


def _compiled(sources: Sequence[Path], folder: Path, flags: Sequence[str], link: Sequence[str]) -> Path:
    """Compile C files, which are below a folder with all that they include, and return the path of the library there.

    flags, link: of the compiler. A library that the cache keeps of the same files, flags and compiler is taken
    instead, unless it is one for this processor alone or links other libraries. Raises CompilerError.
    """
    library = folder / "model.so"
    name = None if link or any("native" in flag for flag in flags) else _key(sources, folder, flags)
    data = cache.read(name) if name else None
    if data is None:
        size = sum(path.stat().st_size for path in sources)
        with sized_work("compiling", " ".join(flag for flag in flags if str(folder) not in flag), size):
            compile_shared(sources, library, flags, link)
        if name:
            cache.write(name, library.read_bytes())
    else:
        library.write_bytes(data)
    return library


def _key(sources: Sequence[Path], folder: Path, flags: Sequence[str]) -> str:
    """The name of a library in the cache."""
    compiled = [str(path.relative_to(folder)) for path in sources]
    used = [flag.replace(str(folder), ".") for flag in (*flags, *OWN_SYMBOLS)]
    parts = [platform.machine(), compiler_identity(), json.dumps([used, compiled])]
    for path in sorted(folder.glob("**/*.[ch]")):
        parts += [str(path.relative_to(folder)), path.read_text(encoding="utf-8")]
    return cache.key("library", *parts)


def load_scene(files: Sequence[File], flags: Sequence[str] = FLAGS) -> NativeScene:
    """Compile and load a scene, as `load` does, and refuse a body alone.

    Arguments:
        files: those of `model_files`.
        flags: of the compiler, such as those of `vector_flags`.

    Raises:
        CompilerError: if there is no compiler, or if it refuses the code.
        ValueError: if there is no C file among the files, or if the model is that of a body.
        TypeError: for anything but files.

    Examples:
        >>> import derive
        >>> pendulum = derive.scene(
        ...     "pendulum",
        ...     gravity=(0, -9.81),
        ...     ground={"pivot": (0, 0)},
        ...     bodies={"rod": {"mass": 1, "inertia": "1/12", "markers": {"top": (0, 0.5)}}},
        ...     joints={"hinge": {"kind": "revolute", "between": ["ground.pivot", "rod.top"]}},
        ... )
        >>> native = derive.load_scene(derive.model_files(derive.lower(derive.derive(pendulum)), pendulum))
        >>> native.coordinates
        ('rod_phi',)
        >>> native.accel(0.0, [0.1], [0.0], native.setup()).round(4)
        array([-1.469])
    """
    native = load(files, flags)
    if not native.is_scene:
        raise ValueError(f"{native.name} is a body, not a scene")
    return native
