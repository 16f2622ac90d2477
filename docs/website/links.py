"""Links of a page of the repository, as the site has them."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import PurePosixPath
from posixpath import join, normpath, relpath

FENCE = re.compile(r"^ *(```+|~~~+).*?^ *\1", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"(?P<before>\]\()(?P<target>[^)\s]+)(?P<after>\))")


def with_links(text: str, source: str, page: str, place: Callable[[str], str]) -> tuple[str, set[str]]:
    """The Markdown of a page with the links of the site, and the files of the repository that it links to.

    source, page: its path in the repository and in the site; place: the path in the site of a path in the repository.
    Code in fences stays as it is, and so do links to other sites and within the page.
    """
    linked: set[str] = set()

    def link(match: re.Match[str]) -> str:
        target, hash_sign, anchor = match["target"].partition("#")
        if not target or re.match(r"[a-z]+:", target):
            return match[0]
        path = normpath(join(PurePosixPath(source).parent, target))
        linked.add(path)
        new = relpath(place(path), PurePosixPath(page).parent)
        return f"{match['before']}{new}{hash_sign}{anchor}{match['after']}"

    parts, end = [], 0
    for fence in FENCE.finditer(text):
        parts += [LINK.sub(link, text[end : fence.start()]), fence[0]]
        end = fence.end()
    parts.append(LINK.sub(link, text[end:]))
    return "".join(parts), linked
