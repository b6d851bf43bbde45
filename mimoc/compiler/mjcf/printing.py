"""From a scene to MJCF text, by templates."""

import math
import pickle
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import fields, is_dataclass, replace
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any, TypeVar

import platformdirs
from jinja2 import Environment, FileSystemBytecodeCache, FileSystemLoader, StrictUndefined
from jinja2.bccache import Bucket
from lxml import etree

from mimoc.base.rounding import MIN_NORMAL, SIGNIFICANT_DIGITS
from mimoc.compiler.mjcf.elements import PrintedSkin
from mimoc.compiler.mjcf.scene import Keyframe, SceneTree, Skin, SkinLayer
from mimoc.compiler.mjcf.world import World

TEMPLATES = Path(__file__).parents[2] / "templates"
INFANT = "infant.xml"


def render_scene(scene: SceneTree) -> dict[str, bytes]:
    """Return the MJCF and assets of a scene, by path in the bundle."""
    files = render_infant(scene)
    return {**files, **render_world(scene, render_inhabitant(scene) if scene.skin else files[INFANT])}


def render_infant(scene: SceneTree) -> dict[str, bytes]:
    """Return the MJCF of the infant alone, with its solids shown instead of its skin, and its assets.

    MuJoCo attaches skins to other models from 3.17 on, and dm_control includes and copies none.
    """
    skin = scene.skin.files if scene.skin else {}
    return {INFANT: render_inhabitant(scene.without_skin), **scene.appearance.assets, **skin}


def render_inhabitant(scene: SceneTree) -> bytes:
    """Return the MJCF of the infant as it is in its world: with its skin."""
    return _indented(_parsed(render_text("infant.xml.j2", scene=scene)))


def render_world(scene: SceneTree, inhabitant: bytes) -> dict[str, bytes]:
    """Return the MJCF of an infant in its world, and the assets of the world.

    It includes the file of the infant alone, unless the infant has a skin; then it is complete by itself, from what
    `render_inhabitant` returned.
    """
    whole = _parsed(render_text("scene.xml.j2", scene=scene))
    if scene.skin:
        whole = _with_included(whole, _parsed(inhabitant))
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


COMMON = ("compiler", "option", "size")  # Sections that are the same of all infants in one world.


def render_infants(
    name: str, infants: Sequence[SceneTree], world: World, keyframes: Sequence[Keyframe]
) -> dict[str, bytes]:
    """Return the MJCF of several infants in one world, which is complete by itself, and all assets.

    The infants have names that differ (`prefixed_scene`), and the same options; *keyframes* are states of all of them.

    """
    infants = with_pictures_apart(infants)
    first, *others = (_parsed(render_inhabitant(infant)) for infant in infants)
    for other in others:
        for section in other:
            same = first.find(section.tag)
            if same is not None and section.tag not in COMMON:
                same.extend(section)
    scene = replace(infants[0], name=name, world=world, keyframes=tuple(keyframes))
    whole = _with_included(_parsed(render_text("scene.xml.j2", scene=scene)), first)
    files = {"scene.xml": _indented(whole), **world.assets}
    for infant in infants:
        files |= {**infant.appearance.assets, **(infant.skin.files if infant.skin else {})}
    return files


def render_text(template: str, **values: Any) -> bytes:
    """Return a text file of the bundle from its template."""
    return environment().get_template(template).render(**values).encode()


def _parsed(xml: bytes) -> etree._Element:
    return etree.fromstring(xml, etree.XMLParser(remove_blank_text=True))


def _indented(root: etree._Element) -> bytes:
    """Return XML with each element on a line of its own, indented by its depth."""
    etree.indent(root)
    return etree.tostring(root, encoding="utf-8") + b"\n"


@cache
def environment() -> Environment:
    """Return the environment of the templates: strict, escaped for XML, with two filters."""
    result = Environment(
        loader=FileSystemLoader(TEMPLATES),
        undefined=StrictUndefined,
        autoescape=lambda name: name is not None and name.endswith(".xml.j2"),
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        bytecode_cache=CompiledTemplates(str(platformdirs.user_cache_path("mimoc") / f"jinja2-{version('jinja2')}")),
    )
    result.filters |= {"num": num, "rad": rad}
    return result


def num(value: float | bool | Iterable[float]) -> str:
    """Return a number, or several with blanks between, as MJCF wants them; booleans as true and false.

    Numbers below the smallest normal float are zero: MuJoCo reads none of them.
    """
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return f"{0.0 if -MIN_NORMAL < value < MIN_NORMAL else value:.{SIGNIFICANT_DIGITS}g}"  # Also of -0.0.
    return " ".join(num(item) for item in value)


def rad(value_deg: float | Iterable[float]) -> str:
    """Return an angle, or several, given in degrees, as MJCF wants them in radians."""
    return num(math.radians(value_deg) if isinstance(value_deg, (int, float)) else map(math.radians, value_deg))


class CompiledTemplates(FileSystemBytecodeCache):
    """Compiled templates in the user's own cache folder; compiling them takes longer than printing an infant.

    A folder that cannot be read or written, or a damaged file, only costs that time.
    """

    def load_bytecode(self, bucket: Bucket) -> None:
        """Read a compiled template, if it is there and whole."""
        try:
            super().load_bytecode(bucket)
        except (OSError, EOFError, ValueError, TypeError, pickle.UnpicklingError):
            bucket.reset()

    def dump_bytecode(self, bucket: Bucket) -> None:
        """Write a compiled template, if the folder can be written."""
        with suppress(OSError):
            Path(self.directory).mkdir(mode=0o700, parents=True, exist_ok=True)
            super().dump_bytecode(bucket)


Part = TypeVar("Part")
NAMES = frozenset(("name", "joint", "body", "site", "material", "texture"))  # Fields that hold a name, or None.
LISTS_OF_NAMES = frozenset(("free_joints", "excluded", "frictionless"))  # Fields that hold names, or tuples of names.
SHARED = frozenset(("world", "solver"))  # Fields of a scene with nothing of an infant's own.


def prefixed_scene(scene: SceneTree, prefix: str) -> SceneTree:
    """Return an infant, its world as it is, whose names all begin with a prefix; equal pictures are shared files."""
    renamed = prefixed(replace(scene, name="", skin=None), prefix)
    if (own := scene.skin) is None:
        return replace(renamed, name=scene.name, prefix=prefix)

    def layers() -> tuple[SkinLayer, ...]:
        return tuple(
            replace(layer, name=prefix + layer.name, bones=tuple(prefix + bone for bone in layer.bones))
            for layer in own.layers
        )

    skin = Skin(tuple(prefix + name for name in own.names), layers, lambda: own.moves)
    return replace(renamed, name=scene.name, prefix=prefix, skin=skin)


def with_pictures_apart(scenes: Sequence[SceneTree]) -> list[SceneTree]:
    """Return infants with prefixes such that no two have different pictures in one file.

    The second infant that would have `assets/eye.png`, of other colours, has `assets/ben_eye.png`.
    """
    files: dict[str, bytes] = {}
    apart = []
    for scene in scenes:
        looks = scene.appearance
        taken = {file for file, content in looks.assets.items() if files.get(file, content) != content}
        textures, flat_textures = (
            tuple(
                replace(texture, file=texture.file.replace("assets/", f"assets/{scene.prefix}"))
                if texture.file in taken
                else texture
                for texture in group
            )
            for group in (looks.textures, looks.flat_textures)
        )
        looks = replace(looks, textures=textures, flat_textures=flat_textures)
        files |= looks.assets
        apart.append(replace(scene, appearance=looks))
    return apart


def prefixed(part: Part, prefix: str) -> Part:
    """Return something that is printed, such as a lock or a ball, with a prefix to its names and those in it."""
    part_of_model: Any = part
    changes = {
        item.name: _renamed(item.name, getattr(part, item.name), prefix)
        for item in fields(part_of_model)
        if item.name not in SHARED
    }
    if isinstance(part, PrintedSkin):
        changes["file"] = skin_file(changes["name"])
    return replace(part_of_model, **changes)


def skin_file(layer: str) -> str:
    """Return the path of the file of a layer of skin inside a bundle."""
    return f"assets/{layer}.skn"


def _renamed(field: str, value: Any, prefix: str) -> Any:
    if field in NAMES:
        return prefix + value if value else value
    if field in LISTS_OF_NAMES:
        return tuple(
            prefix + item if isinstance(item, str) else tuple(prefix + name for name in item) for item in value
        )
    if field == "coefficients":  # Joints of tendons, and their factors.
        return tuple((prefix + joint, factor) for joint, factor in value)
    if field == "names":  # Attributes that refer to something.
        return tuple((attribute, prefix + name) for attribute, name in value)
    if isinstance(value, tuple):
        return tuple(prefixed(item, prefix) if is_dataclass(item) else item for item in value)
    return prefixed(value, prefix) if is_dataclass(value) else value
