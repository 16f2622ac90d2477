"""`--to casadi`: an external function of CasADi with exact derivatives, in C on top of the generated C."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import casadi as ca

from derive.artifacts import MARK, File
from derive.backends.description import LICENCE
from derive.backends.wrapping import prefixed
from derive.export.c_parts import host_copy
from derive.export.casadi.graph import INPUTS, OUTPUTS, model_graph, sizes_of
from derive.export.host_model import HostModel
from derive.export.interface import Interface
from derive.rendering import render


@dataclass(frozen=True)
class Port:
    """An input or output of a function of CasADi, and the C name of its sparsity."""

    name: str
    sparsity: str


@dataclass(frozen=True)
class CasadiFunction:
    """A function that CasADi looks up by its name, with what goes in and out."""

    name: str
    inputs: tuple[Port, ...]
    outputs: tuple[Port, ...]


@dataclass(frozen=True)
class Table:
    """Numbers of a C array with its name, wrapped into lines."""

    name: str
    text: str
    size: int


def casadi_files(host: HostModel) -> tuple[File, ...]:
    """The C of a model that has derivatives with respect to parameters and inputs, and the external function."""
    name = host.name
    sizes = sizes_of(host)
    graph = model_graph(host)
    by_time = any(graph.jac_sparsity(i, 0).nnz() for i in range(len(OUTPUTS)))
    blocks = {(f, x): graph.jac_sparsity(i, j) for i, f in enumerate(OUTPUTS) for j, x in enumerate(INPUTS)}
    if by_time:
        blocks |= {(f, "t"): ca.Sparsity(sizes[f], 1) for f in OUTPUTS}
    initial = {"x": host.states, "u": host.inputs, "p": host.parameters}
    values = {
        "mark": MARK,
        "licence": LICENCE,
        "name": name,
        "macro": name.upper(),
        "title": host.model.doc,
        "sizes": {"u": sizes["u"], "out": sizes["y"]},
        "differentiable_time": not by_time,
        "sparsities": [
            *(_table(f"{name}_sparsity_of_{key}", (size, 1, 1)) for key, size in sizes.items()),
            *(_table(f"{name}_sparsity_of_{f}_by_{x}", _compressed(block)) for (f, x), block in blocks.items()),
        ],
        "functions": list(_functions(name)),
        "initial": [_table(key, [x.start or 0.0 for x in variables]) for key, variables in initial.items()],
    }
    return (
        File(f"{name}.h", host.header.text),
        File(f"{name}.c", host.source.text),
        File("manifest.json", host.manifest.text),
        File(f"{name}_casadi.c", render("export/casadi/external.c.jinja", values)),
        host_copy("", "ode.h"),
        host_copy("", "ode.c", f'#define TISSERAND_HEADER "{name}.h"\n'),
    )


def _compressed(block: ca.Sparsity) -> list[int]:
    """The compressed columns of a sparsity: rows, columns, first entries of the columns, rows of the entries."""
    return [block.size1(), block.size2(), *block.colind(), *block.row()]


def _functions(name: str) -> Iterator[CasadiFunction]:
    """The functions with the names, inputs and outputs that CasADi expects of `external`."""

    def ports(names: Iterable[str], prefix: str = "") -> tuple[Port, ...]:
        return tuple(Port(f"{prefix}{key}", f"{name}_sparsity_of_{key}") for key in names)

    inputs, outputs = ports(INPUTS), ports(OUTPUTS)
    nominal = *inputs, *ports(OUTPUTS, "out_")
    yield CasadiFunction(name, inputs, outputs)
    yield CasadiFunction(f"fwd1_{name}", (*nominal, *ports(INPUTS, "fwd_")), ports(OUTPUTS, "fwd_"))
    yield CasadiFunction(f"adj1_{name}", (*nominal, *ports(OUTPUTS, "adj_")), ports(INPUTS, "adj_"))
    blocks = tuple(Port(f"jac_{f}_{x}", f"{name}_sparsity_of_{f}_by_{x}") for f in OUTPUTS for x in INPUTS)
    yield CasadiFunction(f"jac_{name}", nominal, blocks)
    yield CasadiFunction(f"{name}_initial", (), ports(("x", "u", "p")))


def _table(name: str, numbers: Iterable[float]) -> Table:
    values = list(numbers)
    return Table(name, "\n".join(prefixed([", ".join(map(repr, values))], "    ")) if values else "", len(values))


CASADI = Interface(
    "CasADi and what is built on it: an external function with exact derivatives, for optimal control and estimation",
    casadi_files,
    "cc -O2 -shared -fPIC {folder}/{name}_casadi.c {folder}/{name}.c {folder}/ode.c -o {name}.so -lm, then "
    'casadi.external("{name}", "./{name}.so")',
    sensitivities=True,
)
