"""The protocol of a backend: a language, or another form, in which the functions of a model are written."""

from __future__ import annotations

from typing import Protocol

from derive.artifacts import File
from derive.ir.model import Model


class Backend(Protocol):
    """A backend; one is added by an entry in `derive.backends.model_files.BACKENDS`.

    name: the key in the registry, and the language of the source maps.
    """

    @property
    def name(self) -> str:
        """The name of the backend."""

    def file_names(self, model: str) -> tuple[str, ...]:
        """The paths of the files of a model of that name, below the output folder."""

    def files(self, model: Model, fingerprint: str) -> tuple[File, ...]:
        """The files of a model, in the order of `file_names`.

        A file with functions of the model is a SourceFile, with the map of its lines. `fingerprint` is the SHA-256 of
        the specification, which files carry in their first lines.
        """
