"""`tisserand schema`: print the JSON schema of specifications, or the reference that is made from it."""

from __future__ import annotations

import argparse

from derive.spec.tables.specification import json_schema


def run(options: argparse.Namespace) -> int:
    """Print the schema as JSON or as Markdown."""
    if options.markdown:
        from derive.cli.toml_reference import markdown

        print(markdown(json_schema()), end="")
    else:
        print(json_schema(), end="")
    return 0
