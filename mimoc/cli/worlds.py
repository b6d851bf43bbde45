"""What commands do with a world of several infants."""

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from mimoc.base.errors import MimocError
from mimoc.cli.arguments import STDIN
from mimoc.cli.terminal import FAILED_CHECK, printable

if TYPE_CHECKING:
    from mimoc.bundle.world import WorldBundle
    from mimoc.render.portrait import Framing
    from mimoc.render.renderer import Shown

NEEDS_ONE = "is for a single infant, and this is a world with several; leave it out"


def find_world(path: Path, scene_seed: int | None = None, **refused: object) -> "WorldBundle | None":
    """Return the world of several infants in a folder, or built from a file; None if there is something else.

    Args:
        path: What a command was given.
        scene_seed: The seed of its scene, if it is built from a file; None is that of the file.
        refused: Options that are for single infants, by name, as they were given.

    Raises:
        SpecError: If a world cannot be built.
        BundleError: If the bundle of a world is damaged.
        MimocError: If it is a world, and such an option was given.
    """
    from mimoc.bundle.world import is_world_folder, read_world_bundle
    from mimoc.compiler.loading import SPEC_SUFFIXES
    from mimoc.schema import source
    from mimoc.schema.world import in_scene, is_world, read_world

    if path.suffix.lower() in SPEC_SUFFIXES:
        written = source.read(path) if path != STDIN and path.is_file() else None
        if written is None or not is_world(written.data):
            return None
        _refuse(refused)
        from mimoc.compiler.worlds import build_world

        plan = read_world(written)
        return build_world(plan if scene_seed is None else in_scene(plan, scene_seed))
    if not is_world_folder(path):
        return None
    _refuse(refused)
    return read_world_bundle(path)


def write(world: "WorldBundle", out: Path, *, force: bool) -> None:
    """Write a world, and print what was built."""
    from mimoc.bundle.io import write_bundle
    from mimoc.cli import console
    from mimoc.compiler.provenance import who_percentiles

    written = write_bundle(world, out, force=force)
    for infant in world.infants.values():
        console.print_child(infant.manifest, who_percentiles(infant.manifest.child))
    console.print_toys(world.manifest)
    print(printable(f"{written}: open {written / world.manifest.scene} with MuJoCo, or try: mimoc run {written}"))


def check(world: "WorldBundle") -> None:
    """Check a world, and print the result."""
    from mimoc.cli import console
    from mimoc.runtime.check import check_world

    print(f"ok     all {len(world.files)} files {'are unchanged' if world.path else 'of the world compile'}")
    trial = check_world(world)
    console.print_check(trial)
    if not trial.passed:
        raise typer.Exit(FAILED_CHECK)


def draw(
    world: "WorldBundle",
    file: Path,
    pose: str | None,
    size_px: tuple[int, int],
    skin: bool,
    body: "Shown",
    framing: "Framing",
) -> None:
    """Write a picture of a world, with its skin points if *skin*."""
    from mimoc.render.markers import join_markers
    from mimoc.render.picture_files import write_picture
    from mimoc.render.picture_poses import load_world_in_pose
    from mimoc.render.portrait import world_portrait
    from mimoc.senses.touch.run import skin_markers

    if framing.crop:
        raise MimocError("--crop head draws the head of one infant; leave it out")
    state = load_world_in_pose(world, pose)
    markers = join_markers(skin_markers(infant, *state) for infant in world.infants.values()) if skin else None
    print(printable(write_picture(file, world_portrait(world, pose, *size_px, markers, body, framing))))


def _refuse(options: dict[str, object]) -> None:
    for name, given in options.items():
        if given is not None and given is not False:
            raise MimocError(f"--{name} {NEEDS_ONE}")
