"""What is printed of an infant with a prefix to all its names, so that several infants fit into one model."""

from collections.abc import Sequence
from dataclasses import fields, is_dataclass, replace
from types import MappingProxyType
from typing import Any, TypeVar

from mimoc.compiler.mjcf.furniture import PrintedSkin
from mimoc.compiler.mjcf.scene import SceneTree
from mimoc.compiler.mjcf.skin import Skin, SkinLayer

Part = TypeVar("Part")
NAMES = frozenset(("name", "joint", "body", "site", "material", "texture"))
"""Fields that hold a name, or None."""
LISTS_OF_NAMES = frozenset(("free_joints", "excluded", "frictionless"))
"""Fields that hold names, or tuples of names."""
SHARED = frozenset(("world", "solver"))
"""Fields of a scene with nothing of an infant's own."""


def prefixed_scene(scene: SceneTree, prefix: str) -> SceneTree:
    """Return an infant, its world as it is, whose names all begin with a prefix; equal pictures are shared files."""
    renamed = prefixed(replace(scene, name="", skin=None), prefix)
    if scene.skin is None:
        return replace(renamed, name=scene.name, prefix=prefix)
    skin = _prefixed_skin(scene.skin, prefix)
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
        renamed = {file: file.replace("assets/", f"assets/{scene.prefix}") for file in taken}
        textures, flat_textures = (
            tuple(replace(texture, file=renamed.get(texture.file, texture.file)) for texture in group)
            for group in (looks.textures, looks.flat_textures)
        )
        assets = MappingProxyType({renamed.get(file, file): content for file, content in looks.assets.items()})
        files |= assets
        looks = replace(looks, textures=textures, flat_textures=flat_textures, assets=assets)
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
    if field == "coefficients":  # Of tendons: joints and factors.
        return tuple((prefix + joint, factor) for joint, factor in value)
    if field == "names":  # Attributes that refer to something.
        return tuple((attribute, prefix + name) for attribute, name in value)
    if isinstance(value, tuple):
        return tuple(prefixed(item, prefix) if is_dataclass(item) else item for item in value)
    return prefixed(value, prefix) if is_dataclass(value) else value


def _prefixed_skin(skin: Skin, prefix: str) -> Skin:
    def layers() -> tuple[SkinLayer, ...]:
        return tuple(
            replace(layer, name=prefix + layer.name, bones=tuple(prefix + bone for bone in layer.bones))
            for layer in skin.layers
        )

    return Skin(tuple(prefix + name for name in skin.names), layers, lambda: skin.moves)
