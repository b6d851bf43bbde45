"""Reading recordings: episodes with arrays, and tables for pandas."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from mimoc.base.classes import PATH, takes
from mimoc.base.errors import BundleError, RecordingError, UnknownNameError, check_name
from mimoc.bundle.io import Bundle, read_bundle
from mimoc.bundle.regular_files import is_regular_file
from mimoc.bundle.world import WorldBundle, read_world_bundle
from mimoc.recording import tables
from mimoc.recording.columns import ACTION, MOVEMENT, MOVEMENT_NAMES, OBSERVATION, Array, Described, Reading
from mimoc.recording.description import Change, Description, Sidecar, description_in, from_plain, read_sidecar
from mimoc.recording.folder import EpisodeFiles, bundle_folder, digest, episodes_in
from mimoc.recording.tables import MEASURE, OPTIONAL
from mimoc.recording.video import PICTURES_SUFFIX, read_pictures

LISTS = ACTION, MOVEMENT, MOVEMENT_NAMES  # Columns of the files, each of which holds several columns.


@dataclass(frozen=True)
class Episode:
    """One episode of a recording: k + 1 rows for k control steps, of which the first is what was observed before.

    Arrays are read when they are first asked for, and kept.
    """

    files: EpisodeFiles

    def __repr__(self) -> str:
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
    def sidecar(self) -> Sidecar:
        """Content of its sidecar: how it began, all that was done besides its steps, states and versions."""
        return read_sidecar(self.files.sidecars, below=self.files.folder)

    @property
    def steps(self) -> int:
        """Control steps of it that are recorded."""
        return self.sidecar.rows - 1

    @property
    def ended(self) -> str:
        """How it ended: `terminated`, `truncated`, by a `reset`, `closed` with the recording, or `unfinished`.

        Unfinished is an episode that is still being recorded, or was when its process was killed.
        """
        return self.sidecar.ended

    @property
    def seed(self) -> int | None:
        """Seed of its reset; None if it went on with the random numbers of the episode before."""
        reset = self.sidecar.reset
        return reset and reset.seed

    @property
    def bundle_digest(self) -> str:
        """Digest of the infant's bundle."""
        return self.sidecar.bundle

    @property
    def versions(self) -> Mapping[str, str]:
        """Versions of the software that it was recorded with."""
        return self.sidecar.versions

    @cached_property
    def described(self) -> Described:
        """What its numbers are."""
        return tables.describe(self.files.tables)

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

    @property
    def measures(self) -> dict[str, Array]:
        """Quantities that plug-ins measure after each control step, by name, each of shape (k,)."""
        return self._named(MEASURE)

    @cached_property
    def movement(self) -> Mapping[str, Array]:
        """Movement columns by name, each of shape (k + 1,): `pandas.DataFrame(episode.movement)`.

        `columns.csv` in the folder says what they are. Those of texts are arrays of objects.
        """
        return tables.movement_of(self.table, self.described)

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
            return tables.array_of(self.table, OBSERVATION + name, reading)
        return read_pictures(self.videos(name), len(self.step), reading.shape)

    def videos(self, name: str) -> list[Path]:
        """Return the videos of what an eye saw, one for each part of the episode."""
        return self.files.with_extension(f".{name}{PICTURES_SUFFIX}")

    def layout(self, name: str) -> tuple[str, ...]:
        """Return name and unit of each number of an observation, or of `action`, as `InfantEnv.layout` does.

        Raises:
            UnknownNameError: If there is none of this name.
        """
        return self.described.actions if name == "action" else self.reading(name).layout

    @cached_property
    def table(self) -> Any:
        """All rows as an Arrow table, as they are in the file."""
        table = tables.read_columns(self.files.tables, self.described)
        if len(table) != self.sidecar.rows:
            raise RecordingError(f"{self.files.tables[0]}: it has {len(table)} rows of {self.sidecar.rows}")
        return table

    def columns(self, *names: str) -> dict[str, Array]:
        """Return columns of numbers by name, each of shape (k + 1,): `pandas.DataFrame(episode.columns())`.

        Args:
            names: `movement`, `action` and observations to be taken, each number of which is a column with its unit in
                its name; without any, all but touch and pictures. Step, time, reward and infos are always included.

        Raises:
            UnknownNameError: If there is no observation of this name, or it is one of pictures.
        """
        columns = {name: self.column(name) for name in self.table.column_names if name not in LISTS and "." not in name}
        columns |= {name: self.column(name) for name in self.table.column_names if name.startswith(OPTIONAL)}
        dense = [reading.name for reading in self.described.readings if reading.kind == "dense"]
        for name in names or (MOVEMENT, ACTION, *dense):
            if name == MOVEMENT:
                columns |= self.movement
                continue
            array = self.column(ACTION) if name == ACTION else self._observation_of_numbers(name)
            flat = array.reshape(len(array), -1)
            layout = self.layout(name) or [f"{index}" for index in range(flat.shape[1])]
            columns |= {f"{name}: {label}": flat[:, index] for index, label in enumerate(layout)}
        return columns

    def _observation_of_numbers(self, name: str) -> Array:
        """Return one array of what was observed; UnknownNameError if it is one of pictures, or there is none."""
        if self.reading(name).kind == "picture":
            numbers = [reading.name for reading in self.described.readings if reading.kind != "picture"]
            raise UnknownNameError("recorded observation of numbers", name, numbers)
        return self.observation(name)

    @property
    def options(self) -> Mapping[str, Any]:
        """Options of its reset."""
        reset = self.sidecar.reset
        return self._restored(reset.options) if reset else {}

    @property
    def before(self) -> Any:
        """What its reset went on from: parts of a state; None if it began without a reset."""
        reset = self.sidecar.reset
        return reset and self._restored(reset.before)

    @property
    def objects(self) -> Mapping[str, str]:
        """Classes of the objects of a script's own that it was recorded with, by what they are."""
        return self.sidecar.objects or {}

    @property
    def start(self) -> Any:
        """The complete state before the first control step, for `InfantEnv.set_state`.

        That of a world is kept with the first of its infants: `recording.run_of(episode)[0].start`.
        """
        return self._restored(self.sidecar.start)

    @cached_property
    def states(self) -> dict[int, Any]:
        """Complete states after some numbers of control steps; those of a world are kept as `changes` are."""
        return {kept.step: self._restored(kept.state) for kept in self.sidecar.states}

    @cached_property
    def changes(self) -> dict[int, list[tuple[str, Any]]]:
        """What was done to the infant besides control steps, in order, by the number of steps before it.

        What was done to the infants of a world is kept with the first of them whose episode went on.
        """
        by_step: dict[int, list[tuple[str, Any]]] = {}
        for change in self.sidecar.changes:
            by_step.setdefault(change.step, []).append(self.change(change))
        return by_step

    def change(self, change: Change) -> tuple[str, Any]:
        """Return of which kind a change is, and its value."""
        (kind,) = change.kinds
        return kind, self._restored(getattr(change, kind))

    def column(self, name: str) -> Array:
        """Return a column of the file as an array of k + 1 rows."""
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

    def _restored(self, plain: Any) -> Any:
        try:
            return from_plain(plain)
        except RecordingError as error:
            raise RecordingError(f"{self.files.sidecars[0]}: {error}") from None

    def _named(self, prefix: str) -> dict[str, Array]:
        names = [name for name in self.table.column_names if name.startswith(prefix)]
        return {name.removeprefix(prefix): self.column(name)[1:] for name in names}


@dataclass(frozen=True)
class ReadRecording(Sequence[Episode]):
    """A recording: its episodes, by infant and number.

    Example:
        >>> import mimoc
        >>> recording = mimoc.read_recording("recordings/reach")
        >>> len(recording), [episode.rewards.shape for episode in recording]
        (1, [(3,)])
    """

    path: Path
    description: Description
    episodes: tuple[Episode, ...]

    def __len__(self) -> int:
        return len(self.episodes)

    def __getitem__(self, index: Any) -> Any:
        return self.episodes[index]

    def __repr__(self) -> str:
        return f"ReadRecording({str(self.path)!r}, {len(self)} episodes)"

    @property
    def infants(self) -> int:
        """How many infants were recorded side by side."""
        return len(self.description.infants)

    def infant_number(self, infant: int | str) -> int:
        """Return the number of an infant that is given by its number or its name."""
        if isinstance(infant, int) or infant.isdecimal():
            return int(infant)
        names = [recorded.name for recorded in self.description.infants]
        check_name("name of an infant of this recording", infant, names)
        if names.count(infant) > 1:
            raise RecordingError(f"{self.path}: several infants are named '{infant}'; give the number of one of them")
        return names.index(infant)

    def of_infant(self, infant: int | str) -> tuple[Episode, ...]:
        """Return the episodes of one infant, given by number or name."""
        number = self.infant_number(infant)
        return tuple(episode for episode in self.episodes if episode.infant == number)

    def run_of(self, episode: Episode) -> tuple[Episode, ...]:
        """Return the episodes of all infants of a world that an episode is of, the one first that keeps its start."""
        sharing = self.description.sharing(episode.infant)
        if len(sharing) == 1:
            return (episode,)
        run = [other for other in self.episodes if other.infant in sharing and other.number == episode.number]
        return tuple(sorted(run, key=lambda other: not other.sidecar.start))

    def whole_bundle(self, infant: int = 0) -> Bundle | WorldBundle:
        """Return the bundle of an infant, or of the world that it shares with others."""
        wanted = self.description.infants[infant]
        home = bundle_folder(self.path, wanted.bundle)
        if home.is_symlink() or home.parent.is_symlink():
            raise RecordingError(f"{home}: this is a link, or in one, which mimoc never writes")
        try:
            bundle = read_bundle(home) if wanted.world is None else read_world_bundle(home)
        except BundleError as error:
            raise RecordingError(f"the bundle of this recording cannot be read: {error}") from None
        if digest(bundle) != wanted.bundle:
            raise RecordingError(f"{home}: this is not the bundle that was recorded ({wanted.bundle[7:15]})")
        return bundle

    def bundle(self, infant: int = 0) -> Bundle:
        """Return the bundle of an infant; that of one in a world has no model of its own.

        Raises:
            RecordingError: If it is missing, damaged, or another one.
        """
        whole = self.whole_bundle(infant)
        name = self.description.infants[infant].name
        if isinstance(whole, Bundle):
            return whole
        if name not in whole.infants:
            raise RecordingError(f"{self.path}: there is no infant '{name}' in the world that was recorded")
        return whole.infants[name]

    def summary(self) -> dict[str, list[Any]]:
        """Return a row for each episode: `pandas.DataFrame(recording.summary())`."""
        rows = [
            {
                "infant": episode.infant,
                "name": self.description.infants[episode.infant].name,
                "episode": episode.number,
                "steps": episode.steps,
                "ended": episode.ended,
                "seed": episode.seed,
                "return": float(np.nansum(episode.rewards)),
                "is_success": bool((episode.infos.get("is_success", np.zeros(1)) == 1).any()),
            }
            for episode in self.episodes
        ]
        return {name: [row[name] for row in rows] for name in rows[0]} if rows else {}


@takes("the folder of a recording", *PATH)
def read_recording(folder: str | Path) -> ReadRecording:
    """Read a recording; of an episode that is still being recorded, or was when its process was killed, what is there.

    Args:
        folder: Folder of the recording.

    Raises:
        RecordingError: If it is none, or damaged.
        MissingExtraError: If PyArrow is not installed.

    Example:
        >>> import mimoc
        >>> recording = mimoc.read_recording("recordings/reach")
        >>> episode = recording[0]
        >>> episode.actions.shape, episode.rewards.shape, len(episode.observations["proprioception"])
        ((3, 8), (3,), 4)
    """
    path = Path(folder).expanduser()
    description = description_in(path)
    episodes = tuple(Episode(files) for files in episodes_in(path, len(description.infants)))
    for episode in episodes:
        _check(episode, description)
    return ReadRecording(path, description, episodes)


def _check(episode: Episode, description: Description) -> None:
    sidecar = episode.sidecar
    place = episode.files.sidecars[0]
    if (sidecar.infant, sidecar.bundle) != (episode.infant, description.infants[episode.infant].bundle):
        raise RecordingError(f"{place}: this is an episode of another infant or recording")
    for name, kept in (("changes", sidecar.changes), ("states", sidecar.states)):
        if late := [entry.step for entry in kept if entry.step >= sidecar.rows]:
            raise RecordingError(f"{place}: {name}: there is no control step {late[0]} in this episode")
    for reading in episode.described.readings:
        if reading.kind == "picture":
            for path in episode.videos(reading.name):
                if not is_regular_file(path):
                    raise RecordingError(f"{path}: the file is damaged or missing, or is not a regular file")
