"""Queries of the spec language: which keys and values are allowed at a path."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any

from mimoc.schema.composition import on_recompose
from mimoc.schema.key_paths import KeyPath
from mimoc.schema.spec import InfantKeys


@dataclass(frozen=True)
class Outline:
    """Description of one value of the spec language."""

    schema: dict[str, Any]
    """Its JSON schema."""

    @property
    def type(self) -> str:
        """Its JSON type, or empty if there are several."""
        return self.schema.get("type", "")

    @property
    def unit(self) -> str | None:
        """Its unit or that of its items, as written in suffixes of names."""
        first = self.schema
        while "prefixItems" in first:
            first = _resolved(first["prefixItems"][0])
        return first.get("unit")

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys of a section."""
        return tuple(self.schema.get("properties", ()))

    @property
    def choices(self) -> tuple[Any, ...]:
        """The words it can have as its value."""
        return tuple(_choices(self.schema))

    @property
    def example(self) -> Any:
        """A valid value, for a key that has no default."""
        if "examples" in self.schema:
            return self.schema["examples"][0]
        return (*self.choices, 1)[0]


def outline(path: KeyPath) -> Outline:
    """Return the description of the value at a path, which is empty for an unknown path."""
    return Outline(_resolved(_node(path)))


def kinds_of(path: KeyPath) -> dict[str, Outline]:
    """Return the alternative sections at a path, by the value of their discriminator; empty for most paths."""
    unions = [option for option in (_node(path), *_node(path).get("anyOf", ())) if "discriminator" in option]
    return {
        name: Outline(_resolved({"$ref": reference}))
        for union in unions
        for name, reference in union["discriminator"]["mapping"].items()
    }


def is_known(path: KeyPath) -> bool:
    """Return whether a path is that of an item, of a known key, or of a section in which any key is allowed."""
    section = outline(path[:-1])
    return not section.keys or path[-1] in section.keys


def sections_with(key: str) -> list[KeyPath]:
    """Return the paths of all sections that have a key of this name."""
    return [path for path, node in _sections(_language(), ()) if key in node["properties"]]


def _node(path: KeyPath) -> dict[str, Any]:
    """Return the JSON schema at a path, with references unresolved."""
    node = _language()
    for step in path:
        children = _resolved(node).get("properties", {})
        items = _resolved(node).get("prefixItems", [])
        if isinstance(step, int):
            node = items[step] if step < len(items) else _resolved(node).get("items", {})
        else:
            node = children.get(step, _resolved(node).get("additionalProperties") or {})
    return node


def _sections(node: dict[str, Any], path: KeyPath) -> Iterator[tuple[KeyPath, dict[str, Any]]]:
    node = _resolved(node)
    if "properties" in node:
        yield path, node
        for key, child in node["properties"].items():
            yield from _sections(child, (*path, key))


def _resolved(node: dict[str, Any]) -> dict[str, Any]:
    """Return a schema with its reference resolved and its alternatives merged."""
    if "$ref" in node:
        return _resolved(_language()["$defs"][node["$ref"].rpartition("/")[2]])
    options = [_resolved(option) for option in (*node.get("anyOf", ()), *node.get("oneOf", ()))]
    merged: dict[str, Any] = {}
    for option in options:
        if option.get("type") != "null":
            merged |= {key: _joined(merged.get(key), value) for key, value in option.items()}
    if len({option.get("type") for option in options} - {"null"}) > 1:
        del merged["type"]
    return {**node, **merged}


def _joined(before: Any, value: Any) -> Any:
    """Return one attribute of two alternatives merged: the union of keys and choices, the keys that both require."""
    if isinstance(before, dict) and isinstance(value, dict) and "const" in value:
        return {**value, "enum": list(dict.fromkeys((*_choices(before), *_choices(value))))}
    if isinstance(before, dict) and isinstance(value, dict):
        return {
            **{key: _joined(item, value.get(key, item)) for key, item in before.items()},
            **{key: item for key, item in value.items() if key not in before},
        }
    return value


def _choices(schema: dict[str, Any]) -> list[Any]:
    return schema.get("enum", [schema["const"]] if "const" in schema else [])


@cache
def _language() -> dict[str, Any]:
    return InfantKeys.model_json_schema()


on_recompose(_language.cache_clear)
