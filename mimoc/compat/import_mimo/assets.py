"""The files that a scene refers to, and which textures, materials and meshes of it are the infant's alone."""

import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path, PurePosixPath

import mujoco

from mimoc.base.errors import Problem, SpecError
from mimoc.bundle.asset_check import MOST_PIXELS, pixels_of
from mimoc.bundle.regular_files import MOST_BYTES, MOST_BYTES_IN_ALL, UnusableFileError
from mimoc.compat.import_mimo.reading import ATTACHES, Element, first_existing, read_file

FOLDERS = ("assetdir", "meshdir", "texturedir", "strippath")
"""Attributes of `compiler` that say where files are; those of the new scene are all in one folder."""
USES = ("material", "texture", "mesh", "hfield")  # Attributes that name an asset.
COLOUR = {"builtin": "flat", "width": "1", "height": "1"}


def file_attributes(element: Element) -> list[str]:
    """Return the attributes of an element that name files; a cube's texture has up to six of them."""
    return [name for name in element.attributes if name.startswith("file")]


def without_pictures(tree: Element) -> Element:
    """Return a scene whose textures are plain colours: its physics, which needs none of their files."""
    attributes, children = tree.attributes, [without_pictures(child) for child in tree.children]
    if tree.tag == "texture" and (names := file_attributes(tree)):
        attributes = {name: value for name, value in attributes.items() if name not in names} | COLOUR
    return Element(tree.tag, attributes, tree.file, tree.line, children)


class AssetFiles:
    """Reads the files of assets, and gives each a name of its own in one folder."""

    def __init__(self, tree: Element, folder: Path):
        self._folder = folder
        self._settings = {
            name: value
            for compiler in tree.children
            if compiler.tag == "compiler"
            for name, value in compiler.attributes.items()
        }
        self._names = dict[Path, str]()
        self._left, self._pixels_left = MOST_BYTES_IN_ALL, MOST_PIXELS
        self.files: dict[str, bytes] = {}
        """Content by name."""
        self.sources: set[Path] = set()

    def moved(self, tree: Element, place: str = "") -> Element:
        """Return elements whose files are in the folder *place*, and read these; a SpecError lists all missing ones."""
        problems: list[Problem] = []
        result = self._moved(tree, place, problems)
        if problems:
            raise SpecError(problems)
        return result

    def _moved(self, element: Element, place: str, problems: list[Problem]) -> Element:
        attributes = dict(element.attributes)
        if element.tag == "compiler":
            attributes = {name: value for name, value in attributes.items() if name not in FOLDERS}
        if element.tag == "model" and element.get("file"):
            problems.append(element.problem(ATTACHES))
            return element
        for name in file_attributes(element):
            path = self._path(element, attributes[name])
            try:
                attributes[name] = place + self._name(path, element.tag in ("texture", "hfield"))
            except UnusableFileError as error:
                problems.append(element.problem(f"the file '{path}' {error}"))
        children = [self._moved(child, place, problems) for child in element.children]
        return Element(element.tag, attributes, element.file, element.line, children)

    def _path(self, element: Element, name: str) -> Path:
        """Return where MuJoCo finds a file of a kind of asset: as seen from the scene, or else from what names it."""
        kind = "texturedir" if element.tag == "texture" else "meshdir"
        place = self._settings.get(kind) or self._settings.get("assetdir", "")
        strips = self._settings.get("strippath") in ("true", "1")
        name = PurePosixPath(name).name if strips else name
        beside = os.path.relpath(Path(element.file).parent, self._folder)
        return first_existing(self._folder / place / name, self._folder / place / beside / name)

    def _name(self, path: Path, is_picture: bool) -> str:
        if path not in self._names:
            content = read_file(path, min(MOST_BYTES, self._left))
            self._left -= len(content)
            if is_picture and path.suffix.lower() == ".png":
                self._pixels_left -= pixels_of(content, is_ours=False)
                if self._pixels_left < 0:
                    raise UnusableFileError(f"and others have more than {MOST_PIXELS:,} pixels together")
            taken, number = set(self._names.values()), 1
            name = path.name
            while name in taken:
                number += 1
                name = f"{path.stem}_{number}{path.suffix}"
            self._names[path] = name
            self.files[name] = content
            self.sources.add(path.resolve())
        return self._names[path]


def used_assets(elements: Iterable[Element]) -> set[tuple[str, str]]:
    """Return kind and name of the assets that elements use, such as the texture of a material."""
    return {use for element in elements for part in element.walk() for use in _uses(part)}


def _uses(element: Element) -> Iterator[tuple[str, str]]:
    kinds: Mapping[str, str] = {"layer": "texture"}
    for name in USES:
        if value := element.get(name):
            yield name, value
    if element.tag in kinds:
        yield kinds[element.tag], element.get("texture")


def asset_name(element: Element) -> tuple[str, str]:
    """Return kind and name of an asset, which MuJoCo names after its file if it has no name."""
    return element.tag, element.get("name") or PurePosixPath(element.get("file")).stem


def split_assets(
    assets: list[Element], used: set[tuple[str, str]], infants: set[tuple[str, str]]
) -> tuple[list[Element], list[Element]]:
    """Return the assets that the rest of a scene *used*, and those that only the infant has, by kind and name."""
    by_name = {asset_name(asset): asset for asset in assets}
    wanted = _with_textures(used, by_name)
    only = _with_textures(infants, by_name) - wanted
    of_others = _with_textures({name for name in by_name if name not in only}, by_name)
    dropped = [asset for asset in assets if asset_name(asset) in only - of_others]
    return [asset for asset in assets if asset not in dropped], dropped


def _with_textures(names: set[tuple[str, str]], by_name: Mapping[tuple[str, str], Element]) -> set[tuple[str, str]]:
    return names | used_assets(by_name[name] for name in names if name in by_name)


KINDS: Mapping[str, str] = {
    **dict.fromkeys(("body", "body1", "body2"), "body"),
    **dict.fromkeys(("joint", "joint1", "joint2", "jointinparent"), "joint"),
    **dict.fromkeys(("geom", "geom1", "geom2"), "geom"),
    **dict.fromkeys(("site", "site1", "site2", "refsite", "slidersite", "cranksite", "sidesite"), "site"),
    **dict.fromkeys(("tendon", "tendon1", "tendon2"), "tendon"),
    "target": "body",
    "actuator": "actuator",
    "camera": "camera",
}
"""Kind of what an attribute names."""
TYPED = {"objname": "objtype", "refname": "reftype"}  # Attributes that name something, and those with its kind.
SAME = {"xbody": "body", "freejoint": "joint"}  # Kind of what has another word.
LISTS = ("flex", "skin")  # Elements whose attributes of these names are lists.
Names = dict[str, set[str]]


def names_in_model(model: mujoco.MjModel) -> Names:
    """Return the names in a compiled model, by kind."""
    counts = {
        "body": model.nbody,
        "joint": model.njnt,
        "geom": model.ngeom,
        "site": model.nsite,
        "camera": model.ncam,
        "tendon": model.ntendon,
        "actuator": model.nu,
        "sensor": model.nsensor,
        "material": model.nmat,
        "texture": model.ntex,
    }
    return {kind: {getattr(model, kind)(index).name for index in range(count)} for kind, count in counts.items()}


def names_in(sections: list[Element], names: Names) -> Names:
    """Return *names* and those of what is in the sections of a scene, by kind."""
    result = {kind: set(of_kind) for kind, of_kind in names.items()}
    for section in sections:
        for element in section.walk() if section.tag in ("worldbody", "tendon", "actuator") else ():
            kind = SAME.get(element.tag, element.tag) if section.tag == "worldbody" else section.tag
            if element.get("name") and kind in result:
                result[kind].add(element.get("name"))
    return result


def references(element: Element) -> Iterator[tuple[str, str]]:
    """Yield the attributes of an element, but not of those below it, that name something, and of which kind."""
    for name in element.attributes:
        if name in TYPED:
            kind = element.get(TYPED[name])
            yield name, SAME.get(kind, kind)
        elif name in KINDS and element.tag not in LISTS:
            yield name, KINDS[name]


def resolved(element: Element, names: Names, others: Mapping[tuple[str, str], str]) -> tuple[Element, list[str]]:
    """Return an element, with those below it, whose references lead to what has the name now, and what is gone."""
    attributes, missing = dict(element.attributes), list[str]()
    for attribute, kind in references(element):
        name = attributes[attribute]
        new = name if name in names.get(kind, ()) else others.get((kind, name), name)
        attributes[attribute] = new
        if kind in names and new not in names[kind] and new != "world":
            missing.append(f"{kind} '{name}'")
    pairs = [resolved(child, names, others) for child in element.children]
    children, below = [child for child, _ in pairs], [name for _, lost in pairs for name in lost]
    return Element(element.tag, attributes, element.file, element.line, children), missing + below
