"""Runs the examples that have changed, and writes the pages of the gallery.

    python -m docs.gallery [NAME ...]

With names of examples, the gallery has these alone. The pages go to build/docs/generated/gallery, which the site
takes over, the players and reports, which are complete pages, to build/docs/extra/gallery, and the results of the runs
stay in build/docs/examples.
"""

from __future__ import annotations

import sys

from derive.errors import TisserandError
from docs.gallery.entries import ROOT, entries
from docs.gallery.runs import results
from docs.gallery.written import gallery_files, write

BUILD = ROOT / "build/docs"


def main(names: list[str]) -> int:
    """Make the gallery, and print where it is and how long the examples take."""
    known = {entry.name: entry for entry in entries()}
    if unknown := set(names) - set(known):
        print(f"no example is called {', '.join(sorted(unknown))}; the names are {', '.join(known)}", file=sys.stderr)
        return 2
    chosen = [known[name] for name in names] or list(known.values())
    try:
        runs = results(chosen, BUILD / "examples")
    except TisserandError as error:
        print(error, file=sys.stderr)
        return 1
    sources, extra = gallery_files(runs)
    write(sources, BUILD / "generated/gallery")
    write(extra, BUILD / "extra/gallery")
    total = sum(run.seconds for run in runs)
    longest = sorted(runs, key=lambda run: -run.seconds)[:5]
    print(f"{len(runs)} examples, {total:.0f} s of processor time when they ran last;", end=" ")
    print("longest: " + ", ".join(f"{run.entry.name} {run.seconds:.0f} s" for run in longest))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
