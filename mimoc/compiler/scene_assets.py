"""What a scene is made of besides its spec: toys and wallpapers, mimoc's own and the user's."""

from collections.abc import Iterator
from pathlib import Path

from mimoc.compiler.furnish import Supplies
from mimoc.errors import SpecError, TextureError, ToyError, UnknownToysError
from mimoc.kinds import function_of
from mimoc.looks.own_textures import read_textures
from mimoc.looks.wallpaper import CEILINGS, FLOORS, WALLS, Wallpaper
from mimoc.scenes.setting import Decor
from mimoc.scenes.spec import SceneSpec
from mimoc.schema.infant import InfantSpec
from mimoc.schema.source import Source
from mimoc.tasks import TASKS
from mimoc.toys import TOY_SOURCES
from mimoc.toys.choosing import Toybox
from mimoc.toys.spec import ToysSpec


def gather(spec: InfantSpec, written: Source) -> Supplies:
    """Return what a spec's scene is made of.

    Args:
        spec: What is wanted.
        written: Where it was written: paths are seen from there, and problems point there.

    Raises:
        SpecError: If a toy or a picture that it names is not there, or is none.
    """
    folder = written.folder
    decor = Decor(
        floors=(*FLOORS.values(), *_own("floor", spec, written, folder)),
        ceilings=(*CEILINGS.values(), *_own("ceiling", spec, written, folder)),
        walls=(*WALLS.values(), *_own("wall", spec, written, folder)),
    )
    if spec.scene.toys is None:
        return Supplies(decor)
    return Supplies(decor, _toybox(spec.scene.toys, written))


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


def notes(spec: InfantSpec, toybox: Toybox, convention: str | None = None) -> tuple[str, ...]:
    """Return what the user of a bundle should know of how it was built."""
    built_for = (
        () if convention is None else (f"built for {convention}: parts, joints and commands are as its code wants",)
    )
    return (*built_for, *_task_notes(spec), *(toybox.notes if spec.scene.toys else ()))


def _task_notes(spec: InfantSpec) -> Iterator[str]:
    if spec.task and TASKS[spec.task.kind].poses == () and spec.scene.pose != SceneSpec().pose:
        yield f"'{spec.task.kind}' starts from a pose of its own; 'scene.pose: {spec.scene.pose}' has no effect"
