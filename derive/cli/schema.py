"""`tisserand schema`: the JSON schema of specifications."""

from __future__ import annotations

import argparse

from derive.spec.tables.specification import json_schema


def run(_: argparse.Namespace) -> int:
    """Print the schema."""
    print(json_schema(), end="")
    return 0
