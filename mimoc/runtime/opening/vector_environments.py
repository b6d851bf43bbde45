"""The shortest ways to many environments in one: from specs and bundles, or from the name of a task."""

import math
from collections.abc import Mapping, Sequence
from copy import copy, deepcopy
from functools import partial
from numbers import Integral
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Protocol, runtime_checkable

from gymnasium.vector import AutoresetMode

from mimoc.base.errors import MimocError, UnknownNameError, check_name
from mimoc.bundle.io import Bundle
from mimoc.bundle.model import load_model, load_plain_model
from mimoc.bundle.variants import Variant, WorldVariant
from mimoc.bundle.world import WorldBundle, load_world_model
from mimoc.runtime.batch.vector_env import BatchEnv
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.opening import environments
from mimoc.runtime.opening.parallel import OPTIONS as WORLD_OPTIONS, is_world_source, world_parts
from mimoc.runtime.world_env import WorldEnv
from mimoc.schema.infant import InfantSpec

if TYPE_CHECKING:  # They need Stable-Baselines3 and MuJoCo Warp, which not everyone has.
    from mimoc.runtime.device.vector_env import DeviceEnv

Source = Bundle | InfantSpec | WorldBundle | Mapping[str, InfantSpec] | str | Path


@runtime_checkable
class Population(Protocol):
    """Many infants in one object, such as a cohort."""

    @property
    def specs(self) -> Sequence[InfantSpec]:
        """The specs of all its infants."""
        ...


Sources = Source | Sequence[Source] | Population
RenderMode = Literal["rgb_array"] | None
OBJECTS = ("task", "senses", "companions")  # Options that are objects of a script, which may draw.


def make_vec(
    source: Sources,
    num_envs: int | None = None,
    threads: int | None = None,
    device: str = "cpu",
    render_mode: RenderMode = None,
    autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
    **options: Any,
) -> "BatchEnv | DeviceEnv":
    """Return the vector environment of many infants, as `gymnasium.make_vec("mimoc/Infant-v0", ...)` does.

    On the CPU, infant i gives, step for step and bit for bit, what `mimoc.make` of it gives with the same seed. On a
    GPU it gives the same in single precision, as long as small differences have not grown; see `DeviceEnv`.

    Args:
        source: A bundle, the folder of one, a spec or the path of one, as for `mimoc.make`; or a list of them, which
            may differ in age, measures, strength and scene, and are repeated in turn if there are fewer than infants;
            or a cohort (`mimoc.read_cohort`), for all its infants; or worlds of several infants, as for
            `mimoc.make_parallel`, whose infants are rows in the order of worlds and of infants in them.
        num_envs: Number of infants; by default, as many as sources have.
        threads: Threads that share the work; by default, as many as this process may use.
        device: Where the infants live: `cpu` for MuJoCo itself; `cuda`, `cuda:0`, or another GPU, for MuJoCo Warp.
            `warp:cpu` is MuJoCo Warp on the CPU, to try out what runs on a GPU: it is slow, and compiles for minutes at
            first.
        render_mode: `rgb_array` for pictures of all infants from `render()`, on the CPU.
        autoreset_mode: When an infant whose episode has ended is reset: in the next step (Gymnasium's default), in the
            same one (`SameStep`), or by the caller (`Disabled`).
        options: Others of `mimoc.make`: `width` and `height` of the picture of one infant; `task`, `senses` and
            `companions`, of which each infant gets a copy, in worlds `tasks`, `senses` and `companions` by the names
            of infants; and `max_episode_steps`. On other devices instead, besides
            `task` and the last: `arrays`, `touch`, `starts`, `contacts` and `constraints` of `DeviceEnv`.

    Raises:
        SpecError: If a spec cannot be built.
        BundleError: If a folder is not a whole bundle, or a plug-in it needs is missing.
        MissingExtraError: If the device needs MuJoCo Warp, which is not installed.
        BatchMismatchError: If the infants do not sense and command the same; it names what differs.
        MimocError: If there is no such device, or there are more sources than infants.
        ValueError: If the number of infants or of threads is not a whole number, or negative.

    Example:
        >>> import mimoc
        >>> envs = mimoc.make_vec("nine_months.yaml", num_envs=3)
        >>> observations, infos = envs.reset(seed=0)
        >>> observations["vestibular"].shape
        (3, 6)
        >>> observations, rewards, terminated, truncated, infos = envs.step(envs.action_space.sample())
        >>> envs.close()
    """
    sources = listed(source)
    if any(map(is_world_source, sources)):
        return _of_worlds(sources, num_envs, threads, device, render_mode, autoreset_mode, **options)
    count = len(sources) if num_envs is None else num_envs
    _check_numbers(num_envs=count, threads=threads)
    if count < max(len(sources), 1):
        raise MimocError(
            f"{len(sources)} infants do not fit into num_envs={count}; give at least as many, or fewer infants"
        )
    skin = None if device == "cpu" else False  # No device draws any.
    prepared = [environments.prepared(sources[0], skin=skin)]
    prepared += [environments.prepared(source, prepared[0]["variants"], skin) for source in sources[1:]]
    return _joined(prepared, count, threads, device, render_mode, autoreset_mode, **options)


def _of_worlds(
    sources: Sequence[Any],
    num_envs: int | None,
    threads: int | None,
    device: str,
    render_mode: RenderMode,
    autoreset_mode: AutoresetMode | str,
    **options: Any,
) -> BatchEnv:
    if device != "cpu":
        raise MimocError("infants that share a world are simulated on the CPU; leave out device")
    _check_mode(render_mode)
    for one in sources:
        if not is_world_source(one):
            raise MimocError("a vector environment is of single infants or of worlds, not of both; make one of each")
    limit = options.pop("max_episode_steps", None)
    for name in options:
        check_name("keyword of a vector environment of worlds", name, WORLD_OPTIONS)
    prepared = [world_parts(one) for one in sources]
    sizes = [len(parts["bundle"].infants) for parts in prepared]
    _check_numbers(num_envs=num_envs, threads=threads)
    worlds = _worlds_for(sum(sizes) if num_envs is None else num_envs, sizes)
    models = [load_world_model(parts["bundle"]) for parts in prepared]

    def open_world(index: int) -> WorldEnv:
        parts = prepared[index % len(prepared)]
        variant = WorldVariant(parts["bundle"], copy(models[index % len(models)]))
        return WorldEnv(variant, render_mode, variants=parts["variants"], **deepcopy(options))

    return BatchEnv([partial(open_world, index) for index in range(worlds)], threads, autoreset_mode, limit)


def _worlds_for(count: int, sizes: Sequence[int]) -> int:
    """Return how many worlds, in turn of these numbers of infants, have so many infants in all."""
    worlds = infants = 0
    while infants < count or worlds < len(sizes):
        infants += sizes[worlds % len(sizes)]
        worlds += 1
    if infants != count:
        raise MimocError(
            f"num_envs={count} infants are not the infants of whole worlds of {', '.join(map(str, sizes))}; give a"
            " multiple, such as " + f"num_envs={infants}"
        )
    return worlds


def _check_mode(render_mode: RenderMode) -> None:
    if render_mode not in (None, "rgb_array"):
        raise UnknownNameError("render mode of a vector environment", str(render_mode), ["rgb_array"])


def make_vec_task(kind: str, num_envs: int = 1, **options: Any) -> "BatchEnv | DeviceEnv":
    """Return the vector environment of a task, as `gymnasium.make_vec("mimoc/Reach-v0", ...)` does.

    Options are those of `make_vec` and `make_task`; values of lists as `bundle` and `age_months` are repeated in turn.
    """
    lists = {name: listed(options[name]) for name in ("bundle", "age_months") if name in options}
    prepared, rest, skin = [], options, None if options.get("device", "cpu") == "cpu" else False
    for index in range(min(num_envs, math.lcm(*map(len, lists.values())))):
        options_of_infant = {name: values[index % len(values)] for name, values in lists.items()}
        parts, rest = environments.prepared_task(kind, **{**options, **options_of_infant}, skin=skin)
        prepared.append(parts)
    return _joined(prepared, num_envs, **rest)


def make_vec_infant(
    num_envs: int = 1, bundle: Any = None, source: Any = None, **options: Any
) -> "BatchEnv | DeviceEnv":
    """Return what `make_vec` does, for Gymnasium, where the infants are called `bundle` as in `gymnasium.make`."""
    infants = bundle if source is None else source
    if infants is None:
        raise MimocError(f"{environments.NO_INFANT}, or a list of them")
    return make_vec(infants, num_envs, **options)


def _joined(
    prepared: Sequence[dict[str, Any]],
    count: int,
    threads: int | None = None,
    device: str = "cpu",
    render_mode: RenderMode = None,
    autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
    **options: Any,
) -> "BatchEnv | DeviceEnv":
    _check_mode(render_mode)
    if device != "cpu":
        return _on_device(prepared, count, device, render_mode, autoreset_mode, options)
    limit = options.pop("max_episode_steps", None)
    environments.check_options(options)

    def open_infant(parts: dict[str, Any]) -> InfantEnv:
        return InfantEnv(**parts, render_mode=render_mode, **deepcopy(options))

    is_drawn = render_mode is not None or any(options.get(name) for name in OBJECTS)
    infants = _repeated([_loaded(parts, is_drawn) for parts in prepared], count)
    return BatchEnv([partial(open_infant, parts) for parts in infants], threads, autoreset_mode, limit)


def _loaded(parts: dict[str, Any], is_drawn: bool) -> dict[str, Any]:
    """Return what an infant is made of with its model, which has no textures where nothing draws it."""
    bundle = parts["bundle"]
    if isinstance(bundle, Variant):
        return parts
    has_eyes = bundle.manifest.senses.vision is not None
    return {**parts, "bundle": Variant(bundle, (load_model if is_drawn or has_eyes else load_plain_model)(bundle))}


def _repeated(prepared: Sequence[dict[str, Any]], count: int) -> list[dict[str, Any]]:
    infants = [*prepared]
    for index in range(len(prepared), count):
        parts = prepared[index % len(prepared)]
        bundle = parts["bundle"]
        infants.append({**parts, "bundle": bundle.again() if isinstance(bundle, Variant) else bundle})
    return infants


def _on_device(
    prepared: Sequence[dict[str, Any]],
    count: int,
    device: str,
    render_mode: RenderMode,
    autoreset_mode: AutoresetMode | str,
    options: dict[str, Any],
) -> "DeviceEnv":
    from mimoc.runtime.device.vector_env import DeviceEnv
    from mimoc.runtime.device.world_assignment import ResetSampler

    if options.pop("companions", None):
        raise MimocError("companions act on the CPU only: leave them out, or leave out device")
    known = ["task", "senses", "max_episode_steps", "arrays", "touch", "starts", "contacts", "constraints"]
    for name in options.keys() - known:
        raise UnknownNameError(f"option of infants on device '{device}'", name, known)
    if render_mode is not None:
        raise MimocError(f"infants on device '{device}' cannot be rendered; leave out render_mode")
    objects = {name: options.pop(name) for name in ("task", "senses") if name in options}
    infants = [ResetSampler(**parts, **deepcopy(objects)) for parts in prepared]
    return DeviceEnv(infants, count, device.removeprefix("warp:"), autoreset_mode, **options)


def _check_numbers(**given: Any) -> None:
    for name, number in given.items():
        if number is not None and (isinstance(number, bool) or not isinstance(number, Integral) or number < 0):
            raise ValueError(f"expected a whole number that is not negative as {name}, got {number!r}")


def listed(source: Any) -> list[Any]:
    """Return what was given for each of some infants, or for all of them, as a list."""
    if isinstance(source, Population):
        return list(source.specs)
    return list(source) if isinstance(source, Sequence) and not isinstance(source, str) else [source]
