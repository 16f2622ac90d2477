"""Specifications checked as a TOML file is, from dataclasses or tables."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

from derive.spec.as_tables import as_table, specification_tables
from derive.spec.model.specification import Specification, check_specification

S = TypeVar("S", bound=Specification)


def validated(spec: S) -> S:
    """A specification built of dataclasses, checked as a TOML file is; numbers and texts become exact values.

    The dataclasses themselves check nothing, so that `Scene(...)` built by hand goes through this function first.

    Arguments:
        spec: a scene or a body.

    Returns:
        A specification of the same type.

    Raises:
        SpecError: with all faults.
        TypeError: for anything but a specification.

    Examples:
        >>> import derive
        >>> import dataclasses
        >>> beam = derive.planar_beam("beam", mass=2)
        >>> derive.validated(dataclasses.replace(beam, mass="1/3")).mass
        Fraction(1, 3)
    """
    check_specification(spec)
    return validated_tables(spec, specification_tables(spec))


def validated_tables(spec: S, tables: Mapping[str, object]) -> S:
    """A specification of the same type as `spec` from its tables, in which values may have been replaced.

    Numbers of reference curves are those of `spec`, whose files are not read again. Plots may show columns that there
    are with the replaced values alone: a simulation looks for them.
    """
    curves = {plot.name: plot.reference.rows for plot in spec.plots if plot.reference}
    result = validated_data(tables, curves, columns=False)
    assert isinstance(result, type(spec))
    return result


def validated_data(
    data: Mapping[str, object], curves: Mapping[str, tuple[tuple[float, float], ...]] = {}, columns: bool = True
) -> Specification:
    """The specification of tables and typed values; columns: whether plots may show only those that there can be."""
    # pydantic is imported only when there is something to check.
    from derive.spec.checks.validation import validate

    return validate(as_table(data), curves=curves, columns=columns)
