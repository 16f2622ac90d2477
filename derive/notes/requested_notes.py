"""The functions on request that a model does not have, with the reasons."""

from __future__ import annotations

from collections.abc import Iterator

from derive.ir.model import Model


def requested_notes(model: Model) -> Iterator[str]:
    """Yield a line for each function that was requested and that the model cannot have."""
    kernels = [kernel.name for kernel in model.kernels]
    for name in model.requested:
        if name == "marker_rotations":
            if not any(kernel.startswith("rotation_") for kernel in kernels):
                yield f"no {name}: " + (
                    "there are no markers" if model.is_scene else "markers of a body alone are points"
                )
        elif name not in kernels:
            yield f"no {name}: there are no bodies with coordinates that no drive moves"
