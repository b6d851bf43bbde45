"""What commands do with a world of several infants."""

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from mimoc.base.errors import MimocError
from mimoc.cli.terminal import FAILED_CHECK, printable

if TYPE_CHECKING:
    from mimoc.bundle.io import Bundle
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
    from mimoc.compiler.world_sources import world_of

    world = world_of(path, scene_seed)
    for name, given in refused.items() if world else ():
        if given is not None and given is not False:
            raise MimocError(f"--{name} {NEEDS_ONE}")
    return world


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
    from mimoc.components.senses.touch.run import skin_markers
    from mimoc.render.markers import join_markers
    from mimoc.render.picture_files import write_picture
    from mimoc.render.picture_poses import load_world_in_pose
    from mimoc.render.portrait import world_portrait

    if framing.crop:
        raise MimocError("--crop head draws the head of one infant; leave it out")
    state = load_world_in_pose(world, pose)
    markers = join_markers(skin_markers(infant, *state) for infant in world.infants.values()) if skin else None
    print(printable(write_picture(file, world_portrait(world, pose, *size_px, markers, body, framing))))


def infant_of(world: "WorldBundle", name: str | None) -> "Bundle":
    """Return the infant of a world that has a name, or the first one."""
    from mimoc.base.errors import check_name

    if name is not None:
        check_name("name of an infant of this world", name, world.infants)
    return world.infants[name or next(iter(world.infants))]


def counterpart(world: "WorldBundle", beside: str) -> "WorldBundle":
    """Return the world whose infants are the `healthy` counterparts of those in another."""
    from mimoc.compiler.world_variants import plan_of_bundle
    from mimoc.compiler.worlds import build_world
    from mimoc.schema.counterparts import world_counterpart

    return build_world(world_counterpart(plan_of_bundle(world), beside))
