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

    The library is that of the cache, where it has been compiled before.

    Arguments:
        host: `host_model(spec, sensitivities=True)`, which has the names and start values of x = [q; v], u, p and y.

    Raises:
        CompilerError: if there is no compiler.
        TypeError: for anything but a host model.

    Examples:
        >>> import derive
        >>> ball = derive.scene("ball", gravity=(0, -10), bodies={"ball": {"mass": 1, "inertia": 1}})
        >>> function = derive.casadi_function(derive.host_model(ball, sensitivities=True))
        >>> xdot, y = function(0, [0, 0, 0, 3, 4, 0], [], [])
        >>> xdot.full().ravel()
        array([  3.,   4.,   0.,   0., -10.,   0.])
    """
    if not isinstance(host, HostModel):
        raise TypeError(f"derive.host_model(spec, sensitivities=True) is needed, not {type(host).__name__}")
    with tempfile.TemporaryDirectory(prefix="tisserand-") as name:
        folder = Path(name)
        files = casadi_files(host)
        write(files, folder)
        sources = [folder / file.path for file in files if file.path.endswith(".c")]
        library = folder / f"{host.name}_casadi.so"
        library.write_bytes(library_data(sources, folder, (*FLAGS, WITHOUT_BATCHES)))
        return ca.external(host.name, str(library))
