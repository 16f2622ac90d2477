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
from derive.export.urdf.description import URDF
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
        "urdf": URDF,
    },
)


def exported(spec: Specification, kind: str) -> tuple[HostFile, ...]:
    """The files with which the hosts of an interface use the model of a specification.

    Arguments:
        spec: a scene, a beam or a finite-element body.
        kind: the interface, a name in `derive.export.registry.INTERFACES`, such as "cmake", "fmu3" or "casadi".

    Returns:
        The files, which `derive.write` writes.

    Raises:
        UnknownNameError: for an interface that is not registered.
        SpecError: if the specification is not valid, or if the interface has no form for it.
        SimulationError: where there is no initial state.
        CompilerError: if the interface needs a compiler and there is none.

    Examples:
        >>> import derive
        >>> ball = derive.scene("ball", bodies={"ball": {"mass": 1, "inertia": 1}})
        >>> files = derive.exported(ball, "cmake")
        >>> "ball-cmake/CMakeLists.txt" in [file.path for file in files]
        True
        >>> derive.write(files, ".")
    """
    interface = INTERFACES[kind]
    return exported_files(host_model(spec, interface.sensitivities), kind, interface)
