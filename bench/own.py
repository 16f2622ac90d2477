"""A model of ours for the benchmark of scale: its C, with each function in a file of its own.

python bench/own.py DATA SIZE LOWERING FOLDER

So compilers are measured by the function. Prints what it took, all functions together, as JSON.
"""

from __future__ import annotations

import json
import re
import sys
import time
from pathlib import Path

import numpy as np
from bodies import BODIES

import derive
from derive.backends.c.source import CBackend
from derive.ir.model import Model

SEPARATE = ("setup", "mass", "force", "jacobian", "mass_force", "accel")


def model(data: str, size: int, lowering: str, name: str) -> tuple[Model, np.ndarray]:
    """The model and its p: integrals are parameters where they are dense, else numbers of the model."""
    body = BODIES[data](size)
    if data == "beam":
        made = derive.lower(derive.derive_modal(body, None, lowering))
        return made, np.array(made.defaults)
    spec = derive.symbolic_body(name, size, frame="given", lowering=lowering)
    return derive.lower(derive.derive(spec)), derive.parameters(body, spec)


def function(source: str, name: str) -> str:
    """The text of one function of a C file."""
    found = re.search(rf"^int {name}\(.*?^}}\n", source, re.MULTILINE | re.DOTALL)
    assert found, name
    return found.group()


def main(argv: list[str]) -> None:
    data, size, lowering, folder = argv[0], int(argv[1]), argv[2], Path(argv[3])
    start = time.perf_counter()
    made, p = model(data, size, lowering, f"{data}_{size}_{lowering}")
    header, source = CBackend().files(made, "a benchmark")
    seconds = time.perf_counter() - start
    prefix = f"own_{lowering}_"
    head = source.text[: source.text.index(f"int {made.name}_setup(")]
    shared = header.text + head.replace(f'#include "{made.name}.h"', "")
    for name in SEPARATE:
        text = shared + function(source.text, f"{made.name}_{name}")
        (folder / f"{prefix}{name}.c").write_text(text.replace(f"{made.name}_", prefix))
    p.tofile(folder / f"{prefix}p.bin")
    told: dict[str, object] = {"seconds": seconds, "np": len(p), "nk": sum(v.size for v in made.constants)}
    for name in SEPARATE:
        kernel = made.kernel(name)
        own = len(function(source.text, f"{made.name}_{name}"))
        told[name] = {"operations": kernel.operations, "bytes": own, "size": [o.size for o in kernel.outputs]}
    for item, output in (("mass", "M"), ("jacobian", "jac")):
        shape = made.pattern(item, output)
        row, col = zip(*shape.entries, strict=True)
        np.savez(folder / f"{prefix}{item}.npz", row=row, col=col)
    print(json.dumps(told))


if __name__ == "__main__":
    main(sys.argv[1:])
