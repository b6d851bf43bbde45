"""The shortest ways to many environments in one: from specs and bundles, or from the name of a task."""

import math
from collections.abc import Mapping, Sequence
from copy import copy, deepcopy
from dataclasses import dataclass, field, fields
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
from mimoc.runtime import opening
from mimoc.runtime.batch_env import BatchEnv
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.opening import WORLD_OPTIONS, is_world_source, prepared_world
from mimoc.runtime.world_env import WorldEnv
from mimoc.schema.infant import InfantSpec

if TYPE_CHECKING:  # It needs MuJoCo Warp, which not everyone has.
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
DEVICE_OPTIONS = ("task", "senses", "max_episode_steps", "arrays", "touch", "starts", "contacts", "constraints")


@dataclass(frozen=True)
class VectorOptions:
    """What is asked of a vector environment, whatever its infants are; see `make_vec`.

    Raises:
        ValueError: If the number of infants or of threads is not a whole number, or negative.
        UnknownNameError: If there is no such render mode.
    """

    num_envs: int | None = None
    threads: int | None = None
    device: str = "cpu"
    render_mode: RenderMode = None
    autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP
    max_episode_steps: int | None = None
    of_each: Mapping[str, Any] = field(default_factory=dict)  # Keywords of each environment.

    @classmethod
    def of(cls, **options: Any) -> "VectorOptions":
        """Return options by name; keywords of no field are for each environment."""
        names = {field.name for field in fields(cls)} - {"of_each"}
        of_each = {name: value for name, value in options.items() if name not in names}
        return cls(**{name: options[name] for name in options.keys() - of_each}, of_each=of_each)

    def __post_init__(self) -> None:
        for name in ("num_envs", "threads"):
            number = getattr(self, name)
            if number is not None and (isinstance(number, bool) or not isinstance(number, Integral) or number < 0):
                raise ValueError(f"expected a whole number that is not negative as {name}, got {number!r}")
        if self.render_mode not in (None, "rgb_array"):
            raise UnknownNameError("render mode of a vector environment", str(self.render_mode), ["rgb_array"])


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
        device: What simulates: `cpu` for MuJoCo itself; `cuda`, `cuda:0`, or another GPU, for MuJoCo Warp.
            `warp:cpu` is MuJoCo Warp on the CPU, to try out what runs on a GPU: it is slow, and compiles for minutes at
            first.
        render_mode: `rgb_array` for pictures of all infants from `render()`, on the CPU.
        autoreset_mode: When an infant whose episode has ended is reset: in the next step (Gymnasium's default), in the
            same one (`SameStep`), or by the caller (`Disabled`).
        options: Others of `mimoc.make`: `width` and `height` of the picture of one infant; `task`, `senses` and
            `companions`, of which each infant gets a copy, in worlds `tasks`, `senses` and `companions` by the names
            of infants; and `max_episode_steps`. On other devices instead, besides `task` and the last: `arrays`,
            `touch`, `starts`, `contacts` and `constraints` of `DeviceEnv`.

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
    asked = VectorOptions.of(
        num_envs=num_envs,
        threads=threads,
        device=device,
        render_mode=render_mode,
        autoreset_mode=autoreset_mode,
        **options,
    )
    sources = listed(source)
    if any(map(is_world_source, sources)):
        return _of_worlds(sources, asked)
    count = len(sources) if num_envs is None else num_envs
    if count < max(len(sources), 1):
        raise MimocError(
            f"{len(sources)} infants do not fit into num_envs={count}; give at least as many, or fewer infants"
        )
    skin = None if device == "cpu" else False  # No device draws any.
    prepared = [opening.prepared(sources[0], skin=skin)]
    prepared += [opening.prepared(source, prepared[0]["variants"], skin) for source in sources[1:]]
    return _joined(prepared, asked)


def make_vec_task(kind: str, num_envs: int = 1, **options: Any) -> "BatchEnv | DeviceEnv":
    """Return the vector environment of a task, as `gymnasium.make_vec("mimoc/Reach-v0", ...)` does.

    Options are those of `make_vec` and `make_task`; values of lists as `bundle` and `age_months` are repeated in turn.
    """
    lists = {name: listed(options[name]) for name in ("bundle", "age_months") if name in options}
    prepared = []
    rest = options
    skin = None if options.get("device", "cpu") == "cpu" else False
    for index in range(min(num_envs, math.lcm(*map(len, lists.values())))):
        options_of_infant = {name: values[index % len(values)] for name, values in lists.items()}
        parts, rest = opening.prepared_task(kind, **{**options, **options_of_infant}, skin=skin)
        prepared.append(parts)
    return _joined(prepared, VectorOptions.of(num_envs=num_envs, **rest))


def make_vec_infant(
    num_envs: int = 1, bundle: Any = None, source: Any = None, **options: Any
) -> "BatchEnv | DeviceEnv":
    """Return what `make_vec` does, for Gymnasium, where the infants are called `bundle` as in `gymnasium.make`."""
    infants = bundle if source is None else source
    if infants is None:
        raise MimocError(f"{opening.NO_INFANT}, or a list of them")
    return make_vec(infants, num_envs, **options)


def listed(source: Any) -> list[Any]:
    """Return a list of what was given for each infant, or for all."""
    if isinstance(source, Population):
        return list(source.specs)
    return list(source) if isinstance(source, Sequence) and not isinstance(source, str) else [source]


def _of_worlds(sources: Sequence[Any], asked: VectorOptions) -> BatchEnv:
    if asked.device != "cpu":
        raise MimocError("infants that share a world are simulated on the CPU; leave out device")
    if not all(map(is_world_source, sources)):
        raise MimocError("a vector environment is of single infants or of worlds, not of both; make one of each")
    for name in asked.of_each:
        check_name("keyword of a vector environment of worlds", name, WORLD_OPTIONS)
    prepared = [prepared_world(one) for one in sources]
    sizes = [len(parts["bundle"].infants) for parts in prepared]
    worlds = _worlds_for(sum(sizes) if asked.num_envs is None else asked.num_envs, sizes)
    models = [load_world_model(parts["bundle"]) for parts in prepared]

    def open_world(index: int) -> WorldEnv:
        parts = prepared[index % len(prepared)]
        variant = WorldVariant(parts["bundle"], copy(models[index % len(models)]))
        return WorldEnv(variant, asked.render_mode, variants=parts["variants"], **deepcopy(dict(asked.of_each)))

    openers = [partial(open_world, index) for index in range(worlds)]
    return BatchEnv(openers, asked.threads, asked.autoreset_mode, asked.max_episode_steps)


def _worlds_for(count: int, sizes: Sequence[int]) -> int:
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


def _joined(prepared: Sequence[dict[str, Any]], asked: VectorOptions) -> "BatchEnv | DeviceEnv":
    """Return the vector environment of infants that `opening.prepared` returns, repeated in turn."""
    count = len(prepared) if asked.num_envs is None else asked.num_envs
    if asked.device != "cpu":
        return _on_device(prepared, count, asked)
    opening.check_options(asked.of_each)

    def open_infant(parts: dict[str, Any]) -> InfantEnv:
        return InfantEnv(**parts, render_mode=asked.render_mode, **deepcopy(dict(asked.of_each)))

    is_drawn = asked.render_mode is not None or any(asked.of_each.get(name) for name in OBJECTS)
    infants = [_loaded(parts, is_drawn) for parts in prepared]
    for index in range(len(prepared), count):
        parts = infants[index % len(prepared)]
        infants.append({**parts, "bundle": parts["bundle"].again()})
    openers = [partial(open_infant, parts) for parts in infants]
    return BatchEnv(openers, asked.threads, asked.autoreset_mode, asked.max_episode_steps)


def _loaded(parts: dict[str, Any], is_drawn: bool) -> dict[str, Any]:
    """Return *parts* with the infant's model, which has no textures where nothing draws it."""
    bundle = parts["bundle"]
    if isinstance(bundle, Variant):
        return parts
    has_eyes = bundle.manifest.senses.vision is not None
    return {**parts, "bundle": Variant(bundle, (load_model if is_drawn or has_eyes else load_plain_model)(bundle))}


def _on_device(prepared: Sequence[dict[str, Any]], count: int, asked: VectorOptions) -> "DeviceEnv":
    from mimoc.runtime.device.vector_env import DeviceEnv
    from mimoc.runtime.device.world_assignment import ResetSampler

    options = dict(asked.of_each)
    if options.pop("companions", None):
        raise MimocError("companions act on the CPU only: leave them out, or leave out device")
    for name in options:
        check_name(f"option of infants on device '{asked.device}'", name, DEVICE_OPTIONS)
    if asked.render_mode is not None:
        raise MimocError(f"infants on device '{asked.device}' cannot be rendered; leave out render_mode")
    objects = {name: options.pop(name) for name in ("task", "senses") if name in options}
    infants = [ResetSampler(**parts, **deepcopy(objects)) for parts in prepared]
    device = asked.device.removeprefix("warp:")
    return DeviceEnv(infants, count, device, asked.autoreset_mode, asked.max_episode_steps, **options)
