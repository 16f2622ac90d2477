"""`tisserand run`: what a specification comes to, on one page, which `--open` shows in the browser.

Of a specification with a [simulation] this is the page of the simulation, of another one the report of its equations.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import webbrowser
from pathlib import Path

from derive.cli.report import model_report
from derive.cli.result_files import motion_page_path
from derive.cli.simulate import simulated_files
from derive.cli.simulation_summary import summary_text
from derive.cli.specifications import read_changed


def run(options: argparse.Namespace) -> int:
    """Simulate the specification or, if it has no simulation, write its report; then open the page if requested."""
    spec, _ = read_changed(options.spec, options.set)
    settings = (options.set, options.duration, options.output, options.tolerance, options.until, options.step)
    if spec.simulation is not None or options.resume or any(settings):
        summary = simulated_files(options)
        page, text = options.out / motion_page_path(spec.name), summary_text(summary)
    else:
        page = model_report(options.spec, options.out)
        summary = {"name": spec.name, "files": [str(page)]}
        text = f"{spec.name}: it has no [simulation], so that the page shows its equations alone\n\nwrote {page}"
    print(json.dumps({**summary, "page": str(page)}, indent=2) if options.json else text)
    if options.open:
        _open(page)
    return 0


def _open(page: Path) -> None:
    """Show a page in the browser; on a machine without a display, or without a browser, its path is printed instead."""
    if not (_has_display() and webbrowser.open(page.resolve().as_uri())):
        print(f"no browser here; open {page} yourself", file=sys.stderr)


def _has_display() -> bool:
    """Whether a browser has somewhere to appear: webbrowser would start one in the terminal otherwise."""
    return sys.platform in ("win32", "darwin") or any(map(os.environ.get, ("BROWSER", "DISPLAY", "WAYLAND_DISPLAY")))
