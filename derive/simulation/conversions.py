"""A trajectory as the tables of other packages: a data frame of pandas, a data set of xarray."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import Any

from derive.errors import TisserandError
from derive.simulation.observables.csv_writer import Column


class PandasMissing(TisserandError):
    """The package pandas is not installed."""


class XarrayMissing(TisserandError):
    """The package xarray is not installed."""


def data_frame(table: Sequence[Column]) -> Any:
    """A pandas.DataFrame of columns, indexed by the first one. Raises PandasMissing."""
    pandas = pandas_module()
    time, *columns = table
    index = pandas.Index(time.values, name=time.name)
    return pandas.DataFrame({column.name: column.values for column in columns}, index=index)


def pandas_module() -> Any:
    """The package pandas. Raises PandasMissing."""
    try:
        return import_module("pandas")
    except ImportError as error:
        raise PandasMissing("to_pandas needs the package pandas: pip install pandas") from error


def data_set(name: str, table: Sequence[Column], docs: Mapping[str, str]) -> Any:
    """An xarray.Dataset of columns over the dimension `time`, which is the first one. Raises XarrayMissing.

    docs: the description of each column, which becomes the attribute `long_name` beside `units`.
    """
    try:
        xarray = import_module("xarray")
    except ImportError as error:
        raise XarrayMissing("to_xarray needs the package xarray: pip install xarray") from error
    time, *columns = table
    variables = {c.name: ("time", c.values, _attributes(c, docs)) for c in columns}
    return xarray.Dataset(variables, {"time": ("time", time.values, _attributes(time, docs))}, {"title": name})


def _attributes(column: Column, docs: Mapping[str, str]) -> dict[str, str]:
    """The unit and the description of a column, by the names that xarray and NetCDF have for them."""
    return {"units": column.unit or "1", "long_name": docs[column.name]}
