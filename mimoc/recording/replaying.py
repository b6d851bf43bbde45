"""Simulating recordings again: in environments that are opened from the bundles they contain."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from copy import deepcopy
from dataclasses import dataclass
from operator import itemgetter
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.base.classes import PATH, takes
from mimoc.base.errors import MimocError, RecordingError
from mimoc.bundle.io import Bundle
from mimoc.bundle.model import check_physics, set_physics
from mimoc.bundle.world import WorldBundle
from mimoc.recording import tables
from mimoc.recording.columns import OBSERVATION, Array, Block, Reading
from mimoc.recording.description import Change, is_same
from mimoc.recording.folder import versions
from mimoc.recording.observer import ACTION, NOTHING_YET, spaces_of
from mimoc.recording.reading import Episode, ReadRecording, read_recording
from mimoc.recording.record import Watch
from mimoc.recording.video import decoded
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.growing import SEED
from mimoc.runtime.infant import AGE, NO_OBSERVER, Infant, Observer
from mimoc.runtime.opening import open_bundle
from mimoc.runtime.sense import Observation
from mimoc.runtime.simulation import INFANTS, Simulation
from mimoc.runtime.world_env import WorldEnv

Number = tuple[int, str, int, float, float]  # Row, array, index in it, and both values of a number that differs.
ALLOWED_LATER = "truncated"
"""A limit of steps around the environment ends an episode, of which the infant itself knows nothing."""


@dataclass(frozen=True, slots=True)
class Difference:
    """The first number of an episode that is not as it was recorded."""

    step: int  # Control steps before it.
    what: str  # The array that it is in, such as `proprioception`, `reward` or `state`.
    name: str  # Which number of it, with its unit, as far as it has a name.
    recorded: float
    now: float

    def __str__(self) -> str:
        of = f" {self.name}" if self.name else ""
        if np.isnan(self.recorded) and np.isnan(self.now):
            return f"step {self.step}: {self.what}{of} differs"
        by = abs(self.now - self.recorded)
        return f"step {self.step}: {self.what}{of} was {self.recorded:.9g}, is {self.now:.9g} (by {by:.3g})"


def state_differs(step: int, recorded: Mapping[str, Any], now: Mapping[str, Any]) -> Difference | None:
    """Compare two complete states; return the first part that differs."""
    recorded, now = _flat(recorded), _flat(now)
    for part, ours in recorded.items():
        theirs = now.get(part)
        if not is_same(ours, theirs):
            number = None
            if isinstance(ours, np.ndarray) and isinstance(theirs, np.ndarray) and ours.shape == theirs.shape:
                number = _first(part, ours[None], theirs[None])
            name, values = (f"{part} {number[2]}", number[3:]) if number else (part, (np.nan, np.nan))
            return Difference(step, "state", name, *values)
    return None


def _flat(state: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the parts of a state, those of the infants of a world by their names and what they are."""
    of_infants = state.get(INFANTS, {})
    parts = {f"{name} {what}": part for name, parts in of_infants.items() for what, part in parts.items()}
    return {name: part for name, part in state.items() if name != INFANTS} | parts


def _first(what: str, recorded: Array, now: Array) -> Number | None:
    ours, theirs = (np.ascontiguousarray(array).reshape(len(array), -1) for array in (recorded, now))
    if ours.dtype != theirs.dtype:
        ours, theirs = ours.astype(float), theirs.astype(float)
    differs = ours.view(f"u{ours.itemsize}") != theirs.view(f"u{ours.itemsize}")  # -0.0 is not 0.0, and NaN is NaN.
    if not differs.any():
        return None
    row, index = np.argwhere(differs)[0].tolist()
    return row, what, index, float(ours[row, index]), float(theirs[row, index])


def _label(episode: Episode, what: str, index: int) -> str:
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
        yield from decoded(path, reading.shape, episode.sidecar.rows)
    raise RecordingError(f"{paths[-1]}: there are fewer pictures in it than control steps")


ROWS = 250  # Rows that are compared at once.
_MAX_SHOWN = 300  # Most characters of an error about what is in a file.
Open = Callable[[Bundle | WorldBundle, bool], Any]
"""Opens the environment of a bundle, or the world; the flag says whether it needs scenes of other seeds, too."""
ALONE = ""  # Name of an infant that is alone in its simulation.


@dataclass(frozen=True, slots=True)
class Replayed:
    """What came of an episode that was simulated again."""

    episode: Episode
    difference: Difference | None  # The first number that is different now; None if all are the same.
    steps: int  # Control steps that were simulated again: of a world that was killed, those that all its infants have.

    @property
    def other_versions(self) -> str:
        """What software has another version now, which may be why; empty if all are the same."""
        software = versions()
        changed = {name: then for name, then in self.episode.versions.items() if software.get(name) != then}
        return ", ".join(f"{name} {then}, now {software.get(name, 'none')}" for name, then in changed.items())

    def __str__(self) -> str:
        which = f"infant {self.episode.infant}, episode {self.episode.number}"
        if self.difference is None:
            return f"{which}: all numbers of {self.steps} control steps came out again"
        changed = self.other_versions
        return f"{which}, {self.difference}" + (f"; recorded with {changed}" if changed else "")


def open_recorded(bundle: Bundle | WorldBundle, other_scenes: bool = False) -> Any:
    """Return the environment of a bundle, or the world, at the ages and in the scene of the bundle."""
    return WorldEnv(bundle) if isinstance(bundle, WorldBundle) else InfantEnv(bundle)


def replay(
    recording: ReadRecording,
    open_env: Open,
    *,
    episodes: Sequence[Episode] | None = None,
    watch: Watch = lambda env, observation: None,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Iterator[Replayed]:
    """Simulate episodes again, by default all, and yield what came of each; see `mimoc.replay_recording`.

    The episodes of infants that share a world are simulated together, those that are not chosen as well.
    """
    if recording.description.note:
        raise RecordingError(f"{recording.path}: cannot be replayed: {recording.description.note}")
    chosen = recording.episodes if episodes is None else tuple(episodes)
    by_run = dict[tuple[tuple[int, ...], int], list[Episode]]()
    for episode in chosen:
        by_run.setdefault((recording.description.sharing(episode.infant), episode.number), []).append(episode)
    runs = {key: recording.run_of(wanted[0]) for key, wanted in by_run.items()}
    total, done = sum(map(_steps_of, runs.values())), 0
    for sharing in dict.fromkeys(sharing for sharing, _ in sorted(runs)):
        whole = recording.whole_bundle(sharing[0])
        numbers = sorted(number for key, number in runs if key == sharing)
        seed = whole.manifest.seed
        env = open_env(whole, any(_other_scene(one, seed) for number in numbers for one in runs[sharing, number]))
        is_world = isinstance(whole, WorldBundle)
        names = {number: recording.description.infants[number].name if is_world else ALONE for number in sharing}
        try:
            for number in numbers:
                run, wanted = runs[sharing, number], by_run[sharing, number]
                again = _Replay(
                    env, names, run, wanted, watch, lambda steps, before=done: progress(before + steps, total)
                )
                differences = again()
                for episode in wanted:
                    yield Replayed(episode, differences[episode.infant], min(episode.steps, _steps_of(run)))
                done += _steps_of(run)
        finally:
            env.close()


def _steps_of(run: Sequence[Episode]) -> int:
    going_on = [episode.steps for episode in run if episode.ended not in ("terminated", "truncated")]
    return min(going_on) if going_on else max(episode.steps for episode in run)


class _Replay:
    """A run of one infant, or of a world of several, that is simulated again."""

    def __init__(
        self,
        env: Any,
        names: Mapping[int, str],
        run: Sequence[Episode],
        wanted: Sequence[Episode],
        watch: Watch,
        progress: Callable[[int], None],
    ):
        self._names, self._run, self._wanted = names, run, wanted
        self._simulation: Simulation = env.simulation
        self._whole = env if ALONE in self._simulation.infants else env.simulation
        """Has complete states as they are recorded."""
        self._infants = self._simulation.infants
        self._watch = watch
        self._progress = progress
        if missing := [name for name in names.values() if name not in self._infants]:
            raise RecordingError(f"{run[0].files.sidecars[0]}: there is no infant '{missing[0]}' in this world")
        self._compared = {names[one.infant]: _Comparison(self._infants[names[one.infant]], one) for one in run}
        self._changes = list[tuple[int, int, Episode, Change]]()
        for episode in run:
            for change in episode.sidecar.changes:
                number = episode.infant if change.infant is None else change.infant
                self._changes.append((change.step, number, episode, change))
        self._changes.sort(key=itemgetter(0))

    def __call__(self) -> dict[int, Difference | None]:
        first, comparisons = self._run[0], self._compared.values()
        try:
            observations, infos = self._begin()
        except (MimocError, ValueError) as error:
            raise RecordingError(f"{first.files.sidecars[0]}: cannot be begun again: {_in_a_line(error)}") from None
        for name, comparison in self._compared.items():
            comparison.begin(observations[name], infos.get(name, {}))
            self._infants[name].observer = comparison
        self._show(0, observations)
        try:
            for step in range(_steps_of(self._run)):
                if all(comparison.difference for comparison in comparisons):
                    break
                self._change(step)
                self._show(step + 1, self._step(step))
                self._progress(step + 1)
        finally:
            for infant in self._infants.values():
                infant.observer = NO_OBSERVER
        return {one.infant: self._compared[self._names[one.infant]].end() for one in self._run}

    def _begin(self) -> tuple[Mapping[str, Observation], Mapping[str, Any]]:
        """Reset the infants as they were, going on from the same random numbers; or restore the state they began in."""
        first, simulation = self._run[0], self._simulation
        with _damage_message(first):
            if (before := first.before) is None:
                self._whole.set_state(first.start)
                return simulation.observe(), {}
            if before[SEED] != simulation.seed:
                ages = {name: {AGE: infant[AGE]} for name, infant in before.get(INFANTS, {ALONE: before}).items()}
                simulation.reset(options=ages, scene_seed=before[SEED])
            self._whole.set_state(_merged(self._whole.get_state(), before))
            seeds = {self._names[one.infant]: one.seed for one in self._run}
            options = {self._names[one.infant]: dict(one.options) for one in self._run}
            scene_seed = first.start[SEED]
        begun = simulation.reset(seeds, options, None if scene_seed == simulation.seed else scene_seed)
        return {name: start[0] for name, start in begun.items()}, {name: start[1] for name, start in begun.items()}

    def _step(self, step: int) -> Mapping[str, Observation]:
        """Make a control step with the recorded actions; those without one, who had ended, command nothing."""
        actions = {name: comparison.action(step) for name, comparison in self._compared.items()}
        stepped = self._simulation.step({name: action for name, action in actions.items() if action is not None})
        return {name: result[0] for name, result in stepped.items()}

    def _show(self, step: int, observations: Mapping[str, Observation]) -> None:
        for episode in self._wanted:
            name = self._names[episode.infant]
            if step <= episode.steps and name in observations:
                self._watch(self._infants[name], observations[name])
                return

    def _change(self, step: int) -> None:
        while self._changes and self._changes[0][0] <= step:
            _, number, episode, change = self._changes.pop(0)
            what, value = episode.change(change)
            with _damage_message(episode):
                name = self._names[number]
                infant = self._infants[name]
                if what == "age_months":
                    self._simulation.grow({name: value})
                elif what == "state":
                    self._whole.set_state(value)
                elif what == "expression":
                    infant.set_expression(value)
                elif what == "arousal":
                    infant.set_arousal(value)
                elif what == "order":
                    infant.companions[value["companion"]].obey(value["order"])
                elif what == "physics":
                    check_physics(value, infant.model)
                    set_physics(infant.model, infant.data, value)
                elif what == "action_dtype":
                    self._compared[name].act_in(value)


def _merged(state: Mapping[str, Any], kept: Mapping[str, Any]) -> dict[str, Any]:
    merged = {**state, **kept}
    if INFANTS in kept:
        merged[INFANTS] = {name: {**part, **kept[INFANTS].get(name, {})} for name, part in state[INFANTS].items()}
    return merged


class _Comparison(Observer):
    """Compares what one infant does and observes with an episode of it."""

    keeps = True

    def __init__(self, infant: Infant, episode: Episode):
        _check_observations(infant, episode)
        self._infant, self._episode = infant, episode
        self.difference: Difference | None = None
        pictures = [reading for reading in episode.described.readings if reading.kind == "picture"]
        self._pictures = {reading.name: _frames(episode, reading) for reading in pictures}
        self._dtype, self._block, self._steps = np.dtype(ACTION), self._new_block(0), 0

    def begin(self, observation: Observation, info: Mapping[str, Any]) -> None:
        if self._episode.sidecar.start:
            self.difference = state_differs(0, self._episode.start, self._infant.get_state())
        self._put(None, (*NOTHING_YET, info), observation)

    def action(self, step: int) -> Any:
        """Return an action in the type of numbers in which it was given; None after the end of the episode."""
        if step >= self._episode.steps:
            return None
        action = self._episode.actions[step]
        with np.errstate(over="ignore", invalid="ignore"):
            given = action.astype(self._dtype)
        if not np.isfinite(given).all():
            problem = f"'action_dtype' is {self._dtype}, which cannot hold the action {action.max()}"
            raise RecordingError(f"{self._episode.files.sidecars[0]}: {problem}")
        return given

    def act_in(self, dtype: str) -> None:
        """Take actions in a type of numbers from now on."""
        self._dtype = np.dtype(dtype)
        if self._dtype.kind not in "biuf":
            raise ValueError(f"'{dtype}' is not a type of numbers")

    def stepped(
        self, action: npt.NDArray[Any], observation: Observation, judged: tuple[float, bool, bool, Mapping[str, Any]]
    ) -> None:
        self._steps += 1
        if self.difference or self._steps > self._episode.steps:
            return
        self._put(action, judged, observation)
        if self._steps in self._episode.states:
            state = state_differs(self._steps, self._episode.states[self._steps], self._infant.get_state())
            self.difference = self.difference or (state and (self._compared() or state))

    def end(self) -> Difference | None:
        self.difference = self.difference or self._compared()
        return self.difference

    def _put(self, action: Any, judged: Any, observation: Observation) -> None:
        self._block.put(self._infant.data.time, action, judged, observation)
        if self._block.is_full:
            self.difference = self._compared() or self.difference

    def _compared(self) -> Difference | None:
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
    try:
        yield
    except (LookupError, TypeError, AttributeError, ValueError, OverflowError) as error:
        problem = f"a state or a change is damaged ({type(error).__name__}: {_in_a_line(error)})"
        raise RecordingError(f"{episode.files.sidecars[0]}: {problem}") from None


def _in_a_line(error: Exception) -> str:
    """Return the beginning of what an error says, which may be of a stranger's array, in one line."""
    text = " ".join(str(error).split())
    return "".join(character for character in text[:_MAX_SHOWN] if character.isprintable())


def _other_scene(episode: Episode, seed: int) -> bool:
    """Return whether an episode is in another scene than its bundle, or comes from one."""
    with _damage_message(episode):
        states = [episode.start, episode.before or {}]
        states += [value for changes in episode.changes.values() for what, value in changes if what == "state"]
        return any(state.get(SEED, seed) != seed for state in states)


def _check_observations(env: Infant, episode: Episode) -> None:
    observed = {name: (space.shape, space.dtype.name) for name, space in spaces_of(env).items()}
    for reading in episode.described.readings:
        if observed.get(reading.name) != (reading.shape, reading.dtype):
            raise RecordingError(
                f"infant {episode.infant}, episode {episode.number}: the observation '{reading.name}' of shape"
                f" {reading.shape} and type {reading.dtype} is recorded, but the infant does not have it now"
            )
    if env.action_space.shape != np.shape(episode.described.actions):
        raise RecordingError(f"infant {episode.infant}, episode {episode.number}: it has other actuators now")


NONE: Mapping[str, Any] = MappingProxyType({})


@takes("a recording, or the folder of one", ReadRecording, *PATH)
def replay_recording(
    recording: ReadRecording | str | Path,
    *,
    infant: int | str | None = None,
    episode: int | None = None,
    task: Any = None,
    senses: Mapping[str, Any] = NONE,
    companions: Mapping[str, Any] = NONE,
    watch: Watch = lambda env, observation: None,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Iterator[Replayed]:
    """Simulate a recording again, and yield for each episode the first number that did not come out again, if any.

    With the same version of MuJoCo on the same type of machine, every number is the same to the bit.

    Args:
        recording: The recording, or its folder.
        infant: Only the episodes of this one, given by its number or its name.
        episode: Only the episode of this number of each infant.
        task: A task of the script's own that was recorded, as for `mimoc.make`; of a world, tasks by infant.
        senses: Likewise senses, by name.
        companions: Likewise companions, by name.
        watch: Called with an infant and its observation after each reset and each control step; of a world, with the
            first of the chosen infants whose episode goes on.
        progress: Called with the number of control steps done and their total.

    Raises:
        RecordingError: If this is no recording, it is damaged, has no such episodes, or needs such objects.
        RenderingError: If the infant has vision, and there is no OpenGL here.

    Example:
        >>> import mimoc
        >>> [replayed.difference for replayed in mimoc.replay_recording("recordings/reach")]
        [None]
    """
    opened = recording if isinstance(recording, ReadRecording) else read_recording(recording)
    episodes = chosen_episodes(opened, infant, episode)
    for one in episodes:
        given = _given(opened, one.infant, task, senses, companions)
        for what, name in one.objects.items():
            if what not in given:
                raise RecordingError(f"{opened.path}: recorded with {what} of a script's own ({name}); pass it as well")

    def open_env(bundle: Bundle | WorldBundle, other_scenes: bool) -> Any:
        objects: Any = deepcopy({"senses": dict(senses), "companions": dict(companions)})
        if isinstance(bundle, WorldBundle):
            from mimoc.compiler.variants import WorldBundleVariants, WorldVariants, plan_of_bundle

            variants = WorldVariants(plan_of_bundle(bundle)) if other_scenes else WorldBundleVariants(bundle)
            return WorldEnv(bundle, variants=variants, tasks=deepcopy(task or {}), **objects)
        return open_bundle(bundle, other_scenes, task=deepcopy(task), **objects)

    return replay(opened, open_env, episodes=episodes, watch=watch, progress=progress)


def _given(
    recording: ReadRecording, infant: int, task: Any, senses: Mapping[str, Any], companions: Mapping[str, Any]
) -> set[str]:
    about = recording.description.infants[infant]
    if about.world is not None:
        task, senses, companions = (by_name.get(about.name, {}) for by_name in (task or {}, senses, companions))
        task = task or None
    given = {f"senses.{name}" for name in senses} | {f"companions.{name}" for name in companions}
    return given | ({"task"} if task is not None else set())


def chosen_episodes(recording: ReadRecording, infant: int | str | None, episode: int | None) -> Sequence[Episode]:
    """Return the episodes of an infant, of a number, or all, or raise a RecordingError if there are none."""
    if infant is not None:
        infant = recording.infant_number(infant)
    chosen = [one for one in recording if infant in (None, one.infant) and episode in (None, one.number)]
    if not chosen:
        which = [f"{name} {value}" for name, value in (("infant", infant), ("episode", episode)) if value is not None]
        raise RecordingError(f"{recording.path}: there is nothing recorded{' of ' if which else ''}{', '.join(which)}")
    return chosen
