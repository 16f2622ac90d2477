"""The navigation of the site: its sections and their pages, in order."""

from __future__ import annotations

from collections.abc import Collection
from fnmatch import fnmatch

SECTIONS = {
    "Tutorials": (
        "first_steps",
        "tutorial_mechanism",
        "tutorial_body",
        "tutorial_c",
        "tutorial_*",
        "notebooks/mechanism",
        "notebooks/*",
    ),
    "Gallery": ("gallery/index", "examples"),
    "How-to": ("how_to/*", "hosts"),
    "Reference": ("commands", "command_line", "reference_toml", "api/index", "generated_code"),
    "Theory": ("theory", "monitors", "second_order"),
    "Results": ("where_methods_fail", "benchmarks"),
    "Development": ("contributing", "changelog", "code_of_conduct", "security"),
}
"""The pages of each section, as patterns; those that this build does not have are left out."""


def toctrees(documents: Collection[str]) -> str:
    """The Markdown of the navigation, with those of the patterns that documents match, each document once."""
    result = ["\n```{toctree}\n:caption: Start\n:hidden:\n\nStart <self>\n```\n"]
    listed: set[str] = set()
    for caption, patterns in SECTIONS.items():
        entries = []
        for pattern in patterns:
            new = [name for name in sorted(documents) if fnmatch(name, pattern) and name not in listed]
            entries += new
            listed.update(new)
        result.append("\n".join(["", "```{toctree}", f":caption: {caption}", ":hidden:", "", *entries, "```", ""]))
    return "".join(result)
