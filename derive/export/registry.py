"""The registry of interfaces: one line for each; those are what `tisserand export --to` takes."""

from __future__ import annotations

from derive.export.casadi.acados import ACADOS
from derive.export.casadi.external import CASADI
from derive.export.cmake import CMAKE
from derive.export.exudyn.body import EXUDYN
from derive.export.exudyn.floating_frame import EXUDYN_FFRF
from derive.export.fmi.fmu import FMU2, FMU2_ALL, FMU3, FMU3_ALL
from derive.export.fortran import FORTRAN
from derive.export.host_model import host_model
from derive.export.interface import HostFile, Interface, exported_files
from derive.export.jax import JAX
from derive.export.octave import OCTAVE
from derive.export.petsc import PETSC
from derive.export.rust import RUST
from derive.export.sundials import SUNDIALS
from derive.registry import Registry
from derive.spec.model.specification import Specification

INTERFACES: Registry[Interface] = Registry(
    "interface",
    {
        "cmake": CMAKE,
        "fortran": FORTRAN,
        "rust": RUST,
        "octave": OCTAVE,
        "fmu2": FMU2,
        "fmu3": FMU3,
        "fmu2-all": FMU2_ALL,
        "fmu3-all": FMU3_ALL,
        "casadi": CASADI,
        "acados": ACADOS,
        "jax": JAX,
        "sundials": SUNDIALS,
        "exudyn": EXUDYN,
        "exudyn-ffrf": EXUDYN_FFRF,
        "petsc": PETSC,
    },
)


def exported(spec: Specification, kind: str) -> tuple[HostFile, ...]:
    """The files with which the hosts of an interface use the model of a specification.

    kind: a name in `INTERFACES`. `derive.write` writes the files. Raises UnknownNameError, SpecError, SimulationError.
    """
    interface = INTERFACES[kind]
    return exported_files(host_model(spec, interface.sensitivities), kind, interface)
