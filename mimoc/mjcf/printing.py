"""From a scene to MJCF text, by templates."""

from functools import cache
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from lxml import etree

from mimoc.mjcf.scene import SceneTree
from mimoc.rounding import num

TEMPLATES = Path(__file__).parents[1] / "templates"


def render_scene(scene: SceneTree) -> dict[str, bytes]:
    """Return the MJCF and assets of a scene, by path in the bundle."""
    return {**render_infant(scene), **render_world(scene)}


def render_infant(scene: SceneTree) -> dict[str, bytes]:
    """Return the MJCF and assets of the infant alone."""
    skin = scene.skin.files if scene.skin else {}
    return {"infant.xml": _indented(render_text("infant.xml.j2", scene=scene)), **scene.appearance.assets, **skin}


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
