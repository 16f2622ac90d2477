"""The backend of Python, whose modules are loaded when it writes a file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from derive.artifacts import File

if TYPE_CHECKING:
    from derive.ir.model import Model


class PythonBackend:
    """A Python module that needs NumPy alone; arrays of any array-API namespace will do."""

    name = "python"

    def file_names(self, model: str) -> tuple[str, ...]:
        """The path of the module of a model below the output folder."""
        return (f"{model}/{model}.py",)

    def files(self, model: Model, fingerprint: str) -> tuple[File, ...]:
        """`NAME.py` with its source map; `fingerprint` is that of the specification."""
        from derive.backends.python.module import module

        (path,) = self.file_names(model.name)
        return (module(model, fingerprint, path),)
