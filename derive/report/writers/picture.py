"""Pictures within a page: SVG that keeps its names and its style to itself, and runs nothing."""

from __future__ import annotations

import re
from xml.etree import ElementTree

SVG = "http://www.w3.org/2000/svg"
LINK = "http://www.w3.org/1999/xlink"
_DRAWING = """svg g defs title desc style path rect circle ellipse line polyline polygon text tspan use clipPath mask
marker linearGradient radialGradient stop pattern symbol image"""
_MOVES = ("points",)
"""The only attributes that a picture may animate: positions, never addresses."""
_RASTER = "data:image/png;base64,"
"""The only allowed start of the address of an image: data in the picture itself."""
_ADDRESS = re.compile(r"url\(\s*['\"]?(#?)([^)'\"]*)['\"]?\s*\)")


def inline(svg: str, anchor: str, alt: str) -> str:
    """An SVG as an element of a page: named by `alt`, its ids behind the anchor, its style for itself alone.

    Raises ValueError of what is no plain drawing: scripts, events, foreign elements, addresses outside of the picture.
    """
    root = ElementTree.fromstring(svg)
    _drop_foreign(root)
    for element in root.iter():
        _checked(element)
        _own(element, anchor)
        if element.tag == "style":
            element.text = scoped(element.text or "", f"#{anchor}")
    for title in [item for item in root if item.tag == "title"]:
        root.remove(title)
    title = ElementTree.Element("title", {"id": f"{anchor}-title"})
    title.text = alt
    root.insert(0, title)
    attributes = {name: value for name, value in root.attrib.items() if name not in ("id", "role", "version")}
    if "viewBox" not in attributes:
        size = [re.sub(r"[a-z%]+$", "", root.get(name, "0")) for name in ("width", "height")]
        attributes["viewBox"] = f"0 0 {size[0]} {size[1]}"
    root.attrib.clear()
    root.attrib.update({"id": anchor, "role": "img", "aria-labelledby": f"{anchor}-title", **attributes})
    return ElementTree.tostring(root, encoding="unicode", short_empty_elements=True).strip()


def standalone(svg: str) -> str:
    """An SVG as a file of its own. Raises ValueError as `inline` does."""
    root = ElementTree.fromstring(svg)
    _drop_foreign(root)
    for element in root.iter():
        _checked(element)
    attributes = {"xmlns": SVG, **{name: value for name, value in root.attrib.items() if name != "xmlns"}}
    root.attrib.clear()
    root.attrib.update(attributes)
    return ElementTree.tostring(root, encoding="unicode").strip() + "\n"


def scoped(style: str, scope: str) -> str:
    """Style rules for what is within one element alone."""
    style = re.sub(r"/\*.*?\*/", "", style, flags=re.S)
    if "@import" in style or "<" in style:
        raise ValueError("a picture's style brings in something from outside")

    def narrowed(result: re.Match[str]) -> str:
        selectors = result[1].strip()
        if selectors.startswith("@"):
            return f" {selectors} {{"
        return f" {', '.join(f'{scope} {item.strip()}' for item in selectors.split(','))} {{"

    return re.sub(r"([^{}]+)\{", narrowed, style).strip()


def _drop_foreign(root: ElementTree.Element) -> None:
    """Remove the namespaces of tags and links, and the metadata that programs add about themselves."""
    for parent in list(root.iter()):
        for child in [item for item in parent if isinstance(item.tag, str) and item.tag == f"{{{SVG}}}metadata"]:
            parent.remove(child)
    for element in root.iter():
        element.tag = str(element.tag).removeprefix(f"{{{SVG}}}")
        for name in list(element.attrib):
            if name.startswith(f"{{{LINK}}}"):
                element.set(name.removeprefix(f"{{{LINK}}}"), element.attrib.pop(name))


def _checked(element: ElementTree.Element) -> None:
    moves = element.tag == "animate" and element.get("attributeName") in _MOVES
    if element.tag not in _DRAWING.split() and not moves:
        raise ValueError(f"a picture holds <{element.tag}>, which is no drawing")
    for name, value in element.attrib.items():
        within = value.startswith("#") or (element.tag == "image" and value.startswith(_RASTER))
        outside = name == "href" and not within
        if name.lower().startswith("on") or outside or any(not result[1] for result in _ADDRESS.finditer(value)):
            raise ValueError(f"a picture holds {name}={value!r}, which leads out of it")


def _own(element: ElementTree.Element, anchor: str) -> None:
    """Prefix ids and addresses with the anchor of the picture."""
    for name, value in element.attrib.items():
        if name == "id":
            element.set(name, f"{anchor}-{value}")
        elif name == "href" and value.startswith("#"):
            element.set(name, f"#{anchor}-{value[1:]}")
        elif "url(" in value:
            element.set(name, _ADDRESS.sub(lambda result: f"url(#{anchor}-{result[2]})", value))
