"""The folder of a recording: which infants were recorded, and where each of their episodes is."""

import csv
import fcntl
import io
import json
import os
import platform
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from itertools import count, takewhile
from pathlib import Path
from typing import Any, BinaryIO

from mimoc.base.errors import MimocError, OutputError, RecordingError
from mimoc.base.quantity import Quantity
from mimoc.bundle.files import check_unlinked, make_folder, write_error, write_file
from mimoc.bundle.io import LOCK, Bundle, read_bundle, write_bundle
from mimoc.bundle.regular_files import UnusableFileError, open_regular_file, read_regular_file, regular_files
from mimoc.bundle.world import WorldBundle
from mimoc.recording.description import FORMAT, RECORDING, Description, Mark, RecordedInfant, description_in
from mimoc.version import __version__

EPISODES, BUNDLES = "episodes", "bundles"
TABLE = ".parquet"
LIBRARIES = ("mujoco", "gymnasium", "numpy", "pyarrow", "av")
NAME = re.compile(r"([0-9]{4,})-([0-9]{6,})(?:\.([0-9]{4,}))?\.json")
AnyBundle = Bundle | WorldBundle
DIGITS = 16  # Digits of a bundle's digest in the name of its folder.


@dataclass(frozen=True, slots=True)
class EpisodeFiles:
    """Where an episode is: in one or several parts, each of a table, a sidecar and the videos of what eyes saw."""

    infant: int
    number: int
    stems: tuple[Path, ...]  # Paths of the parts without extensions.

    @property
    def folder(self) -> Path:
        """The folder of the recording."""
        return self.stems[0].parents[1]

    @property
    def sidecars(self) -> list[Path]:
        """The sidecar of each part."""
        return self.with_extension(".json")

    @property
    def tables(self) -> list[Path]:
        """The rows of each part."""
        return self.with_extension(TABLE)

    def with_extension(self, extension: str) -> list[Path]:
        """Return the path of each part with an extension added."""
        return [with_extension(stem, extension) for stem in self.stems]


def with_extension(stem: Path, extension: str) -> Path:
    """Return a path with an extension added."""
    return stem.with_name(stem.name + extension)


@dataclass
class RecordingFolder:
    """The folder of one recording, locked against other processes that record."""

    path: Path
    description: Description
    handle: int = field(repr=False)

    def stem(self, infant: int, number: int) -> Path:
        """Return the path of an episode's files without their extensions."""
        return self.path / EPISODES / _name(infant, number)

    def next_numbers(self) -> list[int]:
        """Return the number of each infant's next episode."""
        numbers = [0] * len(self.description.infants)
        for episode in episodes_in(self.path, len(numbers)):
            numbers[episode.infant] = max(numbers[episode.infant], episode.number + 1)
        return numbers

    def mark(self, run: str, steps: int) -> None:
        """Come back to where a run was after some steps, and remove what it has recorded since; or note this place.

        It comes back only if nothing else was recorded since.
        """
        marks = self.description.marks
        places = [index for index, mark in enumerate(marks) if (mark.run, mark.steps) == (run, steps)]
        if places and all(mark.run == run for mark in marks[places[-1] :]):
            marks = marks[: places[-1] + 1]
            for episode in episodes_in(self.path, len(self.description.infants)):
                if episode.number >= marks[-1].episodes[episode.infant]:
                    _remove(episode)
        else:
            marks = (*marks, Mark(run=run, steps=steps, episodes=tuple(self.next_numbers())))
        self.describe(marks=marks)

    def describe(self, **changes: Any) -> None:
        """Write `recording.json`, with some changes, or raise an OutputError if it cannot be written."""
        self.description = self.description.model_copy(update=changes)
        write_json(self.path / RECORDING, self.description.model_dump(exclude_unset=True))

    def close(self) -> None:
        """Unlock the folder."""
        os.close(self.handle)


def open_folder(path: str | Path, bundles: Sequence[AnyBundle], *, note: str | None = None) -> RecordingFolder:
    """Open a folder to record infants in: a new or empty one, or that of a recording of the same infants."""
    folder = Path(path).expanduser()
    previous = check_recordable(folder, bundles)
    busy = RecordingError(f"{folder}: another process is recording here; wait for it or name another folder")
    step_ms = bundles[0].manifest.step_ms
    infants = recorded_infants(bundles)
    new = Description(recording=FORMAT, step_ms=step_ms, infants=infants, sessions=())
    new = new.model_copy(update={"note": note} if note else {})
    recording = RecordingFolder(folder, previous or new, lock_folder(folder, busy))
    try:
        make_folder(folder / EPISODES, below=folder)
        for bundle in bundles:
            home = bundle_folder(folder, digest(bundle))
            if not check_unlinked(home, below=folder).exists():
                write_bundle(bundle, home)
        sessions, software = recording.description.sessions, versions()
        recording.describe(sessions=sessions if sessions and sessions[-1] == software else (*sessions, software))
    except BaseException:
        recording.close()
        raise
    return recording


def recorded_infants(bundles: Sequence[AnyBundle]) -> tuple[RecordedInfant, ...]:
    """Return what a description says of the infants of bundles, in order; those of a world one after the other."""
    infants = list[RecordedInfant]()
    for number, bundle in enumerate(bundles):
        if isinstance(bundle, WorldBundle):
            same = {"bundle": digest(bundle), "world": number}
            infants += [RecordedInfant(name=name, **same) for name in bundle.infants]
        else:
            infants.append(RecordedInfant(name=bundle.manifest.name, bundle=digest(bundle)))
    return tuple(infants)


def check_recordable(folder: Path, bundles: Sequence[AnyBundle]) -> Description | None:
    """Check that infants can be recorded in a folder; return what its `recording.json` says, None if there is none."""
    if os.path.lexists(folder) and not folder.is_dir():
        raise RecordingError(f"{folder}: this is a file; name a new folder")
    inside = {path.name for path in folder.iterdir()} if folder.is_dir() else set()
    if RECORDING not in inside:
        if inside - {EPISODES, BUNDLES}:
            raise RecordingError(f"{folder}: the folder is not empty and no recording; name a new or empty folder")
        return None
    description = description_in(folder)
    recorded, wanted = description.infants, recorded_infants(bundles)
    if len(recorded) != len(wanted):
        other = f"{len(recorded)} infants side by side, not {len(wanted)}"
        raise RecordingError(f"{folder}: the recording here is of {other}; name another folder")
    for theirs, ours in zip(recorded, wanted, strict=True):
        if theirs != ours:
            other = f"another bundle ('{theirs.name}', {theirs.bundle[7:15]}, not '{ours.name}', {ours.bundle[7:15]})"
            raise RecordingError(f"{folder}: the recording here is of {other}; name another folder")
    return description


def episodes_in(folder: Path, infants: int) -> list[EpisodeFiles]:
    """Return the episodes in the folder of a recording, by infant and number, but those without a first part."""
    home = folder / EPISODES
    parts = dict[tuple[int, int], set[int]]()
    for name in _names_in(folder):
        if match := NAME.fullmatch(name):
            infant, number, part = (int(digits or 0) for digits in match.groups())
            if infant >= infants:
                raise RecordingError(f"{home / name}: there is no infant {infant} in this recording of {infants}")
            parts.setdefault((infant, number), set()).add(part)

    def stems(key: tuple[int, int]) -> tuple[Path, ...]:
        stem = home / _name(*key)
        return tuple(part_stem(stem, part) for part in takewhile(parts[key].__contains__, count()))

    return [EpisodeFiles(*key, stems(key)) for key in sorted(parts) if 0 in parts[key]]


@contextmanager
def opened(path: Path, most_bytes: int, *damage: type[Exception]) -> Iterator[BinaryIO]:
    """Open a file of an episode; turn *damage*, links, pipes and too large files into RecordingErrors."""
    try:
        file = open_regular_file(path, most_bytes, below=path.parents[1])
        if file is None:
            raise UnusableFileError("the file is missing")
        with file:
            yield file
    except UnusableFileError as error:
        raise RecordingError(f"{path}: {error}") from None
    except damage:
        raise RecordingError(f"{path}: the file is damaged") from None


def _names_in(folder: Path) -> list[str]:
    try:
        with regular_files(folder) as files:
            return files.names(EPISODES)
    except (UnusableFileError, OSError) as error:
        raise RecordingError(f"{folder / EPISODES}: {error}") from None


def _remove(episode: EpisodeFiles) -> None:
    """Remove all files of an episode, its sidecars first, so that a half of it is never taken for the whole."""
    home, name = episode.stems[0].parent, episode.stems[0].name
    for path in sorted(home.glob(f"{name}.*"), key=lambda path: path.suffix != ".json"):
        try:
            path.unlink(missing_ok=True)
        except OSError as error:
            raise write_error(path, error) from None


def bundle_folder(folder: Path, bundle_digest: str) -> Path:
    """Return where the bundle of a digest is."""
    return folder / BUNDLES / bundle_digest.removeprefix("sha256:")[:DIGITS]


def read_infant(path: str | Path) -> Bundle:
    """Return the bundle in a folder, or that of the infant whose recording, or retargeted recording, is in it."""
    folder = Path(path).expanduser()
    if not os.path.lexists(folder / RECORDING):
        return read_bundle(folder)
    infant, *others = description_in(folder).infants
    if others:
        raise RecordingError(f"{folder}: {len(others) + 1} infants are recorded here; name a folder in its {BUNDLES}")
    return read_bundle(bundle_folder(folder, infant.bundle))


def digest(bundle: AnyBundle) -> str:
    """Return the digest of a bundle: that of its lock, which has those of all its files."""
    return f"sha256:{sha256(bundle.files[LOCK]).hexdigest()}"


def versions(libraries: Sequence[str] = LIBRARIES) -> dict[str, str]:
    """Return the versions of mimoc, Python and those libraries that are installed, and the type of the machine."""
    software = {"mimoc": __version__, "python": platform.python_version(), "machine": platform.machine()}
    for name in libraries:
        with suppress(PackageNotFoundError):
            software[name] = version(name)
    return software


def write_json(path: Path, data: Mapping[str, Any]) -> None:
    """Write a JSON file atomically, or raise an OutputError if it cannot be written."""
    write_file(path, (json.dumps(data, ensure_ascii=False, sort_keys=True) + "\n").encode())


def _name(infant: int, number: int) -> str:
    return f"{infant:04d}-{number:06d}"


def part_stem(stem: Path, number: int) -> Path:
    """Return the path without extension of a part of an episode; the first one is that of the episode."""
    return with_extension(stem, f".{number:04d}") if number else stem


def lock_folder(folder: Path, busy: MimocError) -> int:
    """Make a folder unless it exists, and lock it until the handle that is returned is closed or this process ends."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        handle = os.open(folder, os.O_RDONLY)
    except OSError as error:
        raise OutputError(f"{folder}: cannot be written ({error.strerror}); choose another folder") from None
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(handle)
        raise busy from None
    return handle


DICTIONARY = "columns.csv"
HEADINGS = ("name", "unit", "about", "frame", "source")
MAX_BYTES = 2**23  # Largest size of a dictionary; that of an infant with five fingers and muscles has 0.2 MB.


def write_dictionary(folder: Path, columns: Iterable[Quantity]) -> None:
    """Write what columns are beside what the folder's dictionary says of others, or raise an OutputError."""
    entries = read_dictionary(folder) | {
        column.name: {heading: str(getattr(column, heading)) for heading in HEADINGS} for column in columns
    }
    write_file(folder / DICTIONARY, table_text(HEADINGS, entries.values()))


def read_dictionary(folder: Path) -> dict[str, Mapping[str, str]]:
    """Return what the dictionary of a recording says of each column, by name; nothing if there is none."""
    path = folder / DICTIONARY
    try:
        content = read_regular_file(path, MAX_BYTES, below=folder)
        rows = [*csv.DictReader(io.StringIO((content or b"").decode()), strict=True)]
    except UnusableFileError as error:
        raise RecordingError(f"{path}: {error}") from None
    except (UnicodeDecodeError, csv.Error):
        raise RecordingError(f"{path}: the file is damaged") from None
    if any(tuple(row) != HEADINGS or None in row.values() for row in rows):
        raise RecordingError(f"{path}: its columns must be {', '.join(HEADINGS)}")
    return {row["name"]: row for row in rows}


def table_text(headings: Sequence[str], rows: Iterable[Mapping[str, str]]) -> bytes:
    """Return a table as CSV."""
    text = io.StringIO()
    writer = csv.DictWriter(text, headings, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue().encode()
