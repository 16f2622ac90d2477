"""The backend of C99, whose many modules are loaded when it writes a file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from derive.artifacts import File

if TYPE_CHECKING:
    from derive.ir.model import Model

ABI = 10


class CBackend:
    """C99 that is also valid C++: a header and a source file."""

    name = "c"

    def file_names(self, model: str) -> tuple[str, ...]:
        """The paths of the files of a model below the output folder: the header and the source file."""
        return f"{model}/{model}.h", f"{model}/{model}.c"

    def files(self, model: Model, fingerprint: str, batches: bool = True) -> tuple[File, ...]:
        """`NAME.h`, and `NAME.c` with its source map; `fingerprint` is that of the specification.

        batches: whether there are functions of batches, which a caller that compiles without them does not need.
        """
        from derive.backends.c.source_text import header_and_source

        header, source = self.file_names(model.name)
        return header_and_source(model, fingerprint, ABI, header, source, batches)
