"""Simulating a recording again, from its seeds and actions, to see whether every number comes out again to the bit."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from operator import itemgetter
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.base.errors import MimocError, RecordingError
from mimoc.bundle.io import Bundle
from mimoc.bundle.physics_state import check_physics, set_physics
from mimoc.recording import frames, tables
from mimoc.recording.blocks import Array, Block, Reading
from mimoc.recording.columns import OBSERVATION
from mimoc.recording.folder import versions
from mimoc.recording.observer import ACTION, NOTHING_YET, spaces_of
from mimoc.recording.reading import Episode, ReadRecording
from mimoc.recording.record import Watch
from mimoc.recording.state_text import is_same
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.growing import AGE, AROUSAL, SEED
from mimoc.runtime.sense import Observation

Number = tuple[int, str, int, float, float]
"""Row, array, index in it, and both values of a number that differs."""
ALLOWED_LATER = "truncated"
"""A limit of steps around the environment ends an episode, of which the infant itself knows nothing."""


@dataclass(frozen=True, slots=True)
class Difference:
    """The first number of an episode that is not as it was recorded."""

    step: int
    """Control steps before it."""
    what: str
    """The array that it is in, such as `proprioception`, `reward` or `state`."""
    name: str
    """Which number of it, with its unit, as far as it has a name."""
    recorded: float
    now: float

    def __str__(self) -> str:
        """Return it in one line."""
        of = f" {self.name}" if self.name else ""
        if np.isnan(self.recorded) and np.isnan(self.now):
            return f"step {self.step}: {self.what}{of} differs"
        by = abs(self.now - self.recorded)
        return f"step {self.step}: {self.what}{of} was {self.recorded:.9g}, is {self.now:.9g} (by {by:.3g})"


def state_differs(step: int, recorded: Mapping[str, Any], now: Mapping[str, Any]) -> Difference | None:
    """Compare two complete states; return the first part that differs."""
    for part, ours in recorded.items():
        theirs = now.get(part)
        if not is_same(ours, theirs):
            number = None
            if isinstance(ours, np.ndarray) and isinstance(theirs, np.ndarray) and ours.shape == theirs.shape:
                number = _first(part, ours[None], theirs[None])
            name, values = (f"{part} {number[2]}", number[3:]) if number else (part, (np.nan, np.nan))
            return Difference(step, "state", name, *values)
    return None


def _first(what: str, recorded: Array, now: Array) -> Number | None:
    """Return the first number whose bits differ."""
    ours, theirs = (np.ascontiguousarray(array).reshape(len(array), -1) for array in (recorded, now))
    if ours.dtype != theirs.dtype:
        ours, theirs = ours.astype(float), theirs.astype(float)
    differs = ours.view(f"u{ours.itemsize}") != theirs.view(f"u{ours.itemsize}")  # -0.0 is not 0.0, and NaN is NaN.
    if not differs.any():
        return None
    row, index = np.argwhere(differs)[0].tolist()
    return row, what, index, float(ours[row, index]), float(theirs[row, index])


def _label(episode: Episode, what: str, index: int) -> str:
    """Return the name of a number in an array of the observation, or where it is in a picture."""
    reading = {reading.name: reading for reading in episode.described.readings}.get(what)
    if reading is None or index >= reading.size:  # A number of the info may have the name of an observation.
        return ""
    if reading.layout:
        return f"'{reading.layout[index]}'"
    at = ", ".join(str(place) for place in np.unravel_index(index, reading.shape or (1,)))
    return f"at ({at})"


def _frames(episode: Episode, reading: Reading) -> Iterator[Any]:
    paths = episode.videos(reading.name)
    for path in paths:
        yield from frames.decoded(path, reading.shape, episode.sidecar.rows)
    raise RecordingError(f"{paths[-1]}: there are fewer pictures in it than control steps")


ROWS = 250
"""Rows that are compared at once."""
_SHOWN = 300
"""Most characters of an error about what is in a file."""
Open = Callable[[Bundle, bool], InfantEnv]
"""Opens the environment of a bundle; the flag says whether it needs scenes of other seeds, too."""


@dataclass(frozen=True, slots=True)
class Replayed:
    """What came of an episode that was simulated again."""

    episode: Episode
    difference: Difference | None
    """The first number that is different now; None if all are the same."""

    @property
    def other_versions(self) -> str:
        """What software has another version now, which may be why; empty if all are the same."""
        software = versions()
        changed = {name: then for name, then in self.episode.versions.items() if software.get(name) != then}
        return ", ".join(f"{name} {then}, now {software.get(name, 'none')}" for name, then in changed.items())

    def __str__(self) -> str:
        """Return it in one line."""
        which = f"infant {self.episode.infant}, episode {self.episode.number}"
        if self.difference is None:
            return f"{which}: all numbers of {self.episode.steps} control steps came out again"
        changed = self.other_versions
        return f"{which}, {self.difference}" + (f"; recorded with {changed}" if changed else "")


def replay(
    recording: ReadRecording,
    open_env: Open,
    *,
    episodes: Sequence[Episode] | None = None,
    watch: Watch = lambda env, observation: None,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Iterator[Replayed]:
    """Simulate episodes again, by default all, and yield what came of each; see `mimoc.replay_recording`."""
    chosen = recording.episodes if episodes is None else tuple(episodes)
    total, done = sum(episode.steps for episode in chosen), 0
    for infant in dict.fromkeys(episode.infant for episode in chosen):
        same_infant = [episode for episode in chosen if episode.infant == infant]
        bundle = recording.bundle(infant)
        env = open_env(bundle, any(_other_scene(episode, bundle.manifest.seed) for episode in same_infant))
        try:
            for episode in same_infant:
                _check_observations(env, episode)
                again = _Replay(env, episode, watch, lambda steps, before=done: progress(before + steps, total))
                yield Replayed(episode, again())
                done += episode.steps
        finally:
            env.close()


class _Replay:
    """One episode that is simulated again."""

    def __init__(self, env: InfantEnv, episode: Episode, watch: Watch, progress: Callable[[int], None]):
        self._env, self._episode, self._watch, self._progress = env, episode, watch, progress
        pictures = [reading for reading in episode.described.readings if reading.kind == "picture"]
        self._pictures = {reading.name: _frames(episode, reading) for reading in pictures}
        self._dtype, self._block = np.dtype(ACTION), self._new_block(0)

    def __call__(self) -> Difference | None:
        """Return the first difference."""
        place = self._episode.files.sidecars[0]
        try:
            observation, info = self._begin()
        except (MimocError, ValueError) as error:
            raise RecordingError(f"{place}: cannot be begun again: {_in_a_line(error)}") from None
        self._watch(self._env, observation)
        difference = state_differs(0, self._episode.start, self._env.get_state())
        difference = self._differs(None, (*NOTHING_YET, info), observation) or difference
        for step, action in enumerate(self._episode.actions):
            if difference:
                return difference
            for what, value in self._episode.changes.get(step, []):
                self._change(what, value)
            action = self._as_given(action)
            observation, *judged = self._env.step(action)
            self._watch(self._env, observation)
            difference = self._differs(action, tuple(judged), observation)
            if step + 1 in self._episode.states:
                state = state_differs(step + 1, self._episode.states[step + 1], self._env.get_state())
                difference = difference or (state and (self._compared() or state))
            self._progress(step + 1)
        return difference or self._compared()

    def _begin(self) -> tuple[Observation, dict[str, Any]]:
        """Reset the infant as it was, going on from the same random numbers; or restore the state it began in."""
        env, episode = self._env, self._episode
        with _damage_message(episode):
            if (before := episode.before) is None:
                return self._restore(episode.start), {}
            if before[SEED] != env.manifest.seed:
                env.reset(options={SEED: before[SEED], AGE: before[AGE]})
            env.set_state({**env.get_state(), **before})
        return env.reset(seed=episode.seed, options=dict(episode.options))

    def _restore(self, state: Mapping[str, Any]) -> Observation:
        """Restore a state; those that were recorded before infants had an arousal lack it."""
        return self._env.set_state({AROUSAL: self._env.arousal, **state})

    def _change(self, what: str, value: Any) -> None:
        """Do again what was done besides control steps."""
        env = self._env
        with _damage_message(self._episode):
            if what == "age_months":
                env.grow(to=value)
            elif what == "state":
                self._restore(value)
            elif what == "expression":
                env.set_expression(value)
            elif what == "arousal":
                env.set_arousal(value)
            elif what == "order":
                env.companions[value["companion"]].obey(value["order"])
            elif what == "physics":
                check_physics(value, env.model)
                set_physics(env.model, env.data, value)
            elif what == "action_dtype":
                self._dtype = np.dtype(value)
                if self._dtype.kind not in "biuf":
                    raise ValueError(f"'{value}' is not a type of numbers")

    def _as_given(self, action: npt.NDArray[np.float64]) -> Any:
        """Return an action in the type of numbers in which it was given."""
        with np.errstate(over="ignore", invalid="ignore"):
            given = action.astype(self._dtype)
        if not np.isfinite(given).all():
            problem = f"'action_dtype' is {self._dtype}, which cannot hold the action {action.max()}"
            raise RecordingError(f"{self._episode.files.sidecars[0]}: {problem}")
        return given

    def _differs(self, action: Any, judged: Any, observation: Observation) -> Difference | None:
        """Keep a row, and compare when there are enough."""
        self._block.put(self._env.data.time, action, judged, observation)
        return self._compared() if self._block.is_full else None

    def _compared(self) -> Difference | None:
        """Compare the rows that were kept since the last comparison; return the first difference in time."""
        block = self._block
        if not block.rows:
            return None
        self._block = self._new_block(block.first_step + block.rows)
        rows = self._episode.table.slice(block.first_step, block.rows)
        numbers = [number for number in self._differences(rows, block) if number is not None]
        if not numbers:
            return None
        row, what, index, recorded, now = min(numbers, key=itemgetter(0))
        return Difference(block.first_step + row, what, _label(self._episode, what, index), recorded, now)

    def _differences(self, rows: Any, block: Block) -> Iterator[Number | None]:
        """Yield the first number of each array that differs, if there is one."""
        for reading in block.readings:
            name = reading.name
            if reading.kind == "picture":
                recorded = np.stack([next(self._pictures[name]) for _ in range(block.rows)])
            else:
                recorded = tables.array_of(rows, OBSERVATION + name, reading)
            is_sparse = reading.kind == "sparse"
            now = block.sparse[name].dense(block.rows, reading.size) if is_sparse else block.dense[name][: block.rows]
            yield _first(name, recorded, now)
        terms = {name for name in rows.column_names if name.startswith("term.")}
        for name in sorted(block.numbers.keys() | terms):
            now = block.numbers.get(name, np.full(block.room, np.nan))[: block.rows]
            known = name in rows.column_names
            recorded = tables.array_of(rows, name) if known else np.full_like(now, np.nan if now.dtype == float else 0)
            if name == ALLOWED_LATER:
                recorded = recorded & now
            yield _first(name.partition(".")[2] or name, recorded, now)

    def _new_block(self, first_step: int) -> Block:
        described = self._episode.described
        return Block(described.readings, len(described.actions), ROWS, first_step)


@contextmanager
def _damage_message(episode: Episode) -> Iterator[None]:
    """Turn what a damaged state or value leads to into one clear line."""
    try:
        yield
    except (LookupError, TypeError, AttributeError, ValueError, OverflowError) as error:
        problem = f"a state or a change is damaged ({type(error).__name__}: {_in_a_line(error)})"
        raise RecordingError(f"{episode.files.sidecars[0]}: {problem}") from None


def _in_a_line(error: Exception) -> str:
    """Return the beginning of what an error says, which may be of a stranger's array, in one line."""
    text = " ".join(str(error).split())
    return "".join(character for character in text[:_SHOWN] if character.isprintable())


def _other_scene(episode: Episode, seed: int) -> bool:
    """Return whether an episode is in another scene than its bundle, or comes from one."""
    with _damage_message(episode):
        seeds = [episode.start[SEED], *([episode.before[SEED]] if episode.before else [])]
        seeds += [value[SEED] for changes in episode.changes.values() for what, value in changes if what == "state"]
    return any(scene_seed != seed for scene_seed in seeds)


def _check_observations(env: InfantEnv, episode: Episode) -> None:
    """Check that an environment observes what was recorded."""
    observed = {name: (space.shape, space.dtype.name) for name, space in spaces_of(env).items()}
    for reading in episode.described.readings:
        if observed.get(reading.name) != (reading.shape, reading.dtype):
            raise RecordingError(
                f"infant {episode.infant}, episode {episode.number}: the observation '{reading.name}' of shape"
                f" {reading.shape} and type {reading.dtype} is recorded, but the infant does not have it now"
            )
    if env.action_space.shape != np.shape(episode.described.actions):
        raise RecordingError(f"infant {episode.infant}, episode {episode.number}: it has other actuators now")
