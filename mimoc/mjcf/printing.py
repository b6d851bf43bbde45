"""From a scene to text: templates and number formats, and the one place where floats are rounded."""

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from json.encoder import encode_basestring
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from lxml import etree

from mimoc.mjcf.tree import SceneTree

SIGNIFICANT_DIGITS = 9
"""Enough for any body (a nanometre on a metre), too few to show in which order sums were taken."""

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
    """Return *data* as JSON with sorted keys and rounded numbers, a list of numbers on one line.

    It takes a third of the time of `json.dumps` with an indent, on which a build would spend most of its time.

    Raises:
        ValueError: If a number is infinite or not a number.
    """
    return f"{_json(data)}\n".encode()


def _json(data: Any, margin: str = "\n") -> str:
    """Return the JSON of *data*; *margin* begins each line."""
    if isinstance(data, str):
        return encode_basestring(data)
    if isinstance(data, float):
        return _json_number(data)
    if isinstance(data, Mapping):
        inner = f"{margin} "
        return _enclosed("{}", [f"{encode_basestring(key)}: {_json(data[key], inner)}" for key in sorted(data)], margin)
    if isinstance(data, (list, tuple)):
        if data and all(type(item) in (float, int) for item in data):
            return f"[{', '.join(map(_json, data))}]"
        return _enclosed("[]", [_json(item, f"{margin} ") for item in data], margin)
    return json.dumps(data)


def _enclosed(brackets: str, items: Sequence[str], margin: str) -> str:
    if not items:
        return brackets
    inner = f"{margin} "
    return f"{brackets[0]}{inner}{f',{inner}'.join(items)}{margin}{brackets[1]}"


def _json_number(number: float) -> str:
    if not math.isfinite(number):
        raise ValueError(f"{number} is not JSON compliant")
    return repr(float(num(number)))


def rounded(data: Any) -> Any:
    """Return plain data with every float rounded as it is in files."""
    if isinstance(data, float):
        return float(num(data))
    if isinstance(data, Mapping):
        return {key: rounded(value) for key, value in data.items()}
    if isinstance(data, (list, tuple)):
        return [rounded(item) for item in data]
    return data


def rounded_array(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return an array with every float rounded as it is in files."""
    if array.dtype.kind != "f":
        return array
    numbers = array.ravel().tolist()
    texts = (f"%.{SIGNIFICANT_DIGITS}g " * len(numbers) % tuple(numbers)).split()
    return np.array(texts, array.dtype).reshape(array.shape) + 0.0


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
