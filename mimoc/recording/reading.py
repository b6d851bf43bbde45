"""Reading recordings: episodes with arrays, and tables for pandas."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from mimoc.bundle.io import Bundle, read_bundle
from mimoc.bundle.regular_files import is_regular_file
from mimoc.errors import BundleError, RecordingError, UnknownNameError
from mimoc.recording import frames, tables
from mimoc.recording.blocks import Array, Reading
from mimoc.recording.episode_writer import read_sidecars
from mimoc.recording.folder import EpisodeFiles, bundle_folder, digest, episodes_in, read_description
from mimoc.recording.state_text import from_plain
from mimoc.recording.tables import OBSERVATION, Described


@dataclass(frozen=True)
class Episode:
    """One episode of a recording: k + 1 rows for k control steps, of which the first is what was observed before.

    Arrays are read when they are first asked for, and kept.
    """

    files: EpisodeFiles
    """Where it is."""

    def __repr__(self) -> str:
        """Return which episode it is, and its length."""
        return f"Episode(infant={self.infant}, number={self.number}, steps={self.steps}, ended={self.ended!r})"

    @property
    def infant(self) -> int:
        """Which of the infants that were recorded side by side."""
        return self.files.infant

    @property
    def number(self) -> int:
        """Which of its episodes."""
        return self.files.number

    @cached_property
    def told(self) -> Mapping[str, Any]:
        """Content of its sidecar: how it began, all that was done besides its steps, states and versions."""
        return read_sidecars(self.files)

    @property
    def steps(self) -> int:
        """Control steps of it that are recorded."""
        return int(self.told["rows"]) - 1

    @property
    def ended(self) -> str:
        """How it ended: `terminated`, `truncated`, by a `reset`, `closed` with the recording, or `unfinished`.

        Unfinished is an episode that is still being recorded, or was when its process was killed.
        """
        return self.told["ended"]

    @property
    def seed(self) -> int | None:
        """Seed of its reset; None if it went on with the random numbers of the episode before."""
        reset = self.told["reset"]
        return reset and reset["seed"]

    @property
    def bundle_digest(self) -> str:
        """Digest of the infant's bundle."""
        return self.told["bundle"]

    @property
    def versions(self) -> Mapping[str, str]:
        """Versions of the software that it was recorded with."""
        return self.told["versions"]

    @cached_property
    def described(self) -> Described:
        """What its numbers are."""
        return tables.describe(self.files.tables[0])

    @property
    def step_ms(self) -> float:
        """Duration of a control step."""
        return self.described.step_ms

    @property
    def step(self) -> Array:
        """Control steps before each row, shape (k + 1,)."""
        return self.column("step")

    @property
    def time_s(self) -> Array:
        """Simulated time, shape (k + 1,)."""
        return self.column("time_s")

    @property
    def actions(self) -> Array:
        """The action of each control step, shape (k, actuators), as it was given, before it was clipped."""
        return self.column("action")[1:]

    @property
    def rewards(self) -> Array:
        """The reward of each control step, shape (k,)."""
        return self.column("reward")[1:]

    @property
    def terminated(self) -> Array:
        """Whether each control step ended the episode, shape (k,)."""
        return self.column("terminated")[1:]

    @property
    def truncated(self) -> Array:
        """Whether each control step was the last one allowed, shape (k,)."""
        return self.column("truncated")[1:]

    @property
    def reward_terms(self) -> dict[str, Array]:
        """Terms of the rewards by name, each of shape (k,); NaN where there is none."""
        return self._named("term.")

    @property
    def infos(self) -> dict[str, Array]:
        """What else `info` says of each control step, by name, each of shape (k,)."""
        return self._named("info.")

    @cached_property
    def observations(self) -> Mapping[str, Array]:
        """What was observed before the first control step and after each, by name, each of shape (k + 1, ...)."""
        return {reading.name: self.observation(reading.name) for reading in self.described.readings}

    def observation(self, name: str) -> Array:
        """Return one array of what was observed, shape (k + 1, ...), such as `proprioception` or `eye_left`.

        Raises:
            UnknownNameError: If there is none of this name.
            RecordingError: If its file is damaged.
        """
        reading = self.reading(name)
        if reading.kind != "picture":
            with tables.damage_told(self.files.tables[0]):
                return tables.array_of(self.table, OBSERVATION + name, reading)
        count = len(self.step)
        if len(self.files.stems) == 1:
            return frames.read_pictures(self.files.pictures(name, frames.LOSSLESS)[0], count, reading.shape)
        paths = self.files.pictures(name, frames.LOSSLESS)
        return np.stack([picture for path in paths for picture in frames.some_pictures(path, reading.shape, count)])

    def layout(self, name: str) -> tuple[str, ...]:
        """Return name and unit of each number of an observation, or of `action`, as `InfantEnv.layout` does.

        Raises:
            UnknownNameError: If there is none of this name.
        """
        return self.described.actions if name == "action" else self.reading(name).layout

    @cached_property
    def table(self) -> Any:
        """All rows as an Arrow table, as they are in the file."""
        table = tables.read_columns(self.files.tables)
        if len(table) != self.told["rows"]:
            raise RecordingError(f"{self.files.tables[0]}: the file is damaged: rows are missing")
        return table

    def columns(self, *names: str) -> dict[str, Array]:
        """Return columns of numbers by name, each of shape (k + 1,): `pandas.DataFrame(episode.columns())`.

        Args:
            names: `action` and observations to be taken, each number of which is a column with its unit in its name;
                without any, `action` and those that are not touch or pictures. Step, time, reward and infos are always
                included.

        Raises:
            UnknownNameError: If there is no observation of this name, or it is one of pictures.
        """
        found = {name: self.column(name) for name in self.table.column_names if name != "action" and "." not in name}
        found |= {name: self.column(name) for name in self.table.column_names if name.startswith(("term.", "info."))}
        usual = ["action", *(reading.name for reading in self.described.readings if reading.kind == "dense")]
        for name in names or usual:
            array = self.column("action") if name == "action" else self._numbers(name)
            flat = array.reshape(len(array), -1)
            layout = self.layout(name) or [f"{index}" for index in range(flat.shape[1])]
            found |= {f"{name}: {label}": flat[:, index] for index, label in enumerate(layout)}
        return found

    @property
    def options(self) -> Mapping[str, Any]:
        """Options of its reset."""
        reset = self.told["reset"]
        return from_plain(reset["options"]) if reset else {}

    @property
    def before(self) -> Any:
        """What its reset went on from: parts of a state; None if it began without a reset."""
        reset = self.told["reset"]
        return reset and from_plain(reset["before"])

    @property
    def objects(self) -> Mapping[str, str]:
        """Classes of the objects of a script's own that it was recorded with, by what they are."""
        return self.told.get("objects", {})

    @property
    def start(self) -> Any:
        """The complete state before the first control step, for `InfantEnv.set_state`."""
        return from_plain(self.told["start"])

    @cached_property
    def states(self) -> dict[int, Any]:
        """Complete states after some numbers of control steps."""
        return {each["step"]: from_plain(each["state"]) for each in self.told["states"]}

    @cached_property
    def changes(self) -> dict[int, list[tuple[str, Any]]]:
        """What was done to the infant besides control steps, in order, by the number of steps before it."""
        found: dict[int, list[tuple[str, Any]]] = {}
        for each in self.told["changes"]:
            what = next(name for name in each if name != "step")
            found.setdefault(each["step"], []).append((what, from_plain(each[what])))
        return found

    def column(self, name: str) -> Array:
        """Return a column of the file as an array of k + 1 rows."""
        with tables.damage_told(self.files.tables[0]):
            return tables.array_of(self.table, name)

    def reading(self, name: str) -> Reading:
        """Return what is known of an array of the observation.

        Raises:
            UnknownNameError: If there is none of this name.
        """
        known = {reading.name: reading for reading in self.described.readings}
        if name not in known:
            raise UnknownNameError("recorded observation", name, known)
        return known[name]

    def _numbers(self, name: str) -> Array:
        if self.reading(name).kind == "picture":
            numbers = [reading.name for reading in self.described.readings if reading.kind != "picture"]
            raise UnknownNameError("recorded observation of numbers", name, numbers)
        return self.observation(name)

    def _named(self, prefix: str) -> dict[str, Array]:
        names = [name for name in self.table.column_names if name.startswith(prefix)]
        return {name.removeprefix(prefix): self.column(name)[1:] for name in names}


@dataclass(frozen=True)
class ReadRecording(Sequence[Episode]):
    """A recording: its episodes, by infant and number."""

    path: Path
    """The folder."""
    told: Mapping[str, Any]
    """Content of its `recording.json`."""
    episodes: tuple[Episode, ...]
    """All episodes, those of the first infant first."""

    def __len__(self) -> int:
        """Return how many episodes there are."""
        return len(self.episodes)

    def __getitem__(self, index: Any) -> Any:
        """Return an episode, or several."""
        return self.episodes[index]

    def __iter__(self) -> Iterator[Episode]:
        """Return the episodes, one after the other."""
        return iter(self.episodes)

    def __repr__(self) -> str:
        """Return the folder and the number of episodes."""
        return f"ReadRecording({str(self.path)!r}, {len(self)} episodes)"

    @property
    def infants(self) -> int:
        """How many infants were recorded side by side."""
        return len(self.told["infants"])

    def of_infant(self, infant: int) -> tuple[Episode, ...]:
        """Return the episodes of one infant."""
        return tuple(episode for episode in self.episodes if episode.infant == infant)

    def bundle(self, infant: int = 0) -> Bundle:
        """Return the bundle of an infant.

        Raises:
            RecordingError: If it is missing, damaged, or another one.
        """
        wanted = self.told["infants"][infant]["bundle"]
        home = bundle_folder(self.path, wanted)
        try:
            found = read_bundle(home)
        except BundleError as error:
            raise RecordingError(f"the bundle of this recording cannot be read: {error}") from None
        if digest(found) != wanted:
            raise RecordingError(f"{home}: this is not the bundle that was recorded ({wanted[7:15]})")
        return found

    def summary(self) -> dict[str, list[Any]]:
        """Return a row for each episode: `pandas.DataFrame(recording.summary())`."""
        rows = [
            {
                "infant": episode.infant,
                "episode": episode.number,
                "steps": episode.steps,
                "ended": episode.ended,
                "seed": episode.seed,
                "return": float(np.nansum(episode.rewards)),
                "is_success": bool(episode.infos.get("is_success", np.zeros(1, bool)).any()),
            }
            for episode in self.episodes
        ]
        return {name: [row[name] for row in rows] for name in rows[0]} if rows else {}


def read_recording(folder: str | Path) -> ReadRecording:
    """Read a recording; of an episode that is still being recorded, or was when its process was killed, what is there.

    Args:
        folder: Folder of the recording.

    Raises:
        RecordingError: If it is none, or damaged.
        MissingExtraError: If PyArrow is not installed.
    """
    path = Path(folder).expanduser()
    told = read_description(path)
    episodes = tuple(Episode(each) for each in episodes_in(path))
    for episode in episodes:
        _check(episode, len(told["infants"]))
    return ReadRecording(path, told, episodes)


def _has_head(told: Mapping[str, Any]) -> bool:
    """Return whether a sidecar says, besides what each does, how an episode began."""
    reset = told.get("reset", "missing")
    if isinstance(reset, dict):
        seed = reset.get("seed", "missing")
        is_begun = seed is None or (type(seed) is int and seed >= 0)
        is_begun &= isinstance(reset.get("options"), dict) and isinstance(reset.get("before"), dict)
    else:
        is_begun = reset is None
    texts = [told.get("versions"), told.get("objects", {})]
    return (
        is_begun
        and isinstance(told.get("start"), dict)
        and isinstance(told.get("bundle"), str)
        and isinstance(told["ended"], str)
        and all(isinstance(each, dict) and all(isinstance(text, str) for text in each.values()) for each in texts)
    )


def _check(episode: Episode, infants: int) -> None:
    """Check that what is needed of an episode is there.

    Raises:
        RecordingError: If it is not.
    """
    if episode.infant >= infants or not _has_head(episode.told):
        raise RecordingError(f"{episode.files.sidecars[0]}: the file is damaged or of another recording")
    _check_regular(episode.files.tables)
    for reading in episode.described.readings:
        if reading.kind == "picture":
            _check_regular(episode.files.pictures(reading.name, frames.LOSSLESS))


def _check_regular(paths: Sequence[Path]) -> None:
    for path in paths:
        if not is_regular_file(path):
            raise RecordingError(f"{path}: the file is damaged or missing, or is not a regular file")
