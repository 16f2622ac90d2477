"""The work of an expansion, in calls of functions, which are the same on any machine."""

from __future__ import annotations

import sys
from importlib.util import module_from_spec, spec_from_file_location

from sympy.core.cache import clear_cache

import derive
from conftest import ROOT
from derive.mechanics.expansion import expand


def calls_of_expansion(body: derive.ModalBody) -> int:
    """The calls of Python functions while the equations of a body are expanded."""
    expanded = derive.derive_modal(body, lowering="flat").body
    assert expanded is not None
    count = 0

    def seen(_frame: object, event: str, _argument: object) -> None:
        nonlocal count
        count += event == "call"

    expand(expanded)  # so that it makes no difference which symbols earlier tests have made
    clear_cache()
    sys.setprofile(seen)
    try:
        expand(expanded)
    finally:
        sys.setprofile(None)
    return count


def test_the_work_grows_less_than_the_tables() -> None:
    """Twice as many modes have four times the entries, most of which vanish in a beam."""
    script = spec_from_file_location("bench_bodies", ROOT / "bench" / "bodies.py")  # tests have a module of this name
    assert script is not None and script.loader is not None
    bodies = module_from_spec(script)
    script.loader.exec_module(bodies)
    beam = bodies.beam
    small, large = (calls_of_expansion(beam(n)) for n in (10, 20))
    assert large < 500_000
    assert large < 1.8 * small
