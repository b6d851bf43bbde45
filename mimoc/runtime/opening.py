"""The shortest ways to an environment: from a bundle, from a spec, from the name of a task, or from several infants."""

import os
from collections.abc import Iterable, Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import gymnasium

from mimoc.base.classes import PATH, check_class, takes
from mimoc.base.errors import BundleError, MimocError, MissingExtraError, check_name
from mimoc.base.kinds import function_of
from mimoc.bundle.io import Bundle, read_bundle
from mimoc.bundle.manifest import MANIFEST
from mimoc.bundle.variants import Variant, Variants
from mimoc.bundle.world import WorldBundle, is_world_folder, read_world_bundle
from mimoc.render.environment import check_rendering
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.world_env import WorldEnv
from mimoc.schema import source as sources
from mimoc.schema.infant import InfantSpec, read_spec
from mimoc.schema.kinds import RECORDING, TASKS
from mimoc.schema.plugins import load_plugins
from mimoc.schema.source import dump
from mimoc.schema.world import WorldPlan, is_world

if TYPE_CHECKING:  # It needs PettingZoo, which not everyone has.
    from mimoc.runtime.parallel_env import InfantsParallelEnv

OPTIONS = ("render_mode", "width", "height", "task", "senses", "companions")  # Keywords of an `InfantEnv`.
WORLD_OPTIONS = ("render_mode", "width", "height", "tasks", "senses", "companions")  # Keywords of a `WorldEnv`.
WORLD_KEYS = ("name", "scene")  # Keywords of a world that is made from specs.
NO_INFANT = "mimoc/Infant-v0 needs an infant: give it as bundle=, a bundle or a spec, or the path of one"
WORLD = "the bundle of a world, its folder, the path of its .yaml file, or specs by the names of infants"
WorldSource = WorldBundle | WorldPlan | Mapping[str, InfantSpec] | str | Path
"""What a world can be made of: a bundle, a folder, a file, or infants by name."""


def make(source: Bundle | InfantSpec | str | Path, **options: Any) -> gymnasium.Env:
    """Return the environment of an infant, as `gymnasium.make("mimoc/Infant-v0", bundle=..., **options)` does.

    The infant can have another age whenever wanted: `env.unwrapped.grow(to=9.5)`, `reset(options={"age_months": 9.5})`.
    Made from a spec, it can be given another scene whenever it is reset: `reset(options={"scene_seed": 7})`.

    Args:
        source: A bundle, the folder of one, or a spec; a path that ends in .yaml or .yml is that of a spec. The folder
            of a recording, such as `mimoc retarget` writes, stands for the infant that was recorded.
        options: For the environment: `render_mode`, `width`, `height`; `task`, an object whose rewards replace those of
            the infant's task (see `mimoc.runtime.task`); `senses`, a dictionary of objects to sense with besides the
            infant's senses (see `mimoc.runtime.sense`); `companions`, a dictionary of objects that act in its
            world besides the infant (see `mimoc.runtime.companion`); and `max_episode_steps` for Gymnasium.

    Raises:
        SpecError: If a spec cannot be built.
        BundleError: If a folder is not a whole bundle, or a plug-in it needs is missing.
        ModelError: If MuJoCo rejects the model.
        RenderingError: If the infant has vision, and there is no OpenGL here.
        UnknownNameError: If there is no such render mode or option.
        KindError: If `task` or `senses` are not objects of the kind described there.
        TypeError: If it is made from anything else.
        ValueError: If pictures cannot have this size.

    Example:
        >>> import mimoc
        >>> env = mimoc.make("nine_months.yaml")
        >>> observation, info = env.reset(seed=0)
        >>> {name: array.shape for name, array in observation.items()}
        {'proprioception': (295,), 'vestibular': (6,)}
        >>> observation, info = env.reset(options={"age_months": 10})
        >>> info["age_months"]
        10.0
    """
    check_source("make", source)
    check_rendering(options.get("render_mode"), options.get("width", 1), options.get("height", 1))
    return gymnasium.make("mimoc/Infant-v0", bundle=source, **options)


def check_source(function: str, source: object) -> None:
    """Raise a TypeError, which names the *function* that was called, unless an infant can be made from *source*."""
    check_class(function, source, "a bundle, a spec, or the path of one", Bundle, InfantSpec, *PATH)


def open_infant(
    bundle: Bundle | InfantSpec | Mapping[str, Any] | str | Path | None = None, **options: Any
) -> InfantEnv:
    """Return the environment of an infant, or of the keys of a spec, without Gymnasium's wrappers; see `make`."""
    if bundle is None:
        raise MimocError(f"{NO_INFANT}; or take the average child of a task: mimoc/Reach-v0 with age_months=9")
    check_options(options)
    if isinstance(bundle, Mapping):
        bundle = InfantSpec.model_validate(dict(bundle))
    return InfantEnv(**prepared(bundle), **options)


open_infant.metadata = InfantEnv.metadata  # pyright: ignore[reportFunctionMemberAccess] - Where Gymnasium looks.


def check_options(options: Iterable[str]) -> None:
    """Check the keywords of an `InfantEnv`."""
    for name in options:
        check_name("keyword of an environment (what the infant is like is said in its spec)", name, OPTIONS)


def open_bundle(bundle: Bundle, other_scenes: bool = False, **options: Any) -> InfantEnv:
    """Return the environment of a bundle, on request with scenes of other seeds, which are built from its spec."""
    parts = _opened(bundle)
    if other_scenes:
        from mimoc.compiler.variants import SpecVariants, spec_of

        parts["variants"] = SpecVariants(spec_of(bundle))
    return InfantEnv(**parts, **options)


def prepared(
    source: Bundle | InfantSpec | str | Path, like: Variants | None = None, skin: bool | None = True
) -> dict[str, Any]:
    """Return the `bundle` and `variants` of an `InfantEnv`.

    Args:
        source: See `make`.
        like: Variants of another infant, whose unchanged parts a spec is built from.
        skin: Whether what is built from a spec has a skin; None is if its eyes see it.
    """
    check_source("an environment", source)
    if isinstance(source, InfantSpec):
        return _compiled(source, like, skin)
    if isinstance(source, (str, Path)) and is_spec_path(source):
        from mimoc.schema.infant import load_spec

        return _compiled(load_spec(source), like, skin)
    if isinstance(source, Bundle):
        return _opened(source)
    if not os.path.lexists(Path(source).expanduser() / MANIFEST):
        return _opened(function_of(RECORDING, "read_infant")(source))
    return _opened(read_bundle(source))


def make_task(
    kind: str,
    bundle: Bundle | str | Path | None = None,
    age_months: float | None = None,
    hands: str | None = None,
    actuation: str | None = None,
    **options: Any,
) -> InfantEnv:
    """Return the environment of a task, as `gymnasium.make("mimoc/Reach-v0", ...)` does.

    Args:
        kind: Name of the task.
        bundle: The infant, as a bundle or the folder of one; if it was built for another task or none, it is compiled
            again for this one. Left out, an average child with proprioception and the vestibular sense.
        age_months: Age of that child; 18 if left out.
        hands: Hands of that child: `mitten`, if left out, or `five_finger`.
        actuation: Actuation model of that child; `torque` if left out.
        options: For the environment; and keys of the task, such as `steps` and `hand`.
    """
    parts, rest = prepared_task(kind, bundle, age_months=age_months, hands=hands, actuation=actuation, **options)
    check_options(rest)
    return InfantEnv(**parts, **rest)


def prepared_task(
    kind: str, bundle: Bundle | str | Path | None = None, skin: bool | None = True, **options: Any
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return what `prepared` does for a task, and the options that are not the task's; see `make_task`."""
    load_plugins()
    keys = [key for key in TASKS.find(kind).spec.model_fields if key in options]
    task_options = _given({key: options.pop(key) for key in keys})
    child = _given({key: options.pop(key, None) for key in ("age_months", "hands", "actuation")})
    task = {"kind": kind, **task_options}
    if bundle is None:
        return _compiled(_child(task, **child), skin=skin), options
    if child:
        raise MimocError(f"the bundle determines the infant; leave out {' and '.join(child)}, or the bundle")
    opened = bundle if isinstance(bundle, Bundle) else read_bundle(bundle)
    if opened.manifest.task.kind == kind and not task_options:
        return _opened(opened), options
    from mimoc.compiler.variants import spec_of

    return _compiled(spec_of(opened).with_(task=None).with_(task=task), skin=skin), options


def _given(choices: dict[str, Any]) -> dict[str, Any]:
    chosen = {name: value for name, value in choices.items() if value is not None}
    return {name: value.item() if hasattr(value, "item") else value for name, value in chosen.items()}


def _child(
    task: dict[str, Any], age_months: float = 18.0, hands: str = "mitten", actuation: str = "torque"
) -> InfantSpec:
    kind = task["kind"]
    data = {
        "mimoc": 1,
        "name": kind,
        "age_months": age_months,
        "body": {"hands": hands},
        "actuation": {"model": actuation},
        "senses": {"proprioception": {}, "vestibular": {}},
        "task": task,
    }
    return read_spec(sources.parse(dump(data), f"<{kind}>"))


def _opened(bundle: Bundle) -> dict[str, Any]:
    return {"bundle": bundle, "variants": BundleVariants(bundle)}


def _compiled(spec: InfantSpec, like: Variants | None = None, skin: bool | None = True) -> dict[str, Any]:
    from mimoc.compiler.building import sees_skin
    from mimoc.compiler.variants import SpecVariants

    variants = SpecVariants(spec, skin=sees_skin(spec) if skin is None else skin)
    variant = variants.own_like(like) if isinstance(like, SpecVariants) else variants.original
    return {"bundle": variant, "variants": variants}


class BundleVariants:
    """Builds the infant of a bundle at any age, in the bundle's own scene, from the spec that the bundle contains.

    The compiler is imported when an age is first asked for.
    """

    has_other_scenes = False

    def __init__(self, bundle: Bundle):
        self._bundle = bundle

    def __reduce__(self) -> tuple[Any, ...]:
        return BundleVariants, (self._bundle,)

    def __call__(self, age_months: float, scene_seed: int) -> Variant:
        """Return the infant at an age, in months as they stand in manifests."""
        try:
            return self._of_spec(age_months, scene_seed)
        except MimocError as error:
            name = self._bundle.manifest.name
            problems = str(error).replace("\n", "; ")
            raise BundleError(f"the bundle '{name}' cannot be built at {age_months:g} months: {problems}") from None

    @cached_property
    def _of_spec(self) -> Variants:
        from mimoc.compiler.variants import SpecVariants, spec_of

        return SpecVariants(spec_of(self._bundle), skin=self._bundle.manifest.has_skin)


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
    keys = {name: options.pop(name) for name in WORLD_KEYS if name in options}
    for name in options:
        check_name("keyword of make_parallel", name, (*WORLD_OPTIONS, *WORLD_KEYS))
    return InfantsParallelEnv(**prepared_world(source, **keys), **options)


def shared_world(source: WorldSource, **options: Any) -> WorldEnv:
    """Return the environment of a world without PettingZoo; see `make_parallel`."""
    return WorldEnv(**prepared_world(source), **options)


def prepared_world(source: WorldSource, **keys: Any) -> dict[str, Any]:
    """Return the `bundle` and `variants` of a `WorldEnv`; *keys* are those of `build_world`."""
    from mimoc.compiler.variants import WorldBundleVariants, WorldVariants
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
