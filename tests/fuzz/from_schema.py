"""Values drawn from a JSON Schema: each is valid where it stands, and many together."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from fuzz.mutations import pick

OMITTED = object()
"""What a hint gives for a key that is to be left out."""
FULL = 0.35
"""How often a key is there that may be left out."""
MOST_ITEMS = 3

Hints = Mapping[str, Callable[[np.random.Generator], Any]]
"""What draws the value of a key of some name, which the schema alone says too little of."""


@dataclass(frozen=True)
class Drawing:
    """Draws values by chance."""

    schema: Mapping[str, Any]
    """The whole schema."""
    hints: Hints
    generator: np.random.Generator

    def value(self, node: Mapping[str, Any] | None = None) -> Any:
        """Return a value that fits a node of the schema, by default all of it."""
        node = self.resolved(self.schema if node is None else node)
        if "const" in node:
            return node["const"]
        if "enum" in node:
            return pick(self.generator, node["enum"])
        if options := node.get("oneOf") or node.get("anyOf"):
            return self.value(pick(self.generator, options))
        return getattr(self, f"_{node.get('type', 'string')}")(node)

    def resolved(self, node: Mapping[str, Any]) -> Mapping[str, Any]:
        """Return a node of the schema, that which it refers to."""
        return self.schema["$defs"][node["$ref"].rpartition("/")[2]] if "$ref" in node else node

    def _object(self, node: Mapping[str, Any]) -> dict[str, Any]:
        known, needed = node.get("properties", {}), node.get("required", ())
        drawn = {}
        for key, inner in known.items():
            if key in needed or self.generator.random() < FULL:
                drawn[key] = self.hints[key](self.generator) if key in self.hints else self.value(inner)
        more = node.get("additionalProperties")
        if names := node.get("propertyNames", {}).get("enum"):
            for _ in range(self.generator.integers(MOST_ITEMS)):
                drawn[pick(self.generator, names)] = self.value(more)
        return {key: value for key, value in drawn.items() if value is not OMITTED}

    def _array(self, node: Mapping[str, Any]) -> list[Any]:
        if "prefixItems" in node:
            drawn = [self.value(item) for item in node["prefixItems"]]
            return sorted(drawn) if all(isinstance(value, (int, float)) for value in drawn) else drawn
        most = min(MOST_ITEMS, node.get("maxItems", MOST_ITEMS))
        drawn = [self.value(node["items"]) for _ in range(self.generator.integers(1, most + 1))]
        return [value for number, value in enumerate(drawn) if value not in drawn[:number]]

    def _number(self, node: Mapping[str, Any]) -> float:
        low = node.get("minimum", node.get("exclusiveMinimum", 0.0))
        return round(float(self.generator.uniform(low, node.get("maximum", low + 1))), 3)

    def _integer(self, node: Mapping[str, Any]) -> int:
        low = node.get("minimum", 0)
        return int(self.generator.integers(low, min(node.get("maximum", low + 9), low + 9) + 1))

    def _boolean(self, _: Mapping[str, Any]) -> bool:
        return bool(self.generator.random() < 0.5)

    def _string(self, node: Mapping[str, Any]) -> str:
        return pick(self.generator, node.get("examples", ("small", "one_more")))
