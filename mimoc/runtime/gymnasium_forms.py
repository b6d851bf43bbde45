"""What Gymnasium's environments take and give, above all those of many infants that sense and command the same."""

import copy
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, TypeGuard

import numpy as np
import numpy.typing as npt
from gymnasium import Space
from gymnasium.envs.registration import EnvSpec
from gymnasium.error import ResetNeeded
from gymnasium.spaces import Box, Dict
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_differing_spaces, batch_space

from mimoc.base.errors import MimocError
from mimoc.base.random_streams import checked_seed
from mimoc.runtime.actuation import numbers_of
from mimoc.runtime.arousal import checked_arousal
from mimoc.runtime.growing import options_given
from mimoc.runtime.infant import Infant

RESET_MASK = "reset_mask"  # Gymnasium's option: which environments are reset.
Infos = dict[int, dict[str, Any]]  # Info of each infant that has one, by its index.
FINAL = "final_obs"  # What an infant saw last, which is not put into arrays.


def seeds_of(seed: int | Sequence[int | None] | None, count: int) -> list[int | None]:
    """Return the seed of each infant: `seed + i` for infant i, or the i-th of a list."""
    if seed is None:
        return [None] * count
    if not _is_list(seed):
        first = checked_seed(seed)
        return [first + index for index in range(count)]
    if len(seed) != count:
        raise ValueError(f"expected {count} seeds, one for each infant, got {len(seed)}")
    return [None if item is None else checked_seed(item) for item in seed]


def options_of(options: Mapping[str, Any] | None, count: int) -> list[dict[str, Any]]:
    """Return the options of each infant: a list, tuple or array gives infant i its i-th value, where None is none."""
    options_by_infant: list[dict[str, Any]] = [{} for _ in range(count)]
    for name, value in options_given(options).items():
        if name == RESET_MASK:
            continue
        values = value if _is_list(value) else [value] * count
        if len(values) != count:
            raise ValueError(f"option '{name}': expected one value for all, or {count}, got {len(values)}")
        for of_infant, item in zip(options_by_infant, values, strict=True):
            if item is not None:
                of_infant[name] = item.item() if isinstance(item, (np.generic, np.ndarray)) and not item.ndim else item
    return options_by_infant


def _is_list(value: Any) -> TypeGuard[Sequence[Any]]:
    return isinstance(value, (list, tuple)) or (isinstance(value, np.ndarray) and value.ndim > 0)


def arousals_of(levels: Any, count: int) -> list[float]:
    """Return the arousal of each infant, from one value or from a list or array."""
    if np.shape(levels) not in ((), (count,)):
        raise ValueError(f"expected one arousal for all, or {count}, got shape {np.shape(levels)}")
    return [checked_arousal(level) for level in np.broadcast_to(np.asarray(levels, object), count)]


def reset_indices(options: Mapping[str, Any] | None, count: int) -> list[int]:
    """Return the infants that are reset: all, or those of `reset_mask`, a boolean array of shape (n,)."""
    mask = options_given(options).get(RESET_MASK)
    if mask is None:
        return list(range(count))
    mask = np.asarray(mask)
    if mask.shape != (count,) or mask.dtype != np.bool_ or not mask.any():
        raise ValueError(
            f"option '{RESET_MASK}': expected a boolean array of shape ({count},) with a True, got {mask.dtype} of "
            f"shape {mask.shape}"
        )
    return np.flatnonzero(mask).tolist()


def limited_spec(limits: Callable[[Any], Iterable[int | None]]) -> Any:
    """Return a property `spec` whose `max_episode_steps` is the shortest limit of an environment's episodes."""

    def spec_of(env: Any) -> EnvSpec | None:
        spec = getattr(env, "_spec", None)
        given = [limit for limit in (spec and spec.max_episode_steps, *limits(env)) if limit is not None]
        if spec is None or not given:
            return spec
        limited = copy.copy(spec)
        limited.max_episode_steps = min(given)
        return limited

    return property(spec_of, lambda env, spec: setattr(env, "_spec", spec))


class InfantVectorEnv(VectorEnv[Any, Any, Any]):
    """A base for vector environments of infants on the CPU and on a device."""

    def _limits(self) -> set[int | None]:
        limits = {min((steps for steps in (own, self._limit) if steps is not None), default=None) for own in self._own}
        return limits if len(limits) == 1 else set()

    spec: Any = limited_spec(_limits)

    def _describe(
        self,
        metadata: Mapping[str, Any],
        infants: Sequence[Infant],
        spaces: Sequence[Any],
        mode: AutoresetMode,
        limit: int | None,
    ) -> None:
        """Set Gymnasium's attributes; the first infant stands for all, except for their *spaces*."""
        self._limit = limit
        self._own = tuple(infant.max_steps for infant in infants)
        self.autoreset_mode, self.num_envs = mode, len(spaces)
        self.metadata = {**metadata, "autoreset_mode": mode}
        self.single_action_space = infants[0].action_space
        self.action_space = batch_space(self.single_action_space, len(spaces))
        self.single_observation_space = spaces[0]
        self.observation_space = batch_space(spaces[0], len(spaces))
        if any(space != spaces[0] for space in spaces):
            unions = {name: _union([space[name] for space in spaces]) for name in spaces[0]}
            self.single_observation_space = Dict(unions)
            self.observation_space = batch_differing_spaces(list(spaces))

    def _checked(self, actions: npt.ArrayLike) -> npt.NDArray[Any]:
        """Return actions as an array, or raise a ValueError before any infant has moved."""
        actions = numbers_of(actions)
        self._check_shape(actions.shape)
        if not np.isfinite(actions).all():
            infant = int(np.flatnonzero(~np.isfinite(actions).all(axis=1))[0])
            raise ValueError(
                f"expected finite actions, got {actions[infant][~np.isfinite(actions[infant])][0]} for infant {infant}"
            )
        return actions

    def _check_shape(self, shape: Sequence[int]) -> None:
        if tuple(shape) != self.action_space.shape:
            expected = self.action_space.shape
            raise ValueError(f"expected finite actions of shape {expected}, got shape {tuple(shape)}")


def refuse_ended(ended: npt.NDArray[np.bool_]) -> None:
    """Raise `ResetNeeded` if the caller has not reset an infant whose episode has ended."""
    if ended.any():
        raise ResetNeeded(f"the episodes of infants {np.flatnonzero(ended).tolist()} have ended; reset them")


def _union(spaces: Sequence[Any]) -> Space:
    if not isinstance(spaces[0], Box):
        return spaces[0]
    low, high = np.min([box.low for box in spaces], axis=0), np.max([box.high for box in spaces], axis=0)
    return Box(low, high, dtype=spaces[0].dtype.type)


def joined_infos(infos: Infos, count: int) -> dict[str, Any]:
    """Join infos by infant into arrays with masks, as `VectorEnv._add_info` does one by one."""
    joined: dict[str, Any] = {}
    for name in dict.fromkeys(name for info in infos.values() for name in info):
        values = {infant: info[name] for infant, info in infos.items() if name in info}
        having, first = list(values), next(iter(values.values()))
        if isinstance(first, dict) and name != FINAL:
            joined[name] = joined_infos(values, count)
        elif isinstance(first, (bool, int, float, np.number, np.ndarray)):
            joined[name] = np.zeros((count, *np.shape(first)), np.asarray(first).dtype)
            joined[name][having] = list(values.values())
        else:
            joined[name] = np.full(count, None, object)
            for infant, value in values.items():
                joined[name][infant] = value
        mask = np.zeros(count, bool)
        mask[having] = True
        joined[f"_{name}"] = mask
    return joined


MAX_LISTED = 4  # Names that an error gives of those in which infants differ.


class BatchMismatchError(MimocError):
    """Infants that cannot share a batch."""


def mixture_error(infants: str, differences: str) -> BatchMismatchError:
    """Return the error that names two infants and what they differ in."""
    return BatchMismatchError(
        f"infants {infants} cannot share a batch, because they differ in {differences}; "
        "make a vector environment of each kind"
    )


def check_mixture(infants: Sequence[Infant]) -> None:
    """Raise a BatchMismatchError unless all infants can share a batch with the first one."""
    first = _parts(infants[0])
    for number, infant in enumerate(infants):
        parts = _parts(infant)
        differences = [
            f"{part} ({_difference(first.get(part), parts.get(part))})"
            for part in dict.fromkeys([*first, *parts])
            if first.get(part) != parts.get(part)
        ]
        if differences:
            who = f"0 ('{infants[0].manifest.name}') and {number} ('{infant.manifest.name}')"
            raise mixture_error(who, "; ".join(differences))


def _parts(infant: Infant) -> dict[str, Any]:
    manifest = infant.manifest
    arrays: Any = infant.observation_space
    return {
        "control step": f"{manifest.step_ms:g} ms",
        "physics step": f"{manifest.timestep_ms:g} ms",
        "actuation model": manifest.actuation.model,
        "commands": manifest.commands,
        "task": manifest.task.kind,
        "senses": tuple(infant.senses),
        "observations": tuple(f"{name} {space.shape}" for name, space in arrays.spaces.items()),
        **{f"numbers of '{name}'": infant.layout(name) for name in infant.senses if name != "touch"},
    }


def _difference(ours: Any, theirs: Any) -> str:
    if not (isinstance(ours, tuple) and isinstance(theirs, tuple)):
        return f"{ours or 'none'}, {theirs or 'none'}"
    only = [
        f"only {whose} has {first_of(sorted(set(mine) - set(others)))}"
        for whose, mine, others in (("the first", ours, theirs), ("the other", theirs, ours))
        if set(mine) - set(others)
    ]
    return ", ".join(only) or "in another order"


def first_of(names: Sequence[str]) -> str:
    """List the first few of some names, and how many more there are."""
    shown = ", ".join(names[:MAX_LISTED])
    return shown if len(names) <= MAX_LISTED else f"{shown} and {len(names) - MAX_LISTED} more"
