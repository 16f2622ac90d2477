"""Parts in C that interfaces share: the integrator as one function, the data of sample programs, numbers and files."""

from __future__ import annotations

from collections.abc import Iterable

from derive.artifacts import MARK, File
from derive.backends.c.source import ABI
from derive.backends.description import LICENCE
from derive.backends.wrapping import prefixed
from derive.export.host_model import HostModel
from derive.export.reference_motion import reference_motion
from derive.rendering import render

INTEGRATOR = ("adaptive_rows", "adaptive", "dormand_prince", "fixed_step")
"""The parts of `templates/host` with which exports integrate."""


def integrator_files(folder: str, model: str = "") -> list[File]:
    """The C files of the integrator and their headers, with our mark, in a folder.

    model: the name of the model that they are for, needed unless the compiler gets its header by -DTISSERAND_HEADER.
    """
    header = f'#define TISSERAND_HEADER "{model}.h"\n' if model else ""
    return [
        host_copy(folder, f"{part}{ending}", header if ending == ".c" else "")
        for part in INTEGRATOR
        for ending in (".c", ".h")
    ]


def host_copy(folder: str, name: str, head: str = "") -> File:
    """A file of `templates/host` in a folder, with our mark and further lines at its head."""
    text = render(f"host/{name}", {})
    return File(f"{folder}{name}", f"/* {MARK}: a copy of templates/host/{name}. */\n{head}{text}")


def sample_values(model: HostModel) -> dict[str, object]:
    """The values in the templates of projects with sample programs in C: names, start values, reference motion.

    event: the velocity whose change of sign the samples report. Raises what `reference_motion` raises.
    """
    motion = reference_motion(model)
    return {
        "mark": MARK,
        "licence": LICENCE,
        "name": model.name,
        "macro": model.name.upper(),
        "abi": ABI,
        "scene": model.is_scene,
        "coordinates": model.coordinates,
        "velocities": model.velocities,
        "states": model.states,
        "inputs": list(zip(model.inputs, model.constant_inputs, strict=True)),
        "parameters": model.parameters,
        "multipliers": model.multipliers,
        "proximal": model.model.proximal,
        "event": len(model.velocities) - 1,
        "times": motion.times,
        "times_text": c_numbers(motion.times.tolist()),
        "states_text": c_numbers(motion.states.ravel().tolist()),
        "tolerances_text": c_numbers(motion.tolerances.tolist()),
        "number": repr,
    }


def motion_file(model: HostModel, folder: str) -> File:
    """NAME_motion.c: the motion of a model at given times as one function, for languages that call C."""
    values = {"mark": MARK, "licence": LICENCE, "name": model.name, "macro": model.name.upper()}
    values["nu"] = str(len(model.inputs))
    return File(f"{folder}{model.name}_motion.c", render("export/motion.c.jinja", values))


def c_numbers(values: Iterable[float | None]) -> str:
    """Numbers as the elements of an array of C, on lines."""
    return "\n".join(prefixed([", ".join(map(repr, values))], "        "))
