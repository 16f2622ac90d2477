"""Symbolic bodies whose keys are wrong: every fault has its line, its key, and a sentence that helps."""

import pytest
from bodies import MODAL_BODY
from test_body_faults import errors

from derive.errors import SpecError
from derive.spec.construction.bodies import nodal_body, symbolic_body

SYMBOLIC = 'name = "b"\n[body]\nintegrals = "symbolic"\n'
NO_SUCH = "a symbolic body has no such key: its numbers are run-time parameters; leave this or `integrals` out"


@pytest.mark.parametrize(
    ("text", "messages"),
    [
        (SYMBOLIC, ["2: body.modes: this key is missing; write modes = 8"]),
        (SYMBOLIC + "modes = 301", ["4: body.modes: at most 300 modes are allowed, not 301"]),
        (
            SYMBOLIC + 'modes = 2\nframe = "point"',
            ['5: body.frame: the frame of a symbolic body is one of "mean", "given", not "point"'],
        ),
        (
            SYMBOLIC + 'modes = 2\nframe = { kind = "mean" }',
            ['5: body.frame: the frame of a symbolic body is one of "mean", "given", not a table'],
        ),
        (
            SYMBOLIC + "modes = 2\ndamping = { ratio = 0.01 }",
            ["5: body.damping: true or false is needed, without quotation marks, not a table"],
        ),
        (
            SYMBOLIC + 'modes = 2\nnodes = "b.npz"\nunits = "SI"\nmarkers = {}\ncolour = 1',
            [
                f"5: body.nodes: {NO_SUCH}",
                f"6: body.units: {NO_SUCH}",
                f"7: body.markers: {NO_SUCH}",
                "8: body.colour: unknown key; the keys here are integrals, modes, frame, damping, gravity, lowering",
            ],
        ),
        (
            SYMBOLIC.replace('"symbolic"', '"numbers"') + "modes = 2",
            ['3: body.integrals: `integrals` is one of "symbolic", not "numbers"'],
        ),
        (
            SYMBOLIC + 'modes = 2\ngravity = [{ symbol = "M", default = 0 }, { symbol = "k_1_2", default = 0 }, 0]',
            [
                '5: body.gravity[0].symbol: "M" is taken: it is the name of another parameter of a body in space',
                '5: body.gravity[1].symbol: "k_1_2" is taken: it is the name of another parameter of a body in space',
            ],
        ),
    ],
)
def test_a_fault_of_a_symbolic_body(tmp_path, text, messages):
    assert errors(text, tmp_path) == [f"b.toml:{message}" for message in messages]


@pytest.mark.parametrize("symbol", ["c", "c9_1", "g1", "K1", "mm", "d_1"])
def test_what_is_no_name_of_an_integral_may_be_a_symbol(symbol):
    assert symbolic_body("b", 1, gravity=[0, 0, {"symbol": symbol, "default": 1}]).gravity[2].symbol == symbol


@pytest.mark.parametrize("symbol", ["m", "K", "k", "C3", "c8", "C3_11", "B_1_2", "X1", "Phi1", "x1_1"])
def test_symbols_are_not_those_of_other_parameters(symbol):
    """Equal symbols would meet in the parameters of a model with loops, whichever lowering is chosen today."""
    with pytest.raises(SpecError, match="it is the name of another parameter of a body in space"):
        nodal_body("m", MODAL_BODY, units="SI", gravity=[0, 0, {"symbol": symbol, "default": 1}])
    with pytest.raises(SpecError, match="it is the name of another parameter of a body in space"):
        symbolic_body("m", 1, gravity=[0, 0, {"symbol": symbol, "default": 1}])
