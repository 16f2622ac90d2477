"""The C of a chain of beams: straight line, in loops over its instances, or that of CasADi for its accelerations.

python bench/chain_model.py COUNT FORM FOLDER

The chain is that of examples/chain_100.toml with COUNT beams. CasADi gets our M, h, G and gamma and our elimination
order, and its own LDL^T, `cse` and C. Prints the CPU seconds of each stage and the sizes as JSON.
"""

from __future__ import annotations

import json
import sys
import time
from itertools import pairwise
from pathlib import Path

import casadi as ca
from chain_scene import chain

import derive
from derive.backends.c.source import CBackend
from derive.ir.expressions import Number
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.context import Context
from derive.lowering.flat.kkt_matrix import jacobian_entries, kkt, kkt_pattern
from derive.lowering.flat.lower import lower
from derive.lowering.instances.lower import lower_instances
from derive.mechanics.equations import Equations
from derive.mechanics.multibody.mechanism import Mechanism


def casadi_accelerations(equations: Equations) -> ca.Function:
    """The accelerations (nv,) as a function of q and v; numbers are constants of CasADi."""
    context = Context(equations)
    symbols = context.symbols(context.q, context.v)
    n, pattern = len(context.rows), kkt_pattern(context)
    matrix = ca.SX(pattern.rows, pattern.cols)
    for i, j in context.mass_pattern().entries:
        matrix[i, j] = matrix[j, i] = symbols(equations.mass[i, j])
    for (i, j), value in jacobian_entries(context, symbols).items():
        matrix[n + i, j] = matrix[j, n + i] = -value
    right = ca.vertcat(*(-symbols(h) for h in equations.force), *(symbols(c.bias) for c in equations.constraints))
    order = list(kkt(context).order)
    solution = ca.ldl_solve(right[order], *ca.ldl(matrix[order, order], False))
    vdot = ca.vertcat(*(solution[order.index(i)] for i in range(n)))
    return numeric_function(equations.name, context, symbols, vdot)


def numeric_function(name: str, context: Context, symbols: Symbols, values: ca.SX) -> ca.Function:
    """Values as a function of q and v; the numbers of the equations are constants of CasADi."""
    every = zip(symbols.inputs, symbols.leaves, strict=True)
    numbers = [(symbol, float(leaf.value)) for symbol, leaf in every if isinstance(leaf, Number)]
    known = ca.vertcat(*(s for s, _ in numbers)), ca.DM([value for _, value in numbers])
    state = [ca.vertcat(*symbols.values_of(argument.symbols)) for argument in (context.q, context.v)]
    return ca.Function(name, state, [ca.densify(ca.substitute(values, *known))], {"cse": True})


def files(mechanism: Mechanism, form: str, clock: dict[str, float]) -> tuple[str, str, int]:
    """The texts of the C file and of its header, and the number of constants k; the stages enter into `clock`."""
    if form == "casadi":
        function = casadi_accelerations(mechanism.expanded())
        clock["lower"] = time.process_time()
        generator = ca.CodeGenerator(f"{function.name()}.c", {"with_header": False})
        generator.add(function)
        return generator.dump(), "", 0
    model = lower(mechanism.expanded()) if form == "flat" else lower_instances(mechanism)
    clock["lower"] = time.process_time()
    header, source = CBackend().files(model, "a benchmark")
    return source.text, header.text, sum(constant.size for constant in model.constants)


def main(argv: list[str]) -> None:
    count, form, folder = int(argv[0]), argv[1], Path(argv[2])
    name = f"chain_{form}"  # no number, which the text would have some hundred times
    clock = {"": time.process_time()}
    scene = chain(count, name)
    clock["read"] = time.process_time()
    mechanism = derive.derive(scene)
    assert isinstance(mechanism, Mechanism)
    clock["derive"] = time.process_time()
    source, header, constants = files(mechanism, form, clock)
    clock["emit"] = time.process_time()
    (folder / f"{name}.c").write_text(source)
    (folder / f"{name}.h").write_text(header)
    stages = list(clock)
    seconds = {stage: clock[stage] - clock[before] for before, stage in pairwise(stages)}
    print(json.dumps({"name": name, "seconds": seconds, "header": len(header.encode()), "constants": constants}))


if __name__ == "__main__":
    main(sys.argv[1:])
