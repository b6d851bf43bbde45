"""What a scene is made of besides its spec: toys and wallpapers, mimoc's own and the user's."""

from collections.abc import Iterator, Sequence
from functools import cache, partial
from pathlib import Path

from mimoc.bundle.manifest import ToyEntry
from mimoc.compiler.furnish import BUILTIN_TOYS, Supplies
from mimoc.errors import SpecError, TextureError, ToyError, suggestion
from mimoc.looks.own_textures import read_textures
from mimoc.looks.wallpaper import CEILINGS, FLOORS, WALLS, Wallpaper
from mimoc.scenes.room.build import Decor
from mimoc.scenes.spec import SceneSpec, ToysSpec
from mimoc.schema.infant import InfantSpec
from mimoc.schema.source import Source
from mimoc.toys.choosing import Toybox
from mimoc.toys.toys4k.cache import MeshCache
from mimoc.toys.toys4k.convex import has_coacd
from mimoc.toys.toys4k.dataset import choose, expand_root, find_toys, unknown
from mimoc.toys.toys4k.meshes import load_toy

STARTS_FROM_SCENE = ("rollover", "free")
"""Tasks that start in the pose of the scene."""


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
    boxes = {"builtin": _builtin, "toys4k": _toys4k}
    return Supplies(decor, boxes[spec.scene.toys.source](spec.scene.toys, written, folder))


def _own(kind: str, spec: InfantSpec, written: Source, folder: Path) -> tuple[Wallpaper, ...]:
    path = getattr(spec.scene.textures, kind)
    if path is None:
        return ()
    try:
        return read_textures(folder / Path(path).expanduser())
    except TextureError as error:
        problems = str(error).splitlines()
        raise SpecError(written.problem(("scene", "textures", kind), problem) for problem in problems) from None


def _builtin(toys: ToysSpec, written: Source, folder: Path) -> Toybox:
    wrong = {name: suggestion(name, BUILTIN_TOYS.names) for name in toys.subset if name not in BUILTIN_TOYS.names}
    if wrong:
        raise _unknown_toys(
            toys, written, {name: f"'{name}' is not among mimoc's toys; {advice}" for name, advice in wrong.items()}
        )
    return Toybox(tuple(sorted(toys.subset)) or BUILTIN_TOYS.names, BUILTIN_TOYS.take)


def _toys4k(toys: ToysSpec, written: Source, folder: Path) -> Toybox:
    try:
        found = find_toys(expand_root(str(toys.root), folder))
        if wrong := unknown(found, toys.subset):
            raise _unknown_toys(toys, written, wrong)
        return Toybox(choose(found, toys.subset), cache(partial(load_toy, found, cache=MeshCache())))
    except ToyError as error:
        problems = str(error).splitlines()
        raise SpecError(written.problem(("scene", "toys", "root"), problem) for problem in problems) from None


def _unknown_toys(toys: ToysSpec, written: Source, messages: dict[str, str]) -> SpecError:
    """Return an error that points at each name of the subset that is not there."""
    names: Sequence[str] = toys.subset
    return SpecError(
        written.problem(("scene", "toys", "subset", names.index(name)), message) for name, message in messages.items()
    )


def notes(spec: InfantSpec, toys: Sequence[ToyEntry], convention: str | None = None) -> tuple[str, ...]:
    """Return what the user of a bundle should know of how it was built."""
    built_for = (
        () if convention is None else (f"built for {convention}: parts, joints and commands are as its code wants",)
    )
    return (*built_for, *_task_notes(spec), *_toy_notes(spec, toys))


def _task_notes(spec: InfantSpec) -> Iterator[str]:
    if spec.task and spec.task.kind not in STARTS_FROM_SCENE and spec.scene.pose != SceneSpec().pose:
        yield f"'{spec.task.kind}' starts from a pose of its own; 'scene.pose: {spec.scene.pose}' has no effect"


def _toy_notes(spec: InfantSpec, toys: Sequence[ToyEntry]) -> Iterator[str]:
    if toys and spec.scene.toys and spec.scene.toys.source == "toys4k" and not has_coacd():
        yield "toys touch with their convex hulls only; for a closer fit: pip install 'mimoc[toys]', and build again"
