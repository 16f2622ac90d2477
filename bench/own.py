"""The generated C of a model for the benchmark of scale, with each function in a separate file.

python bench/own.py DATA SIZE LOWERING FOLDER

Compilers can thus be measured for each function. Prints the seconds of all functions together, the sizes of p and k,
and the operations, bytes and output sizes of each function as JSON.
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
    """A model and its parameters p. The integrals of a dense body are parameters, those of a beam are numbers."""
    body = BODIES[data](size)
    if data == "beam":
        lowered = derive.lower(derive.derive_modal(body, None, lowering))
        return lowered, np.array(lowered.defaults)
    spec = derive.symbolic_body(name, size, frame="given", lowering=lowering)
    return derive.lower(derive.derive(spec)), derive.parameters(body, spec)


def function(source: str, name: str) -> str:
    """The text of a function in the text of a C file, with the static functions of its parts if it has any."""
    match = re.search(rf"^int {name}\(.*?^}}\n", source, re.MULTILINE | re.DOTALL)
    assert match, name
    part = source.find(f" {name}_part_1(")
    first = match.start() if part < 0 else source.rindex("\n\n", 0, part)
    return source[first : match.end()]


def main(argv: list[str]) -> None:
    data, size, lowering, folder = argv[0], int(argv[1]), argv[2], Path(argv[3])
    start = time.perf_counter()
    generated, p = model(data, size, lowering, f"{data}_{size}_{lowering}")
    header, source = CBackend().files(generated, "a benchmark")
    seconds = time.perf_counter() - start
    prefix = f"own_{lowering}_"
    head = source.text[: source.text.index(function(source.text, f"{generated.name}_setup"))]
    shared = header.text + head.replace(f'#include "{generated.name}.h"', "")
    for name in SEPARATE:
        text = shared + function(source.text, f"{generated.name}_{name}")
        (folder / f"{prefix}{name}.c").write_text(text.replace(f"{generated.name}_", prefix))
    p.tofile(folder / f"{prefix}p.bin")
    figures: dict[str, object] = {"seconds": seconds, "np": len(p), "nk": sum(v.size for v in generated.constants)}
    for name in SEPARATE:
        kernel = generated.kernel(name)
        length = len(function(source.text, f"{generated.name}_{name}"))
        figures[name] = {"operations": kernel.operations, "bytes": length, "size": [o.size for o in kernel.outputs]}
    for item, output in (("mass", "M"), ("jacobian", "jac")):
        shape = generated.pattern(item, output)
        row, col = zip(*shape.entries, strict=True)
        np.savez(folder / f"{prefix}{item}.npz", row=row, col=col)
    print(json.dumps(figures))


if __name__ == "__main__":
    main(sys.argv[1:])
