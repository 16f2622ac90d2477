"""`tisserand sid`: print a finite-element body as standard input data (SID), which other multibody programs read."""

from __future__ import annotations

import argparse
import sys

from derive.derivation import modal
from derive.errors import Problem, SpecError
from derive.sid import write
from derive.spec.model.body import NodalBody
from derive.spec.toml.read import read, with_lines


def run(options: argparse.Namespace) -> int:
    """Print the SID of a body."""
    spec = read(options.spec)
    if not isinstance(spec, NodalBody):
        message = "SID describes a body given by nodes, and this specification has none; see scenes/block.toml"
        raise SpecError((Problem("", message),), str(options.spec))
    try:
        body = modal(spec)
    except SpecError as error:
        raise with_lines(error, options.spec) from None
    sys.stdout.write(write(body))
    return 0
