"""The data of a SID that a modal body does not use. `read` reports them, so that nothing is dropped in silence."""

from __future__ import annotations

from collections.abc import Iterator

from derive.sid.blocks import Block, BlockEntry
from derive.sid.mapping import MATRICES

VALUES = ("m0", "m1")
NODE_BLOCKS = ("origin", "phi", "AP")
NOT_USED = {
    "psi": "points of a modal body do not rotate, and moments (K0M) do not act on them",
    "sigma": "there are no stresses in a modal body",
}


class SidWarning(UserWarning):
    """A SID contains data that are not used. Each line of the text names some of them, after the number of a line."""


Unused = tuple[int, str, str]
"""The number of a line, the data that are not used there, and the reason."""


def unused(root: Block, used: tuple[str, ...] = ()) -> tuple[str, ...]:
    """Lines of text about entries and blocks that `read` does not use: one for those of the same kind.

    used: blocks of nodes whose constant parts are used none the less.
    """
    gathered: dict[tuple[str, str], list[int]] = {}
    for line, what, why in _unused(root, used):
        gathered.setdefault((what, why), []).append(line)

    def text(what: str, why: str, lines: list[int]) -> str:
        more = f" and in {len(lines) - 1} more places" if len(lines) > 1 else ""
        return f"{lines[0]}: {what}{more} is not used: {why}"

    return tuple(text(*kind, lines) for kind, lines in sorted(gathered.items(), key=lambda item: item[1]))


def _unused(root: Block, used: tuple[str, ...]) -> Iterator[Unused]:
    """Each entry or block that is not used, one by one."""
    parts = [block for block in root.blocks if block.name == "part"]
    yield from ((block.line, block.name, "it is no part") for block in root.blocks if block.name != "part")
    yield from ((part.line, "part", "only the first part is read") for part in parts[1:])
    modal = parts[0].find("modal") if parts else None
    for block in parts[0].blocks if parts else ():
        if block is not modal:
            yield block.line, block.name, "only the first `new modal` is read"
    if modal:
        yield from _of_modal(modal, used)


def _of_modal(modal: Block, used: tuple[str, ...]) -> Iterator[Unused]:
    """The data of a body that are not used."""
    yield from _entries(modal, ())
    known = {name: modal.find(name) for name in ("refmod", "frame", *MATRICES)}
    for block in modal.blocks:
        if known.get(block.name) is not block:
            why = "only the first one is read" if block.name in known else "a modal body has no such data"
            yield block.line, block.name, why
    if refmod := known["refmod"]:
        yield from _entries(refmod, ("mass", "nelastq", "ielastq"))
    if frame := known["frame"]:
        yield from _entries(frame, ())
        for block in frame.blocks:
            if block.name == "node":
                yield from _of_node(block, used)
            else:
                yield block.line, block.name, "it is no node"


def _of_node(node: Block, used: tuple[str, ...]) -> Iterator[Unused]:
    """The data of a node that are not used. The first order of AP has the same content as psi."""
    yield from _entries(node, ("rframe",))
    for entry in node.entries:
        if entry.key == "rframe" and entry.value != "body ref":
            yield entry.line, f"rframe = {entry.value}", "positions are taken in the frame of the body"
    for block in node.blocks:
        if block.name in NOT_USED:
            values = VALUES[1:] if block.name in used else VALUES
            if any(entry.key in values and _is_not_zero(entry) for entry in block.entries):
                yield block.line, f"{block.name} of a node", NOT_USED[block.name]
        elif node.find(block.name) is not block or block.name not in NODE_BLOCKS:
            yield block.line, f"{block.name} of a node", "a point of a modal body has no such data"


def _entries(block: Block, known: tuple[str, ...]) -> Iterator[Unused]:
    """The entries of a block that are not read."""
    for entry in block.entries:
        if entry.key not in known:
            yield entry.line, f"{entry.key} in {block.name}", "a modal body has no such data"


def _is_not_zero(entry: BlockEntry) -> bool:
    """Whether a number has a digit other than zero before its exponent."""
    return any(c in "123456789" for c in entry.value.lower().replace("d", "e").partition("e")[0])
