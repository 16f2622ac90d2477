"""A strict reader of HTML: every element is closed in order, every id is one of a kind, every link leads somewhere."""

from __future__ import annotations

from html.parser import HTMLParser

VOID = {"meta", "br", "hr", "img", "link", "input", "wbr"}
TEXT = {"style", "title"}


class Page(HTMLParser):
    """The content of a page; `faults` lists the rules that it breaks."""

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.faults: list[str] = []
        self.open: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.words: dict[str, list[str]] = {}
        self.feed(text)
        self.close()
        self.faults += [f"<{tag}> is not closed" for tag in self.open]
        ids = [value for _, attributes in self.tags for name, value in attributes.items() if name == "id"]
        self.faults += [f"id {one} comes twice" for one in set(ids) if ids.count(one) > 1]
        for to in self.values("href"):
            if to.startswith("#") and to[1:] not in ids:
                self.faults.append(f"nothing has the id of {to}")
        for name in ("aria-labelledby",):
            self.faults += [f"{name}={one}" for one in self.values(name) if one not in ids]

    def values(self, name: str) -> list[str]:
        """All values of an attribute."""
        return [value for _, attributes in self.tags for key, value in attributes.items() if key == name and value]

    def count(self, tag: str) -> int:
        """How many elements there are of a kind."""
        return sum(one == tag for one, _ in self.tags)

    def text(self, tag: str) -> str:
        """The text that stands directly in elements of a kind."""
        return "".join(self.words.get(tag, []))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_startendtag(tag, attrs)
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        attributes = dict(attrs)
        if len(attributes) < len(attrs):
            self.faults.append(f"<{tag}> has an attribute twice")
        self.faults += [f"<{tag} {name}>" for name in attributes if name.startswith("on")]
        self.tags.append((tag, attributes))

    def handle_endtag(self, tag: str) -> None:
        if not self.open or self.open.pop() != tag:
            self.faults.append(f"</{tag}> closes nothing")

    def handle_data(self, data: str) -> None:
        if self.open:
            self.words.setdefault(self.open[-1], []).append(data)

    def unknown_decl(self, data: str) -> None:
        self.faults.append(f"<!{data}>")
