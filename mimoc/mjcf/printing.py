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
    infant = render_infant(scene)
    return {**infant, **render_world(scene, infant["infant.xml"])}


def render_infant(scene: SceneTree) -> dict[str, bytes]:
    """Return the MJCF and assets of the infant alone."""
    skin = scene.skin.files if scene.skin else {}
    return {
        "infant.xml": _indented(_parsed(render_text("infant.xml.j2", scene=scene))),
        **scene.appearance.assets,
        **skin,
    }


def render_world(scene: SceneTree, infant: bytes) -> dict[str, bytes]:
    """Return the MJCF of an infant in its world, and the assets of the world.

    An infant with a skin is not included from its own file but printed again: dm_control reads no `<skin>` of a file
    that another one includes.

    Args:
        scene: Both.
        infant: The MJCF of the infant alone, as printed.
    """
    whole = _parsed(render_text("scene.xml.j2", scene=scene))
    if scene.skin:
        whole = _with_included(whole, _parsed(infant))
    return {"scene.xml": _indented(whole), **scene.world.assets}


def _with_included(including: etree._Element, included: etree._Element) -> etree._Element:
    """Return MJCF in which the one `<include>`, which comes first, is replaced by the elements of its file."""
    included.attrib.update(including.attrib)
    for section in including[1:]:
        same = included.find(section.tag)
        if same is None:
            included.append(section)
        else:
            same.attrib.update(section.attrib)
            same.extend(section)
    return included


def render_text(template: str, **values: Any) -> bytes:
    """Return a text file of the bundle from its template."""
    return environment().get_template(template).render(**values).encode()


def _parsed(xml: bytes) -> etree._Element:
    """Return the elements of XML, without the blanks between them."""
    return etree.fromstring(xml, etree.XMLParser(remove_blank_text=True))


def _indented(root: etree._Element) -> bytes:
    """Return XML with each element on a line of its own, indented by its depth."""
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
