"""The external function of a model in this process: compiled, and loaded into CasADi."""

from __future__ import annotations

import tempfile
from pathlib import Path

import casadi as ca

from derive.artifacts import write
from derive.export.casadi.external import casadi_files
from derive.export.host_model import HostModel
from derive.runtime.compiler import FLAGS, WITHOUT_BATCHES
from derive.runtime.loading import library_data


def casadi_function(host: HostModel) -> ca.Function:
    """The function (t, x, u, p) -> (xdot, y) of a model with exact derivatives, as from `tisserand export --to casadi`.

    host: `host_model(spec, sensitivities=True)`, which has the names, units and start values of x = [q; v], u, p and y.
    The library is that of the cache, where it has been compiled before. Raises CompilerError.
    """
    with tempfile.TemporaryDirectory(prefix="tisserand-") as name:
        folder = Path(name)
        files = casadi_files(host)
        write(files, folder)
        sources = [folder / file.path for file in files if file.path.endswith(".c")]
        library = folder / f"{host.name}_casadi.so"
        library.write_bytes(library_data(sources, folder, (*FLAGS, WITHOUT_BATCHES)))
        return ca.external(host.name, str(library))
