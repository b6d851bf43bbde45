"""The objects in a folder of Toys4K, or of other meshes, and their files."""

import os
import re
import unicodedata
from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from mimoc.base.errors import ToyError, UnknownToysError, suggestion

FORMATS = ("obj", "ply", "glb", "stl")  # Supported formats, in order of preference.
FOLDER_STRUCTURE = "<category>/<category>_<NNN>/*.obj (or .ply, .glb, .stl), or meshes of any name in one folder"

MAX_BYTES = 500 * 10**6  # Maximum size of a mesh file.

_READ_FLAGS = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
"""A pipe is opened without waiting for a writer; not every system has the last two."""

_OBJECT = re.compile(r"(?P<category>[a-z0-9_]{1,56})_[0-9]{1,7}")
_NUMBERED = re.compile("(?P<category>.+)_[0-9]{1,7}")
_VARIABLE = re.compile(r"\$(\w+|\{[^}]*\})", re.ASCII)


@dataclass(frozen=True, slots=True)
class Toys4K:
    """The objects in a folder."""

    root: Path  # The folder, with symbolic links resolved.
    objects: Mapping[str, Path]  # Mesh file of each object, sorted by name.
    categories: Mapping[str, tuple[str, ...]]  # Objects of each category, both sorted.
    linked_away: Mapping[str, Path]  # Symbolic links to meshes that are not below the root; they are not read.


def expand_root(text: str, spec_folder: Path) -> Path:
    """Return the path of a folder in a spec, with `~` and environment variables expanded, relative to the spec.

    Raises:
        ToyError: If a variable is not set, or a user does not exist.
    """
    unset = [name.strip("{}") for name in _VARIABLE.findall(text) if name.strip("{}") not in os.environ]
    if unset:
        raise ToyError(f"'{text}': ${unset[0]} is not set; set it, or write the full path")
    try:
        return spec_folder / Path(os.path.expandvars(text)).expanduser()
    except RuntimeError:
        raise ToyError(f"'{text}': the user does not exist; write the full path") from None


def find_toys(root: Path) -> Toys4K:
    """Return the objects in a folder of either structure; see `FOLDER_STRUCTURE`.

    Raises:
        ToyError: If the folder does not exist, cannot be read, or contains no objects.
    """
    try:
        real = Path(os.path.realpath(root))
        paths = dict[str, Path]()
        for name, path in sorted(_objects_in(real)):
            paths.setdefault(name, path)  # If objects have the same name, the first is kept.
    except (OSError, ValueError) as error:
        where = getattr(error, "filename", None) or root
        reason = getattr(error, "strerror", None) or error
        raise ToyError(f"{where}: cannot be read ({reason}); give the folder that Toys4K was unpacked to") from None
    if not paths:
        raise ToyError(f"{root}: contains no meshes of toys; give a folder with {FOLDER_STRUCTURE}")
    linked_away = {name: path for name, path in paths.items() if not lies_in(path, real)}
    objects = {name: path for name, path in paths.items() if name not in linked_away}
    categories = defaultdict[str, list[str]](list)
    for name in objects:
        categories[category_of(name)].append(name)
    return Toys4K(real, objects, {name: tuple(categories[name]) for name in sorted(categories)}, linked_away)


def choose(toys: Toys4K, subset: Collection[str]) -> tuple[str, ...]:
    """Return the selected objects, sorted: a subset names categories or single objects, and an empty one means all.

    Raises:
        UnknownToysError: If some names do not exist.
        ToyError: If there are no toys.
    """
    if wrong := unknown(toys, subset):
        raise UnknownToysError(wrong)
    if not subset and not toys.objects:
        raise ToyError("\n".join(_linked_away(toys, name) for name in toys.linked_away), next(iter(toys.linked_away)))
    names = {name for chosen in subset for name in toys.categories.get(chosen, (chosen,))}
    return tuple(sorted(names or toys.objects))


def unknown(toys: Toys4K, subset: Collection[str]) -> dict[str, str]:
    """Return what is wrong with each name of a subset that is neither a category nor an object."""
    known = toys.categories.keys() | toys.objects.keys()
    return {name: _reason_against(toys, name) for name in subset if name not in known}


def read_mesh(path: Path, root: Path) -> bytes:
    """Return the content of a mesh file.

    Raises:
        ToyError: If it is not below the root, is empty or too large, or cannot be read; the message is a predicate
            without its subject, the mesh.
    """
    if not lies_in(path, root):
        raise ToyError(f"is a link to a file outside {root}")
    try:
        with open(os.open(path, _READ_FLAGS), "rb") as file:
            content = file.read(MAX_BYTES + 1)
    except OSError as error:
        raise ToyError(f"cannot be read ({error.strerror})") from None
    if not content:
        raise ToyError("is an empty file")
    if len(content) > MAX_BYTES:
        raise ToyError(f"is larger than {MAX_BYTES / 1e6:.0f} MB")
    return content


def category_of(name: str) -> str:
    """Return the category of an object: its name without its number, if it has one."""
    match = _NUMBERED.fullmatch(name)
    return match["category"] if match else name


def is_named_as_toys4k(name: str) -> bool:
    """Return whether the name of an object has the form of those in Toys4K."""
    return _OBJECT.fullmatch(name) is not None


def legible(name: str) -> str:
    """Return the name of a file as printable text, with question marks for other characters."""
    text = name.encode("utf-8", "surrogateescape").decode("utf-8", "replace").replace("\ufffd", "?")
    return "".join(letter if letter.isprintable() else "?" for letter in unicodedata.normalize("NFC", text))


def lies_in(path: Path, root: Path) -> bool:
    """Return whether a file is below a folder, with symbolic links resolved."""
    return Path(os.path.realpath(path)).is_relative_to(root)


def _objects_in(root: Path) -> Iterator[tuple[str, Path]]:
    for entry in _shown(root):
        if entry.is_file() and entry.suffix[1:].lower() in FORMATS:
            lower = entry.stem.lower()
            yield lower if _OBJECT.fullmatch(lower) else legible(entry.stem), entry
        elif entry.is_dir():
            for folder in _shown(entry):
                match = _OBJECT.fullmatch(folder.name.lower())
                if match and match["category"] == entry.name.lower() and (meshes := _meshes_in(folder)):
                    yield folder.name.lower(), meshes[0]


def _meshes_in(folder: Path) -> list[Path]:
    """Return the mesh files of an object, sorted by format preference, then by name."""
    meshes = [path for path in _shown(folder) if path.is_file()] if folder.is_dir() else []
    ranks = {path: FORMATS.index(kind) for path in meshes if (kind := path.suffix[1:].lower()) in FORMATS}
    return sorted(ranks, key=ranks.__getitem__)


def _shown(folder: Path) -> list[Path]:
    return sorted(path for path in folder.iterdir() if not path.name.startswith("."))


def _reason_against(toys: Toys4K, name: str) -> str:
    beyond = [linked for linked in toys.linked_away if name in (linked, category_of(linked))]
    if beyond:
        return _linked_away(toys, beyond[0])
    known = toys.categories.keys() | toys.objects.keys()
    advice = suggestion(name, known)
    if advice.startswith("choose"):  # The list of all objects is too long to help.
        advice = suggestion(name, toys.categories)
    return f"'{name}' is neither a category nor an object in {toys.root}; {advice}"


def _linked_away(toys: Toys4K, name: str) -> str:
    path = toys.linked_away[name].relative_to(toys.root)
    return f"'{name}' ({path}) is a link to a file outside {toys.root}; copy the file there"
