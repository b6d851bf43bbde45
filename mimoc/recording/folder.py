"""The folder of a recording: which infants were recorded, and where each of their episodes is."""

import fcntl
import json
import os
import platform
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from mimoc.bundle.files import write_file
from mimoc.bundle.io import LOCK, Bundle, write_bundle
from mimoc.bundle.regular_files import UnusableFileError, read_regular_file
from mimoc.errors import OutputError, RecordingError
from mimoc.version import __version__

RECORDING, EPISODES, BUNDLES = "recording.json", "episodes", "bundles"
WHOLE, PART = ".parquet", ".arrow"
"""Extensions of the rows of an episode, and of those of a part."""
FORMAT = 1
MOST_BYTES = 2**29
"""Of a description or a sidecar, which has all states of an episode; 512 MB."""
LIBRARIES = ("mujoco", "gymnasium", "numpy", "pyarrow", "av")
NAME = re.compile(r"^(\d{4,})-(\d{6,})(?:\.part(\d{4,}))?\.json$")
DIGEST = re.compile("sha256:[0-9a-f]{64}")
"""Of a bundle."""
DIGITS = 16
"""Of a bundle's digest in the name of its folder."""


@dataclass(frozen=True, slots=True)
class EpisodeFiles:
    """Where an episode is: in one set of files, or, while it is recorded and after a kill, in parts."""

    infant: int
    number: int
    stems: tuple[Path, ...]
    """Paths without extensions of the set, or of all parts from the first on."""
    is_whole: bool
    """Whether it is in one set."""

    @property
    def stem(self) -> Path:
        """Path of all its files without what tells them apart."""
        return self.stems[0].with_name(_name(self.infant, self.number))

    @property
    def sidecars(self) -> list[Path]:
        """The sidecar of each part."""
        return [with_extension(stem, ".json") for stem in self.stems]

    @property
    def tables(self) -> list[Path]:
        """The rows of each part."""
        return [with_extension(stem, WHOLE if self.is_whole else PART) for stem in self.stems]

    def pictures(self, name: str, extension: str) -> list[Path]:
        """Return the videos of a picture's name in each part."""
        return [with_extension(stem, f".{name}{extension}") for stem in self.stems]


def with_extension(stem: Path, extension: str) -> Path:
    """Return a path with an extension added."""
    return stem.with_name(stem.name + extension)


@dataclass
class RecordingFolder:
    """The folder of one recording, locked against other processes that record."""

    path: Path
    told: dict[str, Any]
    """Content of `recording.json`."""
    handle: int = field(repr=False)

    @property
    def bundles(self) -> list[str]:
        """The digest of each infant's bundle."""
        return [each["bundle"] for each in self.told["infants"]]

    def stem(self, infant: int, number: int) -> Path:
        """Return the path of an episode's files without their extensions."""
        return self.path / EPISODES / _name(infant, number)

    def next_numbers(self) -> list[int]:
        """Return the number of each infant's next episode."""
        found = [0] * len(self.bundles)
        for each in episodes_in(self.path):
            found[each.infant] = max(found[each.infant], each.number + 1)
        return found

    def mark(self, run: str, steps: int) -> None:
        """Come back to where a run was after some steps, and remove what it has recorded since; or note this place.

        It comes back only if nothing else was recorded since.

        Raises:
            OutputError: If the folder cannot be written.
        """
        marks: list[dict[str, Any]] = self.told.setdefault("marks", [])
        here = [index for index, each in enumerate(marks) if (each["run"], each["steps"]) == (run, steps)]
        if here and all(each["run"] == run for each in marks[here[-1] :]):
            for each in episodes_in(self.path):
                if each.number >= marks[here[-1]]["episodes"][each.infant]:
                    remove(each)
            del marks[here[-1] + 1 :]
        else:
            marks.append({"run": run, "steps": steps, "episodes": self.next_numbers()})
        write_json(self.path / RECORDING, self.told)

    def close(self) -> None:
        """Unlock the folder."""
        os.close(self.handle)


def open_folder(path: str | Path, bundles: Sequence[Bundle], *, step_ms: float) -> RecordingFolder:
    """Open a folder to record infants in: a new or empty one, or that of a recording of the same infants.

    Raises:
        RecordingError: If the folder holds anything else, or another process is recording in it.
        OutputError: If it cannot be written.
    """
    folder = Path(path).expanduser()
    previous = check_recordable(folder, bundles)
    try:
        (folder / EPISODES).mkdir(parents=True, exist_ok=True)
        handle = os.open(folder, os.O_RDONLY)
    except OSError as error:
        raise OutputError(f"{folder}: cannot be written ({error.strerror}); choose another folder") from None
    try:
        _lock(handle, folder)
        told = previous or {"recording": FORMAT, "step_ms": step_ms, "infants": _told_of(bundles), "sessions": []}
        if not told["sessions"] or told["sessions"][-1] != versions():
            told["sessions"].append(versions())
        for bundle in bundles:
            if not (home := bundle_folder(folder, digest(bundle))).exists():
                write_bundle(bundle, home)
        write_json(folder / RECORDING, told)
    except BaseException:
        os.close(handle)
        raise
    return RecordingFolder(folder, told, handle)


def check_recordable(folder: Path, bundles: Sequence[Bundle]) -> dict[str, Any] | None:
    """Check that infants can be recorded in a folder; return what its `recording.json` says, None if there is none.

    Raises:
        RecordingError: If the folder holds anything but a recording of the same infants.
    """
    if os.path.lexists(folder) and not folder.is_dir():
        raise RecordingError(f"{folder}: this is a file; name a new folder")
    inside = {each.name for each in folder.iterdir()} if folder.is_dir() else set()
    if RECORDING not in inside:
        if inside - {EPISODES, BUNDLES}:
            raise RecordingError(f"{folder}: the folder is not empty and no recording; name a new or empty folder")
        return None
    told = read_description(folder)
    found, wanted = [each["bundle"] for each in told["infants"]], [digest(bundle) for bundle in bundles]
    if len(found) != len(wanted):
        raise RecordingError(
            f"{folder}: the recording here is of {len(found)} infants side by side, not {len(wanted)}; name another"
            " folder"
        )
    for infant, (theirs, ours) in enumerate(zip(found, wanted, strict=True)):
        if theirs != ours:
            name = told["infants"][infant]["name"]
            raise RecordingError(
                f"{folder}: the recording here is of another bundle ('{name}', {theirs[7:15]}, not"
                f" '{bundles[infant].manifest.name}', {ours[7:15]}); name another folder"
            )
    return told


def read_description(folder: Path) -> dict[str, Any]:
    """Return what the `recording.json` of a folder says.

    Raises:
        RecordingError: If the folder is not that of a recording, or the file is damaged.
    """
    if not folder.is_dir():
        raise RecordingError(f"{folder}: there is no such folder; record one with 'mimoc run INFANT --record DIR'")
    path = folder / RECORDING
    if not os.path.lexists(path):
        raise RecordingError(f"{folder}: this is not a recording, it has no {RECORDING}")
    told = read_json(path)
    if not isinstance(told, dict) or told.get("recording") != FORMAT:
        raise RecordingError(f"{path}: this version of mimoc reads recordings of version {FORMAT} only")
    if not _is_description(told):
        raise RecordingError(f"{path}: the file is damaged")
    return told


def read_json(path: Path) -> Any:
    """Return what a file of a recording says.

    Raises:
        RecordingError: If it is missing, damaged, not a regular file, or too large.
    """
    try:
        return json.loads(read_regular_file(path, MOST_BYTES) or b"")
    except UnusableFileError as error:
        raise RecordingError(f"{path}: {error}") from None
    except (ValueError, RecursionError):
        raise RecordingError(f"{path}: the file is damaged or missing") from None


def episodes_in(folder: Path) -> list[EpisodeFiles]:
    """Return the episodes in the folder of a recording, by infant and number; those without any part are left out."""
    whole: set[tuple[int, int]] = set()
    parts: dict[tuple[int, int], set[int]] = {}
    home = folder / EPISODES
    for path in home.iterdir() if home.is_dir() else ():
        if found := NAME.match(path.name):
            key = int(found[1]), int(found[2])
            if found[3] is None:
                whole.add(key)
            else:
                parts.setdefault(key, set()).add(int(found[3]))
    listed = (_files(home, key, key in whole, parts.get(key, set())) for key in sorted(whole | parts.keys()))
    return [each for each in listed if each.stems]


def remove(episode: EpisodeFiles) -> None:
    """Remove all files of an episode, its sidecars first, so that a half of it is never taken for the whole."""
    found = sorted(episode.stem.parent.glob(f"{episode.stem.name}.*"), key=lambda path: path.suffix != ".json")
    for path in found:
        path.unlink(missing_ok=True)


def bundle_folder(folder: Path, bundle_digest: str) -> Path:
    """Return where the bundle of a digest is."""
    return folder / BUNDLES / bundle_digest.removeprefix("sha256:")[:DIGITS]


def digest(bundle: Bundle) -> str:
    """Return the digest of a bundle: that of its lock, which has those of all its files."""
    return f"sha256:{sha256(bundle.files[LOCK]).hexdigest()}"


def versions() -> dict[str, str]:
    """Return the versions of the software here."""
    found = {"mimoc": __version__, "python": platform.python_version(), "machine": platform.machine()}
    for name in LIBRARIES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found


def write_json(path: Path, data: Mapping[str, Any]) -> None:
    """Write a JSON file atomically.

    Raises:
        OutputError: If it cannot be written.
    """
    write_file(path, (json.dumps(data, ensure_ascii=False, sort_keys=True) + "\n").encode())


def _name(infant: int, number: int) -> str:
    """Return what the names of the files of an episode begin with, as `NAME` expects."""
    return f"{infant:04d}-{number:06d}"


def _told_of(bundles: Sequence[Bundle]) -> list[dict[str, str]]:
    return [{"name": bundle.manifest.name, "bundle": digest(bundle)} for bundle in bundles]


def _is_description(told: Mapping[str, Any]) -> bool:
    """Return whether data is what `open_folder` and `RecordingFolder.mark` write into `recording.json`."""
    infants, sessions, marks = (told.get(name) for name in ("infants", "sessions", "marks"))
    if not (isinstance(infants, list) and isinstance(sessions, list) and isinstance(told.get("step_ms"), (int, float))):
        return False
    if not infants or not all(
        isinstance(each, dict) and isinstance(each.get("name"), str) and DIGEST.fullmatch(str(each.get("bundle")))
        for each in infants
    ):
        return False
    return marks is None or (isinstance(marks, list) and all(_is_mark(each, len(infants)) for each in marks))


def _is_mark(told: Any, infants: int) -> bool:
    if not isinstance(told, dict) or not {"run", "steps", "episodes"} <= told.keys():
        return False
    episodes = told["episodes"]
    return isinstance(episodes, list) and len(episodes) == infants and all(type(each) is int for each in episodes)


def _files(home: Path, key: tuple[int, int], is_whole: bool, parts: set[int]) -> EpisodeFiles:
    stem = home / _name(*key)
    if is_whole:
        return EpisodeFiles(*key, (stem,), True)
    count = next(number for number in range(len(parts) + 1) if number not in parts)
    return EpisodeFiles(*key, tuple(part_stem(stem, number) for number in range(count)), False)


def part_stem(stem: Path, number: int) -> Path:
    """Return the path without extension of a part of an episode."""
    return with_extension(stem, f".part{number:04d}")


def _lock(handle: int, path: Path) -> None:
    """Lock a folder until its handle is closed or this process ends."""
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise RecordingError(f"{path}: another process is recording here; wait for it or name another folder") from None
