"""From the options of a command to the arguments of the public function that does its work."""

from __future__ import annotations

import argparse
import inspect
from collections.abc import Callable
from typing import Any


def keywords(function: Callable[..., Any], options: argparse.Namespace) -> dict[str, Any]:
    """The options of a command that are keyword arguments of a function: they have the same names."""
    parameters = inspect.signature(function).parameters.values()
    names = [parameter.name for parameter in parameters if parameter.kind is parameter.KEYWORD_ONLY]
    return {name: getattr(options, name) for name in names if hasattr(options, name)}
