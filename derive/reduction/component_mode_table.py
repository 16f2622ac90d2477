"""Frequencies and deflections of component modes beside those of the full matrices, and what each mode is made of."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from derive.reduction.body import prepare
from derive.reduction.component_modes import ModeKind, component_modes, mode_kinds
from derive.reduction.eigen import elastic_modes
from derive.reduction.frames import from_centre_of_mass, orthonormal_modes
from derive.reduction.mode_errors import mode_errors, unit_loads
from derive.reduction.mode_selection import with_selected_modes
from derive.spec.model.body import NodalBody


@dataclass(frozen=True)
class InterfaceDeflection:
    """The deflection at a unit load of the interface, m/N or rad/(N m): by the modes, and by the full matrices."""

    load: str
    own: float
    full: float

    @property
    def error(self) -> float:
        """The part of the deflection that the modes miss."""
        return abs(1 - self.own / self.full)


@dataclass(frozen=True)
class ComponentMode:
    """A component mode: its frequency (Hz), the modes with more of its strain energy, and the frequency of the free
    body of the same number by the full matrices (Hz)."""

    frequency: float
    kind: ModeKind
    full: float

    @property
    def excess(self) -> str:
        """By how much the frequency exceeds that of the full matrices, in percent."""
        percent = 100 * (self.frequency / self.full - 1)
        return f"{percent:+.2g} %" if abs(percent) < 10 else f"{percent:+.0f} %"


def component_mode_table(body: NodalBody) -> tuple[ComponentMode, ...]:
    """The component modes of a body with an interface, by their frequencies. Raises SpecError as `reduce` does."""
    prepared, body = prepare(body), with_selected_modes(body)
    assert body.data.stiffness is not None  # by check_body
    mass, x = prepared.mass, from_centre_of_mass(prepared.mass, prepared.raw.x)
    kinds = mode_kinds(component_modes(body, mass, x), prepared.raw.phi, body.data.stiffness)
    own = np.sqrt(np.maximum(np.diag(prepared.raw.stiffness), 0.0))
    full = np.sqrt(np.maximum(orthonormal_modes(mass, *elastic_modes(body, mass, x))[1][: len(own)], 0.0))
    return tuple(ComponentMode(*row) for row in zip(own / (2 * np.pi), kinds, full / (2 * np.pi), strict=True))


def interface_deflections(body: NodalBody) -> tuple[InterfaceDeflection, ...]:
    """The deflections at unit loads of the interface of a body. Raises SpecError as `reduce` does."""
    loads = unit_loads(body)
    own = mode_errors(body, prepare(body).raw.phi, np.zeros(0)).deflections
    rows = zip(loads.names, own.tolist(), loads.deflections.tolist(), strict=True)
    return tuple(InterfaceDeflection(*row) for row in rows)
