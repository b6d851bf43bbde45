"""The world in whatever it can be given as."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from mimoc.base.classes import PATH
from mimoc.bundle.world import WorldBundle, is_world_folder, read_world_bundle
from mimoc.compiler.loading import SPEC_SUFFIXES
from mimoc.compiler.worlds import build_world
from mimoc.schema import source as sources
from mimoc.schema.world import WorldPlan, in_scene, is_world, read_world


def world_of(source: Any, scene_seed: int | None = None) -> WorldBundle | None:
    """Return the world of several infants that something is, or is the path of; None if it is anything else.

    Args:
        source: A world's bundle, its folder, the path of a world's .yaml file, or specs by the names of infants.
        scene_seed: The seed of its scene, if it is built from a file; None is that of the file.

    Raises:
        SpecError: If a world cannot be built.
        BundleError: If the bundle of a world is damaged.
    """
    if isinstance(source, WorldBundle):
        return source
    if isinstance(source, (WorldPlan, Mapping)):
        return build_world(source)
    if not isinstance(source, PATH):
        return None
    path = Path(source).expanduser()
    if path.suffix.lower() not in SPEC_SUFFIXES:
        return read_world_bundle(path) if is_world_folder(path) else None
    written = sources.read(path) if path.is_file() else None
    if written is None or not is_world(written.data):
        return None
    plan = read_world(written)
    return build_world(plan if scene_seed is None else in_scene(plan, scene_seed))
