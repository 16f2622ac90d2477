"""`--to fmu2`, `--to fmu3`: functional mock-up units, with their sources and binaries for this or for all platforms."""

from __future__ import annotations

import hashlib
import io
import zipfile
from collections.abc import Mapping, Sequence
from functools import partial

from derive.artifacts import MARK, BinaryFile
from derive.backends.description import LICENCE
from derive.errors import Problem, SpecError
from derive.export.fmi.binaries import PLATFORMS, Platform, compiled, this_platform
from derive.export.fmi.description import default_experiment, descriptions
from derive.export.fmi.variables import nominals
from derive.export.host_model import HostModel
from derive.export.interface import RECORD, HostFile, Interface
from derive.rendering import render
from derive.simulation.simulated_scene import surroundings
from derive.spec.model.scene_functions import breaks
from derive.version import VERSION

HOSTS = ("ode", "adaptive", "dormand_prince", "fixed_step")
"""The parts of `templates/host` with which units take derivatives, and integrate in co-simulation."""

PARTS = ("instance", "variables", "exchange", "step", "derivatives", "stored")
"""The parts of `templates/export/fmi` that both versions of FMI have, each with a header."""

FUNCTIONS = {2: ("fmi2.h", "fmi2.c"), 3: ("fmi3.h", "component3.h", "fmi3.c", "fmi3_absent.c")}
"""The files with the functions of a version."""


def fmu(model: HostModel, version: int, platforms: Sequence[Platform]) -> bytes:
    """The archive of a unit of FMI 2.0 (version 2) or 3.0 (3), with a binary for each platform.

    Equal inputs give equal bytes, but for binaries of different compilers. Raises CompilerError, and SpecError where a
    name of the specification cannot be one of the unit.
    """
    sources = _sources(model, version)
    token = _token(sources)
    sources["model.c"] = _start(model, token)
    content = {path: text.encode() for path, text in descriptions(model, version, token, [*sources])}
    content |= {f"sources/{name}": text.encode() for name, text in sources.items()}
    for platform in platforms:
        name = f"binaries/{platform.folder(version)}/{model.name}.{platform.ending}"
        content[name] = compiled(model.name, sources, platform)
    return _archive(content)


def _archive(content: Mapping[str, bytes]) -> bytes:
    """A zip archive, with one time for all files."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for path, data in content.items():
            entry = zipfile.ZipInfo(path, (1980, 1, 1, 0, 0, 0))
            entry.compress_type, entry.create_system, entry.external_attr = zipfile.ZIP_DEFLATED, 3, 0o644 << 16
            archive.writestr(entry, data)
    return buffer.getvalue()


def _sources(model: HostModel, version: int) -> dict[str, str]:
    """The C of a unit by file names, with a model.c that has no token yet."""
    copies = [("host", f"{part}{ending}") for part in HOSTS for ending in (".h", ".c")]
    copies += [("export/fmi", f"{part}{ending}") for part in PARTS for ending in (".h", ".c")]
    copies += [("export/fmi", file) for file in FUNCTIONS[version]]
    every = {f"{model.name}.h": model.header.text, f"{model.name}.c": model.source.text}
    for folder, name in copies:
        values = {"mark": MARK, "origin": f"templates/{folder}/{name}", "name": model.name}
        every[name] = render("export/fmi/copy.c.jinja", values) + render(f"{folder}/{name}", {})
    every["model.c"] = _start(model, "")
    if len(every) != 3 + len(copies):
        taken = f'"{model.name}" is the name of a source file of every unit; choose another name'
        raise SpecError((Problem("name", taken),), None)
    return every


def _token(sources: Mapping[str, str]) -> str:
    """The hash of sources in the form of a GUID."""
    digest = hashlib.sha256(VERSION.encode())
    for name, text in sources.items():
        digest.update(f"{name}\0{text}\0".encode())
    x = digest.hexdigest()
    return f"{{{x[:8]}-{x[8:12]}-{x[12:16]}-{x[16:20]}-{x[20:32]}}}"


def _start(model: HostModel, token: str) -> str:
    """The text of model.c."""
    values = {
        "mark": MARK,
        "licence": LICENCE,
        "name": model.name,
        "token": token,
        "tolerance": default_experiment(model).tolerance,
        "inputs": model.inputs,
        "started": (*model.inputs, *model.states),
        "sizes": nominals(model),
        "breaks": breaks(surroundings(model.spec)),
        "number": repr,
    }
    return render("export/fmi/model.c.jinja", values)


def _files(version: int, everywhere: bool, model: HostModel) -> tuple[HostFile, ...]:
    platforms = [*PLATFORMS.values()] if everywhere else [this_platform()]
    return (BinaryFile(f"{model.name}.fmu", fmu(model, version, platforms), record=RECORD),)


def _interface(version: int, everywhere: bool = False) -> Interface:
    doc = f"programs that take functional mock-up units of FMI {version}.0, for model exchange and co-simulation"
    where = ", with binaries for Linux, Windows and macOS" if everywhere else ""
    files = partial(_files, version, everywhere)
    return Interface(doc + where, files, "fmpy validate {folder}/{name}.fmu", sensitivities=True)


FMU2, FMU3 = _interface(2), _interface(3)
FMU2_ALL, FMU3_ALL = _interface(2, everywhere=True), _interface(3, everywhere=True)
