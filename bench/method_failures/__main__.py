"""Where methods fail, each on a small case that shows the failure by itself: by theory and by experiment.

`python -m bench.method_failures` prints the tables, and a line for each failure with its criterion and the measurement;
with `--write` it also draws docs/method_failures.svg.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from bench.method_failures.lines import small_failures
from bench.method_failures.picture import failures_svg
from bench.method_failures.small_cases import small_cases
from bench.method_failures.tables import tables
from derive.study.methods.failures import failure_lines

PICTURE = Path(__file__).parents[2] / "docs/method_failures.svg"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true", help=f"draw {PICTURE.name} in docs as well")
    options = parser.parse_args()
    cases = small_cases()
    lines = [line for table in tables(cases) for line in (*table.text, "")]
    print("\n".join([*lines, *failure_lines(small_failures(cases))]))
    if options.write:
        PICTURE.write_text(failures_svg(cases))


if __name__ == "__main__":
    main()
