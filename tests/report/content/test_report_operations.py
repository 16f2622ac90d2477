"""Operations on a page are those of the code, and fall from step to step."""

from __future__ import annotations

import pages
import pytest
import sympy as sp

from derive.report.sections.code import named, written_out


def steps(name: str) -> dict[str, int]:
    (table,) = (t for t in pages.tables(pages.section(name, "operations")) if t.caption == "Operations after each step")
    return {pages.plain(row[0].text): int(pages.plain(row[2].text)) for row in table.rows}


@pytest.mark.parametrize("name", ["point", "mean", "beam_point_8", "block", "flat"])
def test_each_step_saves_operations(name: str) -> None:
    found = steps(name)
    assert ("integrals named" in found) == (name not in ("block", "flat"))  # there they are numbers, or parameters
    counts = [count for step, count in found.items() if step != "setup"]
    assert counts == sorted(counts, reverse=True) and counts[0] > counts[-1]


@pytest.mark.parametrize("name", ["point", "loops", "block"])
def test_operations_are_those_of_the_kernels(name: str) -> None:
    model, found = pages.built(name).model, steps(name)
    assert found["generated code"] == model.kernel("mass_force").operations
    assert found["setup"] == model.kernel("setup").operations
    (table,) = (t for t in pages.tables(pages.section(name, "operations")) if t.caption == "Functions")
    functions = {pages.plain(row[0].text): int(pages.plain(row[2].text)) for row in table.rows}
    assert functions == {kernel.name: kernel.operations for kernel in model.kernels}


def test_what_is_written_out_is_counted() -> None:
    """In the mean frame M is diagonal: m, m, three products for J, m/5 and m/7; h has a row without a term twice."""
    equations = pages.built("mean").equations
    wanted = [equations.substituted(e) for e in (*(equations.mass[i, i] for i in range(5)), *equations.force)]
    assert written_out(equations) == sum(sp.count_ops(e) for e in wanted)
    assert written_out(equations) > written_out(equations, integrals=False) > named(equations) > 0
