"""The reference of the Python API, from signatures, type hints and docstrings."""

from __future__ import annotations

import ast
import inspect
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from enum import Enum
from typing import Any, get_type_hints

import derive
from derive.registry import Registry
from derive.spec.model.keys import Key
from website.api_groups import GROUPS, Group, names
from website.docstrings import definitions, entries, markdown, sections, summary

LONGEST_DEFAULT = 40
"""Characters of the longest default that signatures show."""


def pages() -> dict[str, str]:
    """The Markdown of all pages by their paths in the site; ValueError unless each public name is on one of them."""
    listed = [name for group in GROUPS.values() for name in names(group)]
    if sorted(listed) != sorted(derive.__all__):
        raise ValueError(f"on no page, or on several: {sorted({*derive.__all__} ^ {*listed})}; see api_groups.py")
    return {"api/index.md": _index()} | {f"api/{file}.md": _page(file, group) for file, group in GROUPS.items()}


def _index() -> str:
    parts = [
        "# Python API",
        "All names of the package `derive`, by use. Arrays are NumPy arrays of doubles, and all values are in SI "
        "units. Names are imported when they are first used, so that `import derive` is fast.",
        "```{toctree}\n:hidden:\n\n" + "\n".join(GROUPS) + "\n```",
        "```{py:module} derive\n```",
    ]
    for file, group in GROUPS.items():
        rows = [f"| {_reference(name)} | {_summary(name)} |" for name in names(group)]
        parts += [f"## [{group.title}]({file}.md)", "\n".join(["| name | purpose |", "|---|---|", *rows])]
    return "\n\n".join(parts) + "\n"


def _page(file: str, group: Group) -> str:
    parts = [f"# {group.title}", group.text, "```{py:currentmodule} derive\n```"]
    for heading, section in group.names.items():
        parts += [f"## {heading}"] if heading else []
        parts += [_entry(name, group.constructed) for name in section.split()]
    return "\n\n".join(parts) + "\n"


def _reference(name: str) -> str:
    return f"{{py:obj}}`{name} <derive.{name}>`"


def _link(code: str, owner: str = "") -> str:
    """Code in a docstring, which is a link if it names something public."""
    name = code.removeprefix("derive.").removesuffix("()")
    first, _, member = name.partition(".")
    if first in derive.__all__ and first != owner and (not member or member in dict(_members(getattr(derive, first)))):
        return f"{{py:obj}}`{code} <derive.{name}>`"
    if owner and name in dict(_members(getattr(derive, owner))):
        return f"{{py:obj}}`{code} <derive.{owner}.{name}>`"
    return f"`{code}`"


def _documentation(name: str) -> str:
    if name == "__version__":
        return f'The version of Tisserand, a text such as "{derive.__version__}".'
    shown = getattr(derive, name)
    return inspect.getdoc(shown) or "" if callable(shown) else inspect.cleandoc(shown.__doc__ or "")


def _summary(name: str) -> str:
    return summary(_documentation(name), _link).replace("\n", " ")


def _directive(kind: str, text: str, content: str, options: tuple[str, ...] = (), ticks: int = 8) -> str:
    fence = "`" * ticks
    return "\n".join([f"{fence}{{py:{kind}}} {text}", *options, "", content, fence])


def _entry(name: str, constructed: bool) -> str:
    """The entry of a public name."""
    shown = getattr(derive, name)
    text = _documentation(name)
    if isinstance(shown, Registry):
        known = ", ".join(f"`{member}`" for member in shown)
        return _directive("data", name, f"{markdown(text, _link, {})}\n\n**Registered**\n\n{known}")
    if not callable(shown):
        return _directive("data", name, markdown(text, _link, {}))
    if not isinstance(shown, type):
        return _directive("function", f"{name}{_signature(shown)}", markdown(text, _link, {}))
    kind = "exception" if issubclass(shown, BaseException) else "class"
    signature = _signature(shown) if constructed and not issubclass(shown, Enum) else ""
    content = [_bases(shown), _class_text(name, shown, text)]
    content += [_member_entry(name, member, value) for member, value in _members(shown)]
    return _directive(kind, f"{name}{signature}", "\n\n".join(part for part in content if part))


def _bases(shown: type) -> str:
    public = [base.__name__ for base in shown.__bases__ if base.__name__ in derive.__all__]
    return f"Base: {', '.join(map(_reference, public))}." if public else ""


def _class_text(name: str, shown: type, text: str) -> str:
    """The docstring of a class with the types of its attributes, and the fields that it does not describe."""
    types, described = {}, {one for head, part in sections(text) if head == "Attributes" for one, _ in entries(part)}
    rest = []
    if is_dataclass(shown):
        hints = get_type_hints(shown, include_extras=True) if _resolves(shown) else {}
        for field in fields(shown):
            types[field.name] = _annotation(field.type)
            keys = [key for key in getattr(hints.get(field.name), "__metadata__", ()) if isinstance(key, Key)]
            if field.name not in {one for group in described for one in group.split(", ")}:
                rest += [(field.name, types[field.name], key.description) for key in keys[:1] if key.description]
    elif issubclass(shown, Enum):
        rest = [(member.name, "", str(member.value)) for member in shown]
    result = markdown(text, lambda code: _link(code, name), types)
    if rest:
        title = "Members" if issubclass(shown, Enum) else "Fields"
        result += f"\n\n**{title}**\n\n{definitions(rest, lambda code: _link(code, name))}"
    return result


def _resolves(shown: type) -> bool:
    try:
        get_type_hints(shown, include_extras=True)
    except NameError:
        return False
    return True


def _members(shown: Any) -> Iterator[tuple[str, Any]]:
    """The documented methods and properties of a class, with those of bases that are not public."""
    if not isinstance(shown, type):
        return
    known = set()
    for base in shown.__mro__:
        if not base.__module__.startswith("derive") or (base is not shown and base.__name__ in derive.__all__):
            continue
        for name, value in vars(base).items():
            function = getattr(value, "__func__", value)
            documented = inspect.isfunction(function) or isinstance(value, property) or hasattr(value, "attrname")
            if documented and not name.startswith("_") and name not in known and inspect.getdoc(value):
                known.add(name)
                yield name, value


def _member_entry(owner: str, name: str, value: Any) -> str:
    content = markdown(inspect.getdoc(value) or "", lambda code: _link(code, owner), {})
    if not inspect.isfunction(getattr(value, "__func__", value)):
        function = value.fget if isinstance(value, property) else value.func
        kind = _annotation(function.__annotations__.get("return", ""))
        return _directive("property", f"{owner}.{name}", content, (f":type: {kind}",) if kind else (), 6)
    option = (f":{type(value).__name__}:",) if isinstance(value, classmethod | staticmethod) else ()
    function = getattr(value, "__func__", value)
    signature = _signature(function, bound=not isinstance(value, staticmethod))
    return _directive("method", f"{owner}.{name}{signature}", content, option, 6)


def _annotation(annotation: Any) -> str:
    """The text of a type hint without the declarations of keys that it may carry."""
    if annotation is inspect.Parameter.empty or annotation is None:
        return ""
    text = annotation if isinstance(annotation, str) else getattr(annotation, "__name__", str(annotation))
    if not text:
        return ""

    class Plain(ast.NodeTransformer):
        def visit_Subscript(self, node: ast.Subscript) -> ast.AST:
            self.generic_visit(node)
            annotated = isinstance(node.value, ast.Name) and node.value.id == "Annotated"
            return node.slice.elts[0] if annotated and isinstance(node.slice, ast.Tuple) else node

    return ast.unparse(Plain().visit(ast.parse(text, mode="eval")))


def _default(value: Any) -> str:
    """A default as signatures show it: short, and never the address of an object."""
    text = repr(value)
    return text if len(text) <= LONGEST_DEFAULT and not text.startswith("<") else "..."


def _signature(function: Any, bound: bool = False) -> str:
    """The signature of a function, or of the construction of a class."""
    try:
        signature = inspect.signature(function)
    except ValueError:
        return ""
    parts, star, positional = [], False, False
    parameters = list(signature.parameters.values())[1 if bound else 0 :]
    for parameter in parameters:
        if positional and parameter.kind is not parameter.POSITIONAL_ONLY:
            parts.append("/")
        positional = parameter.kind is parameter.POSITIONAL_ONLY
        if parameter.kind is parameter.KEYWORD_ONLY and not star:
            parts.append("*")
        star = star or parameter.kind in (parameter.KEYWORD_ONLY, parameter.VAR_POSITIONAL)
        prefix = {parameter.VAR_POSITIONAL: "*", parameter.VAR_KEYWORD: "**"}.get(parameter.kind, "")
        hint = _annotation(parameter.annotation)
        default = "" if parameter.default is parameter.empty else _default(parameter.default)
        text = f"{prefix}{parameter.name}{f': {hint}' if hint else ''}"
        parts.append(f"{text}{f' = {default}' if hint else f'={default}'}" if default else text)
    parts += ["/"] if positional else []
    returned = "" if isinstance(function, type) else _annotation(signature.return_annotation)
    return f"({', '.join(parts)}){f' -> {returned}' if returned else ''}"
