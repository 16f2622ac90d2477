"""Operations and non-zeros are asserted, so that no optimisation can rot."""

from __future__ import annotations

import pytest

import beams
from derive.ir.expressions import Operation, ScalarRef, walk
from derive.ir.kernel import Kernel

STRUCTURE = {
    ("point", 2): 15,
    ("point", 4): 27,
    ("point", 6): 43,
    ("point", 8): 63,
    ("mean", 2): 5,
    ("mean", 4): 7,
    ("mean", 6): 9,
    ("mean", 8): 11,
}
"""Structural non-zeros of the full mass matrix, PHYSICS section 1."""

LIMITS = {
    ("point", 2): 52,
    ("mean", 2): 29,
    ("point", 4): 95,
    ("mean", 4): 59,
    ("point", 6): 162,
    ("mean", 6): 97,
    ("point", 8): 248,
    ("mean", 8): 143,
}
"""Operations of M and h after elimination of common sub-expressions, parameter-only work included."""

OPERATIONS = {
    ("point", 2): 37,
    ("mean", 2): 18,
    ("point", 4): 75,
    ("mean", 4): 42,
    ("point", 6): 129,
    ("mean", 6): 74,
    ("point", 8): 199,
    ("mean", 8): 114,
}
"""Operations of M and h after setup, as they are today; a smaller number is progress and is written here."""

ACCELERATIONS = {
    ("point", 2): 41,
    ("mean", 2): 19,
    ("point", 4): 85,
    ("mean", 4): 43,
    ("point", 6): 145,
    ("mean", 6): 75,
    ("point", 8): 221,
    ("mean", 8): 115,
}
"""Operations of the accelerations, their checks included, as they are today; a smaller number is progress."""


@pytest.mark.parametrize(("frame", "n"), STRUCTURE)
def test_nonzeros_of_the_mass_matrix(frame: str, n: int) -> None:
    pattern = beams.made(frame, n).model.pattern("mass", "M")
    assert pattern.full_nnz == STRUCTURE[frame, n]
    assert all(i >= j for i, j in pattern.entries)


@pytest.mark.parametrize(("frame", "n"), LIMITS)
def test_operations_of_mass_and_force(frame: str, n: int) -> None:
    model = beams.made(frame, n).model
    both = model.kernel("mass_force")
    assert both.operations == OPERATIONS[frame, n]
    assert both.operations <= LIMITS[frame, n]


@pytest.mark.parametrize(("frame", "n"), ACCELERATIONS)
def test_operations_of_accelerations(frame: str, n: int) -> None:
    """The rows of the constant block are eliminated beforehand, and forces that cancel are not computed."""
    assert beams.made(frame, n).model.kernel("accel").operations == ACCELERATIONS[frame, n]


@pytest.mark.parametrize("frame", ["mean", "point"])
def test_operations_of_two_shapes_with_those_moved_to_setup(frame: str) -> None:
    """The limit less what setup does for these two functions."""
    model = beams.made(frame, 2).model
    both = model.kernel("mass_force")
    assert both.operations <= LIMITS[frame, 2] - setup_for(model.kernel("setup"), both)


def setup_for(setup: Kernel, kernel: Kernel) -> int:
    """Operations of setup behind the constants that one kernel reads."""
    exprs = {s.name: s.expr for s in setup.statements if hasattr(s, "name")}
    names = setup.outputs[0].elements
    stored = {names[s.index]: s.expr for s in setup.statements if hasattr(s, "index")}
    needed = [stored[name] for name in sorted(kernel.used) if name in stored]
    seen: set[str] = set()
    count = 0
    while needed:
        for part in walk(needed.pop()):
            count += isinstance(part, Operation)
            if isinstance(part, ScalarRef) and part.name in exprs and part.name not in seen:
                seen.add(part.name)
                needed.append(exprs[part.name])
    return count


@pytest.mark.parametrize("frame", ["mean", "point"])
def test_no_kernel_does_work_on_parameters_alone(frame: str) -> None:
    for kernel in beams.made(frame, 4).model.kernels[1:]:
        constants = {name for a in kernel.arguments if a.name == "k" for name in a.elements}
        for item in kernel.statements:
            for part in walk(item.expr):
                refs = {e.name for e in walk(part) if isinstance(e, ScalarRef)}
                assert not (isinstance(part, Operation) and refs <= constants), (kernel.name, part)


@pytest.mark.parametrize("frame", beams.FRAMES)
def test_nothing_is_computed_twice_or_for_nothing(frame: str) -> None:
    for kernel in beams.made(frame, 4).model.kernels:
        parts = [part for item in kernel.statements for part in walk(item.expr) if isinstance(part, Operation)]
        assert len(parts) == len(set(parts)), kernel.name
        lets = [item.name for item in kernel.statements if hasattr(item, "name")]
        assert len(lets) == len(set(lets))
        assert set(lets) <= kernel.used, kernel.name


@pytest.mark.parametrize("frame", beams.FRAMES)
def test_names_of_a_kernel_do_not_collide(frame: str) -> None:
    for kernel in beams.made(frame, 3).model.kernels:
        names = [a.name for a in kernel.arguments] + [o.name for o in kernel.outputs]
        names += [n for a in kernel.arguments for n in a.elements if n in kernel.used]
        names += [item.name for item in kernel.statements if hasattr(item, "name")]
        assert len(names) == len(set(names)), kernel.name


def test_a_folded_model_has_no_constants_left() -> None:
    model = beams.build(beams.beam("mean", 2, mass=3, length=2, bending_stiffness=5)).model
    assert model.parameters == () and model.constants == ()
    assert model.kernel("setup").operations == 0
    assert model.kernel("mass_force").operations <= OPERATIONS["mean", 2]
