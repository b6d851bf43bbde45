"""Queries of the language of a kind of files: which keys and values are allowed at a path."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

from mimoc.schema.base import KeyPath, Model, on_recompose

NO_KINDS: Mapping[KeyPath, str] = {}


@dataclass(frozen=True)
class Outline:
    """Description of one value of the spec language."""

    schema: dict[str, Any]  # Its JSON schema.
    unit: str | None = None  # Its unit or that of its items, as written in suffixes of names.

    @property
    def type(self) -> str:
        """Its JSON type, or empty if there are several."""
        return self.schema.get("type", "")

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


@dataclass(frozen=True)
class Language:
    """The keys and values that files of one kind may have."""

    schema: dict[str, Any]  # The JSON schema of a file.

    def outline(self, path: KeyPath, kinds: Mapping[KeyPath, str] = NO_KINDS) -> Outline:
        """Return the description of the value at a path, which is empty for an unknown path.

        Args:
            path: The keys that lead to it.
            kinds: Of sections on the way that can be of several kinds, which they are; of others, all are merged.
        """
        first = schema = self._resolved(self._node(path, kinds))
        while "prefixItems" in first:
            first = self._resolved(first["prefixItems"][0])
        return Outline(schema, first.get("unit"))

    def kinds_of(self, path: KeyPath) -> dict[str, Outline]:
        """Return the alternative sections at a path, by the value of their discriminator; empty for most paths."""
        return self._kinds(self._node(path))

    def _kinds(self, node: dict[str, Any]) -> dict[str, Outline]:
        unions = [option for option in (node, *node.get("anyOf", ())) if "discriminator" in option]
        return {
            name: Outline(self._resolved({"$ref": reference}))
            for union in unions
            for name, reference in union["discriminator"].get("mapping", {}).items()
        }

    def is_known(self, path: KeyPath) -> bool:
        """Return whether a path is that of an item, of a known key, or of a section in which any key is allowed."""
        section = self.outline(path[:-1])
        return not section.keys or path[-1] in section.keys

    def sections_with(self, key: str) -> list[KeyPath]:
        """Return the paths of all sections that have a key of this name."""
        return [path for path, node in self._sections(self.schema, ()) if key in node["properties"]]

    def _node(self, path: KeyPath, kinds: Mapping[KeyPath, str] = NO_KINDS) -> dict[str, Any]:
        """Return the JSON schema at a path, with references unresolved."""
        node = self.schema
        for depth, step in enumerate(path):
            kind = self._kinds(node).get(kinds.get(path[:depth], ""))
            node = kind.schema if kind else node
            children = self._resolved(node).get("properties", {})
            items = self._resolved(node).get("prefixItems", [])
            if isinstance(step, int):
                node = items[step] if step < len(items) else self._resolved(node).get("items", {})
            else:
                node = children.get(step, self._resolved(node).get("additionalProperties") or {})
        return node

    def _sections(self, node: dict[str, Any], path: KeyPath) -> Iterator[tuple[KeyPath, dict[str, Any]]]:
        node = self._resolved(node)
        if "properties" in node:
            yield path, node
            for key, child in node["properties"].items():
                yield from self._sections(child, (*path, key))

    def _resolved(self, node: dict[str, Any]) -> dict[str, Any]:
        """Return a schema with its reference resolved and its alternatives merged."""
        if "$ref" in node:
            return self._resolved(self.schema["$defs"][node["$ref"].rpartition("/")[2]])
        options = [self._resolved(option) for option in (*node.get("anyOf", ()), *node.get("oneOf", ()))]
        merged: dict[str, Any] = {}
        for option in options:
            if option.get("type") != "null":
                merged |= {key: _joined(merged.get(key), value) for key, value in option.items()}
        if len({option.get("type") for option in options} - {"null"}) > 1:
            merged.pop("type", None)
        return {**node, **merged}


@cache
def language_of(keys: type[Model]) -> Language:
    """Return what the files may say that a model describes."""
    return Language(keys.model_json_schema())


on_recompose(language_of.cache_clear)


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
