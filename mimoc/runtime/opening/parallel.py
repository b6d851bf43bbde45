"""Several infants in one world as a PettingZoo environment."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mimoc.base.classes import PATH, takes
from mimoc.base.errors import BundleError, MimocError, MissingExtraError, check_name
from mimoc.bundle.world import WorldBundle, is_world_folder, read_world_bundle
from mimoc.runtime.world_env import WorldEnv
from mimoc.schema import source as sources
from mimoc.schema.infant import InfantSpec
from mimoc.schema.world import WorldPlan, is_world

if TYPE_CHECKING:  # They need PettingZoo and Stable-Baselines3, which not everyone has.
    from mimoc.runtime.parallel_env import InfantsParallelEnv

WorldSource = WorldBundle | WorldPlan | Mapping[str, InfantSpec] | str | Path
"""What a world can be made of: a bundle, a folder, a file, or infants by name."""
OPTIONS = ("render_mode", "width", "height", "tasks", "senses", "companions")  # What can be said of an environment.
KEYS = ("name", "scene")  # What can be said of a world, besides which infants live in it.
WORLD = "the bundle of a world, its folder, the path of its .yaml file, or specs by the names of infants"


@takes(WORLD, WorldBundle, WorldPlan, Mapping, *PATH)
def make_parallel(source: WorldSource, **options: Any) -> "InfantsParallelEnv":
    """Return the PettingZoo `ParallelEnv` of several infants in one world.

    Agents are the infants, by name. Each has the observation and action space that it has alone, its own senses,
    delays, noise, task and age; they touch and see each other, and each feels the same contact forces.

    Args:
        source: A world's bundle, the folder of one, the path of a world's YAML file, or specs by the infants' names.
        options: Of specs by name, `scene` and `name` as in a world's file; `render_mode`, `width` and `height`; and by
            infant `tasks`, `senses` and `companions`, objects as in `mimoc.make`: `tasks={"anna": MyTask()}`.

    Raises:
        MissingExtraError: If PettingZoo is not installed.
        SpecError: If a spec cannot be built, or infants would start within each other.
        BundleError: If a folder is not the whole bundle of a world.
        ModelError: If MuJoCo rejects the model.
        RenderingError: If an infant has vision, and there is no OpenGL here.
        UnknownNameError: If there is no such render mode, infant or option.
        KindError: If objects are not given by infant, or are none of their kind.
        MimocError: If `scene` or `name` is given of a world that says so itself.
        TypeError: If it is made from anything else.

    Example:
        >>> import mimoc
        >>> anna = mimoc.load_spec("nine_months.yaml")
        >>> env = mimoc.make_parallel({"anna": anna, "ben": anna.with_(age_months=12)})
        >>> observations, infos = env.reset(seed=0)
        >>> actions = {name: env.action_space(name).sample() for name in env.agents}
        >>> observations, rewards, terminated, truncated, infos = env.step(actions)
        >>> {name: infos[name]["age_months"] for name in env.agents}
        {'anna': 9.0, 'ben': 12.0}
    """
    try:
        from mimoc.runtime.parallel_env import InfantsParallelEnv
    except ImportError:
        raise MissingExtraError("PettingZoo", "multi") from None
    keys = {name: options.pop(name) for name in KEYS if name in options}
    for name in options:
        check_name("keyword of make_parallel", name, (*OPTIONS, *KEYS))
    return InfantsParallelEnv(**world_parts(source, **keys), **options)


def world_parts(source: WorldSource, **keys: Any) -> dict[str, Any]:
    """Return what the environment of a world is made of; *keys* are those of `build_world`."""
    from mimoc.compiler.world_variants import WorldBundleVariants, WorldVariants
    from mimoc.compiler.worlds import plan_world

    if keys and not isinstance(source, Mapping):
        raise MimocError(f"{' and '.join(keys)} can be said of specs by name only; this world says so itself")
    if isinstance(source, (WorldPlan, Mapping)) or (isinstance(source, (str, Path)) and is_spec_path(source)):
        variants = WorldVariants(plan_world(source, **keys))
        return {"bundle": variants.original, "variants": variants}
    if isinstance(source, (str, Path)) and os.path.isfile(source):
        raise BundleError(f"{source}: this is a file; name the folder of a world's bundle, or its .yaml file")
    bundle = source if isinstance(source, WorldBundle) else read_world_bundle(source)
    return {"bundle": bundle, "variants": WorldBundleVariants(bundle)}


def is_spec_path(source: str | Path) -> bool:
    """Return whether a path is that of a YAML file."""
    return Path(source).suffix.lower() in (".yaml", ".yml")


def is_world_source(source: Any) -> bool:
    """Return whether something is a world of several infants, or the path of one."""
    if isinstance(source, (str, Path)):
        path = Path(source).expanduser()
        return is_world_folder(path) or (is_spec_path(path) and path.is_file() and is_world(sources.read(path).data))
    return isinstance(source, (WorldBundle, WorldPlan, Mapping))


def shared_world(source: WorldSource, **options: Any) -> WorldEnv:
    """Return the same world without PettingZoo; see `make_parallel`."""
    return WorldEnv(**world_parts(source), **options)
