"""The JSON Schema of a kind of files, by which editors complete keys, explain them, and underline mistakes."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from mimoc.base.errors import check_name
from mimoc.schema.base import Model
from mimoc.schema.cohort_file import CohortSpec
from mimoc.schema.infant import InfantSpec
from mimoc.schema.outline import language_of
from mimoc.schema.reading import ONE_OF_SEVERAL
from mimoc.schema.world import WorldSpec

FILES: Mapping[str, tuple[type[Model], str]] = {
    "infant": (InfantSpec, "Infant spec of mimoc"),
    "cohort": (CohortSpec, "Cohort file of mimoc"),
    "world": (WorldSpec, "World file of mimoc"),
}
"""Kinds of files: what describes them, and what they are called."""
ABOUT = ("description", "default")  # Attributes that say something of a value, not which ones there are.
VERSION = 1  # Version of the language: the value of the key `mimoc`.
DIALECT = "https://json-schema.org/draft/2020-12/schema"
NOTHING = {"type": "null"}  # What pydantic lets optional keys be; a file leaves them out instead.


def json_schema(of: str = "infant") -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of a kind of files, one of FILES, with the kinds of plug-ins.

    It says what each key may be by itself. What keys must be together, and what a body can be, only mimoc knows.

    Raises:
        UnknownNameError: If there are no such files.
    """
    check_name("kind of files", of, FILES)
    keys, title = FILES[of]
    schema = {"$schema": DIALECT, **_stricter(language_of(keys).schema), "title": title}
    if of == "infant":
        for section in schema["$defs"].values():
            section.get("properties", {}).pop(ONE_OF_SEVERAL, None)
    return schema


def shipped_schema(of: str = "infant") -> Path:
    """Return the file with the JSON Schema of a kind of files that comes with mimoc, without the kinds of plug-ins."""
    return Path(__file__).with_name("json") / f"{of}-{VERSION}.schema.json"


def json_text(schema: Mapping[str, Any]) -> str:
    """Return a JSON Schema as text."""
    return json.dumps(schema, indent=1, sort_keys=True, ensure_ascii=False) + "\n"


def _stricter(node: Any) -> Any:
    """Return a node of a schema without what files must not say, and what no editor shows."""
    if isinstance(node, list):
        return [_stricter(item) for item in node]
    if not isinstance(node, Mapping):
        return node
    stricter = {key: _stricter(value) for key, value in node.items() if not _is_noise(key, value)}
    about = {key: _flowing(stricter.pop(key)) for key in ABOUT if key in stricter}
    options = [option for option in stricter.pop("anyOf", ()) if option != NOTHING]
    if "also" in stricter:
        also = stricter.pop("also")
        return {**about, "anyOf": [stricter, also]}
    return {**about, **(options[0] if len(options) == 1 else {"anyOf": options} if options else {}), **stricter}


def _is_noise(key: str, value: Any) -> bool:
    """Return whether an attribute of a schema repeats its key, is for pydantic or mimoc only, or says nothing."""
    if isinstance(value, str):
        return key in ("title", "wanted")
    return key == "discriminator" or (key == "default" and value is None)


def _flowing(text: Any) -> Any:
    """Return a description with paragraphs instead of lines."""
    if not isinstance(text, str):
        return text
    return "\n\n".join(" ".join(paragraph.split()) for paragraph in text.split("\n\n"))
