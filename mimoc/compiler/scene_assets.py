"""The toys and wallpapers that scenes choose from, mimoc's and the user's, read once for all seeds."""

from dataclasses import dataclass
from pathlib import Path

from mimoc.errors import SpecError, TextureError, ToyError, UnknownToysError
from mimoc.kinds import function_of
from mimoc.looks.own_textures import read_textures
from mimoc.looks.wallpaper import CEILINGS, FLOORS, OWN_WALLPAPERS, WALLS, Wallpaper, Wallpapers
from mimoc.schema.infant import InfantSpec, as_written
from mimoc.schema.source import Source
from mimoc.toys import TOY_SOURCES
from mimoc.toys.builtin import BUILTIN_TOYS
from mimoc.toys.choosing import Toybox
from mimoc.toys.spec import ToysSpec


@dataclass(frozen=True, slots=True)
class SceneAssets:
    """The toys and wallpapers that scenes choose from."""

    wallpapers: Wallpapers = OWN_WALLPAPERS
    """Wallpapers for floors, ceilings and walls."""
    toybox: Toybox = BUILTIN_TOYS
    """The toys to choose from."""


def load_scene_assets(spec: InfantSpec) -> SceneAssets:
    """Return the toys and wallpapers for the scenes of a spec.

    Args:
        spec: The spec; paths are relative to the folder of its file, and problems are located in this.

    Raises:
        SpecError: If a toy or a texture is missing or cannot be read.
    """
    if spec.scene.toys is None and not any(path for _, path in spec.scene.textures):
        return SceneAssets()
    written = as_written(spec)
    folder = written.folder
    wallpapers = Wallpapers(
        floors=(*FLOORS.values(), *_own("floor", spec, written, folder)),
        ceilings=(*CEILINGS.values(), *_own("ceiling", spec, written, folder)),
        walls=(*WALLS.values(), *_own("wall", spec, written, folder)),
    )
    if spec.scene.toys is None:
        return SceneAssets(wallpapers)
    return SceneAssets(wallpapers, _toybox(spec.scene.toys, written))


def _toybox(toys: ToysSpec, written: Source) -> Toybox:
    try:
        return function_of(TOY_SOURCES[toys.source].build, "build")(toys, written.folder)
    except UnknownToysError as error:
        places = {name: ("scene", "toys", "subset", toys.subset.index(name)) for name in error.messages}
        raise SpecError(written.problem(places[name], text) for name, text in error.messages.items()) from None
    except ToyError as error:
        problems = str(error).splitlines()
        raise SpecError(written.problem(("scene", "toys", "root"), problem) for problem in problems) from None


def _own(kind: str, spec: InfantSpec, written: Source, folder: Path) -> tuple[Wallpaper, ...]:
    path = getattr(spec.scene.textures, kind)
    if path is None:
        return ()
    try:
        return read_textures(folder / Path(path).expanduser())
    except TextureError as error:
        problems = str(error).splitlines()
        raise SpecError(written.problem(("scene", "textures", kind), problem) for problem in problems) from None
