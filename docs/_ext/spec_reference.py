"""The reference of the spec language, made from what reads it."""

from collections.abc import Iterator
from typing import Any

from mimoc.schema.base import KeyPath
from mimoc.schema.cohort_file import CohortSpec
from mimoc.schema.infant import InfantSpec
from mimoc.schema.outline import Language, Outline, language_of
from mimoc.schema.world import WorldSpec

BOUNDS = {
    "minimum": "at least {}",
    "exclusiveMinimum": "above {}",
    "maximum": "at most {}",
    "exclusiveMaximum": "below {}",
}
TYPES = {
    "number": "number",
    "integer": "whole number",
    "string": "text",
    "boolean": "true or false",
    "array": "list",
    "section": "section",
}
LONGEST = 20
"""Longest list of words that is printed."""
UNITS = {
    "deg": "degrees",
    "ms": "ms",
    "px": "pixels",
    "n": "newtons",
    "cpd": "cycles per degree",
    "percentile": "per cent of children",
}
FILES = {"spec": InfantSpec, "cohort": CohortSpec, "world": WorldSpec}


def reference(of: str) -> str:
    """Return the reference of a kind of files (one of FILES) as Markdown."""
    return "\n".join(_section(language_of(FILES[of]), ()))


def _section(language: Language, path: KeyPath) -> Iterator[str]:
    """Yield the lines about the section at a path, then those about the sections in it."""
    outline = language.outline(path)
    yield from _heading(language, path, outline)
    kinds = language.kinds_of(path)
    inner = []
    if kinds:
        yield f"One of {_words(kinds)}, by its key `kind`.\n"
    for name, kind in kinds.items():
        yield f"### `{'.'.join(map(str, path))}: {{kind: {name}}}`\n"
        yield _flowing(kind.schema.get("description", "")) + "\n"
        yield from _keys(language, path, kind, [key for key in kind.keys if key != "kind"])
    if not kinds:
        yield from _keys(language, path, outline, outline.keys)
        inner = [key for key in outline.keys if _is_section(language, (*path, key))]
    for key in inner:
        yield from _section(language, (*path, key))


def _heading(language: Language, path: KeyPath, outline: Outline) -> Iterator[str]:
    if path:
        yield f"\n## `{'.'.join(map(str, path))}`\n" if len(path) == 1 else f"\n### `{'.'.join(map(str, path))}`\n"
        node = language.outline(path[:-1]).schema["properties"][path[-1]]
        yield _flowing(node.get("description") or outline.schema.get("description", "")).replace("\n  ", "\n") + "\n"
    else:
        yield "## The whole file\n"


def _keys(language: Language, path: KeyPath, section: Outline, keys: Any) -> Iterator[str]:
    """Yield a definition for each key of a section."""
    required = section.schema.get("required", ())
    for key in keys:
        node = section.schema["properties"][key]
        here = language.outline((*path, key)) if key in language.outline(path).keys else Outline(node)
        about = _flowing(node.get("description") or here.schema.get("description", ""))
        yield f"`{key}`"
        yield f": *{_value(node, here, language.outline((*path, key, 0)))}; {_default(node, key in required)}*\n"
        yield f"  {about}\n"
        if names := _names(node, language.outline((*path, key, 0))):
            yield f"  {names}\n"


def _is_section(language: Language, path: KeyPath) -> bool:
    return bool(language.outline(path).keys or language.kinds_of(path))


def _value(node: dict[str, Any], outline: Outline, items: Outline) -> str:
    """Return what a value can be, in words."""
    if outline.keys and not outline.choices:
        return "section"
    schema = {**outline.schema, **node}
    bounds = [text.format(f"{schema[key]:g}") for key, text in BOUNDS.items() if abs(schema.get(key, 1e9)) < 1e9]
    if "minimum" in schema and "exclusiveMinimum" in schema:
        bounds.remove(BOUNDS["exclusiveMinimum"].format(f"{schema['exclusiveMinimum']:g}"))
    unit = UNITS.get(outline.unit or "", outline.unit or "")
    return ", ".join(filter(None, (_alternatives(node, outline, items), *bounds, unit and f"in {unit}")))


def _alternatives(node: dict[str, Any], outline: Outline, items: Outline) -> str:
    """Return the kinds of values that there can be: words, numbers, lists, and values by name."""
    options = [each for each in _options(node) if "enum" not in each and "const" not in each] or [node]
    types = [each.get("type", "section" if "$ref" in each else "") for each in options]
    if outline.choices:
        types = [each for each in types if each in {"number", "integer", "section"} and _options(node)]
    names = [TYPES[each] for each in dict.fromkeys(types) if each in TYPES]
    if "list" in names and 0 < len(items.choices) <= LONGEST:
        names[names.index("list")] = f"list of {_words(items.choices)}"
    said = " or ".join(filter(None, (_words(outline.choices) if outline.choices else "", *names)))
    return said or "values by name"


def _options(node: dict[str, Any]) -> list[dict[str, Any]]:
    return [*node.get("anyOf", ()), *node.get("oneOf", ())]


def _names(node: dict[str, Any], items: Outline) -> str:
    """Return the words that a key can have as names, or in a long list, as a sentence; those of the right left out."""
    words = node.get("propertyNames", {}).get("enum") or (items.choices if len(items.choices) > LONGEST else ())
    shown = [word for word in words if not (word.startswith("right_") and f"left_{word[6:]}" in words)]
    if not shown:
        return ""
    return f"One of {_words(shown)}{', and likewise with `right_`' if len(shown) < len(words) else ''}."


def _default(node: dict[str, Any], required: bool) -> str:
    if required:
        return "required"
    default = node.get("default")
    return "optional" if default is None or default in ({}, [], ()) else f"default `{_plain(default)}`"


def _plain(value: Any) -> str:
    """Return a value as YAML has it on one line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {_plain(each)}" for key, each in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_plain, value)) + "]"
    return str(value).lower() if isinstance(value, bool) else str(value)


def _words(choices: Any) -> str:
    *most, last = [f"`{_plain(each)}`" for each in choices]
    return f"{', '.join(most)} or {last}" if most else last


def _flowing(text: str) -> str:
    """Return a description with its paragraphs on one line each, inside a definition."""
    return "\n\n  ".join(" ".join(paragraph.split()) for paragraph in text.split("\n\n"))
