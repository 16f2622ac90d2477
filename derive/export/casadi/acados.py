"""`--to acados`: a Python file that makes an AcadosModel of CasADi's symbols."""

from __future__ import annotations

from derive.artifacts import MARK, File
from derive.backends.description import LICENCE
from derive.backends.python.constants import spline_functions
from derive.backends.python.module import Failure
from derive.export.host_model import HostModel
from derive.export.interface import Interface
from derive.export.straight_line import straight_line_functions
from derive.rendering import render


def acados_files(host: HostModel) -> tuple[File, ...]:
    """The file of a model. Raises SpecError for a model with loops."""
    model = host.model
    residual = "residual_index1" if model.is_scene else "residual"
    used = ("setup", "rates", "solve" if model.is_scene else "accel", "outputs", residual)
    values = {
        "mark": f"# {MARK}. Do not edit.\n# {LICENCE}",
        "model": model,
        "host": host,
        "nq": len(host.coordinates),
        "residual": residual,
        "splines": spline_functions(model),
        "functions": straight_line_functions(model, Failure.IGNORED, used),
    }
    text = render("export/acados/model.py.jinja", values)
    return File(f"{host.name}_acados.py", text), File("manifest.json", host.manifest.text)


ACADOS = Interface(
    "acados: a Python file with an AcadosModel, in explicit and in implicit form",
    acados_files,
    "import acados_model from {name}_acados in Python with {folder} in the path",
)
