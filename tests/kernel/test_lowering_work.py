"""The work of a lowering to straight-line code: what kernels share is done once."""

from __future__ import annotations

import pytest

import beams
import derive
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.context import Context
from derive.mechanics.typed_symbol import Symbol


def test_kernels_of_the_same_arguments_share_the_definitions(monkeypatch: pytest.MonkeyPatch) -> None:
    """They are converted once for all kernels of the same arguments, and anew when `accel` has added constants."""
    equations, made, new_symbols = beams.made("mean", 2).equations, list[tuple[Symbol, ...]](), Context._new_symbols

    def counted(context: Context, inputs: tuple[Symbol, ...]) -> Symbols:
        made.append(inputs)
        return new_symbols(context, inputs)

    monkeypatch.setattr(Context, "_new_symbols", counted)
    model = derive.lower(equations)
    assert len(made) == len({*made}) + 1 == 6 < len(model.kernels)
