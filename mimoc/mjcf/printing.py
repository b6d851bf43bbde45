"""From a scene to text: templates and number formats, and the one place where floats are rounded."""

import json
import re
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from lxml import etree

from mimoc.mjcf.scene import SceneTree

SIGNIFICANT_DIGITS = 9
"""Enough for any body (a nanometre on a metre), too few to show in which order sums were taken."""

NUMBERS = re.compile(r"\[\n([-+.,\d\seE]+)\]")
"""A list of numbers as JSON spreads it over lines; no text in JSON has line breaks."""

TEMPLATES = Path(__file__).parents[1] / "templates"


def render_scene(scene: SceneTree) -> dict[str, bytes]:
    """Return the MJCF and assets of a scene, by path in the bundle."""
    return {**render_infant(scene), **render_world(scene)}


def render_infant(scene: SceneTree) -> dict[str, bytes]:
    """Return the MJCF and assets of the infant alone."""
    return {"infant.xml": _indented(render_text("infant.xml.j2", scene=scene)), **scene.appearance.assets}


def render_world(scene: SceneTree) -> dict[str, bytes]:
    """Return the MJCF and assets of what is around the infant."""
    return {"scene.xml": _indented(render_text("scene.xml.j2", scene=scene)), **scene.world.assets}


def render_text(template: str, **values: Any) -> bytes:
    """Return a text file of the bundle from its template."""
    return environment().get_template(template).render(**values).encode()


def _indented(xml: bytes) -> bytes:
    """Return XML with each element on a line of its own, indented by its depth."""
    root = etree.fromstring(xml, etree.XMLParser(remove_blank_text=True))
    etree.indent(root)
    return etree.tostring(root, encoding="utf-8") + b"\n"


def render_json(data: Any) -> bytes:
    """Return *data* as JSON with sorted keys and rounded numbers, a list of numbers on one line."""
    return f"{_json(data)}\n".encode()


def json_members(data: Mapping[str, Any]) -> dict[str, str]:
    """Return the text of each member of an object in JSON, for `join_json`: it can be kept while others change."""
    return {key: _json({key: value})[2:-2] for key, value in data.items()}


def join_json(members: Mapping[str, str]) -> bytes:
    """Return the object that some members make, as `render_json` would have it."""
    return "{{\n{}\n}}\n".format(",\n".join(members[key] for key in sorted(members))).encode()


def _json(data: Any) -> str:
    text = json.dumps(rounded(data), indent=1, sort_keys=True, ensure_ascii=False, allow_nan=False)
    return NUMBERS.sub(lambda numbers: f"[{' '.join(numbers[1].split())}]", text)


def rounded(data: Any) -> Any:
    """Return plain data with every float rounded as it is in files."""
    if isinstance(data, float):
        return float(num(data))
    if isinstance(data, Mapping):
        return {key: rounded(value) for key, value in data.items()}
    if isinstance(data, (list, tuple)):
        return [rounded(item) for item in data]
    return data


def num(value: float | bool | Iterable[float]) -> str:
    """Return a number, or several with blanks between, as MJCF wants them; booleans as true and false."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return f"{value + 0.0:.{SIGNIFICANT_DIGITS}g}"  # + 0.0 turns -0.0 into 0.
    return " ".join(num(item) for item in value)


@cache
def environment() -> Environment:
    """Return the environment of the templates: strict, escaped for XML, with one filter."""
    found = Environment(
        loader=FileSystemLoader(TEMPLATES),
        undefined=StrictUndefined,
        autoescape=lambda name: name is not None and name.endswith(".xml.j2"),
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    found.filters["num"] = num
    return found
