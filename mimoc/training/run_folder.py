"""The folder of a training: what it began with, where it stands, what came of it; whole whenever it is looked at."""

import fcntl
import json
import os
import platform
import shlex
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path
from shutil import rmtree
from typing import Any

from mimoc.bundle.files import write_file
from mimoc.bundle.folder import LOCK, Bundle, write_bundle
from mimoc.errors import OutputError, TrainingError
from mimoc.training.settings import Settings
from mimoc.version import __version__

RUN, STATE, POLICY, CURVE, PICTURE = "run.json", "state.zip", "policy.zip", "curve.csv", "curve.png"
CHECKPOINTS, BUNDLE = "checkpoints", "bundle"
LIBRARIES = ("mujoco", "gymnasium", "numpy", "torch", "stable_baselines3")


@dataclass(frozen=True, slots=True)
class RunFolder:
    """A folder that one training has to itself."""

    path: Path

    def state(self) -> bytes | None:
        """Return what the training goes on from, if there is anything yet."""
        try:
            return (self.path / STATE).read_bytes()
        except FileNotFoundError:
            return None
        except OSError as error:
            raise TrainingError(f"{self.path / STATE}: cannot be read ({error.strerror})") from None

    def keep(self, steps: int, policy: bytes, state: bytes) -> None:
        """Write a checkpoint; the state comes last, for what else there is can be made again from the one before.

        Raises:
            OutputError: If a file cannot be written.
        """
        write_file(self.path / CHECKPOINTS / f"{steps:010d}.zip", policy)
        write_file(self.path / POLICY, policy)
        write_file(self.path / STATE, state)

    def show(self, csv: str) -> None:
        """Write the learning curve.

        Raises:
            OutputError: If the file cannot be written.
        """
        write_file(self.path / CURVE, csv.encode())

    def draw(self, png: bytes) -> None:
        """Write the picture of the learning curve.

        Raises:
            OutputError: If the file cannot be written.
        """
        write_file(self.path / PICTURE, png)


@contextmanager
def claim(out: str | Path, settings: Settings, bundle: Bundle, *, force: bool) -> Iterator[RunFolder]:
    """Take a folder for a training: a new one, an empty one, or that of this very training, which then goes on.

    Args:
        out: The folder.
        settings: How the infant is trained.
        bundle: Which infant.
        force: Begin anew what was begun in it, also with other settings.

    Raises:
        TrainingError: If there is something else in the folder, or another process is training in it.
        OutputError: If it cannot be written.
    """
    path = Path(out).expanduser()
    _refuse_what_is_no_run(path)
    began = _read_run(path)
    if began is not None and not force:
        _refuse_another_training(path, began, settings, bundle)
    try:
        (path / CHECKPOINTS).mkdir(parents=True, exist_ok=True)
        handle = os.open(path, os.O_RDONLY)
    except OSError as error:
        raise OutputError(f"{path}: cannot be written ({error.strerror}); choose another folder") from None
    try:
        _lock(handle, path)
        _sweep(path)
        if force:
            _clear(path)
        _describe(path, began if not force else None, settings, bundle)
        yield RunFolder(path)
    finally:
        os.close(handle)


def _refuse_what_is_no_run(path: Path) -> None:
    """Refuse a file, and a folder in which something else is kept."""
    if os.path.lexists(path) and not path.is_dir():
        raise TrainingError(f"{path}: this is a file; name a new folder")
    try:
        inside = {each.name for each in path.iterdir() if each not in _left(path)} if path.is_dir() else set()
    except OSError as error:
        raise TrainingError(f"{path}: cannot be read ({error.strerror}); choose another folder") from None
    if inside - {CHECKPOINTS} and RUN not in inside:
        raise TrainingError(f"{path}: this folder is not that of a training; name a new or empty one")


def _read_run(path: Path) -> dict[str, Any] | None:
    try:
        run = json.loads((path / RUN).read_bytes())
        Settings.from_data(run["settings"])
        _ = run["bundle"], run["sessions"]
    except FileNotFoundError:
        return None
    except (OSError, ValueError, KeyError, TypeError):
        raise TrainingError(f"{path / RUN}: it is damaged; name another folder") from None
    return run


def _refuse_another_training(path: Path, began: dict[str, Any], settings: Settings, bundle: Bundle) -> None:
    """Refuse to go on with other settings or another infant; with more steps is fine."""
    differences = settings.differences(Settings.from_data(began["settings"]))
    if began["bundle"] != _digest(bundle):
        differences.append("another infant")
    if differences:
        advice = "go on as it was begun, name another folder, or begin anew with --force"
        raise TrainingError(f"{path}: the training here was begun with {'; '.join(differences)}; {advice}")


def _lock(handle: int, path: Path) -> None:
    """Hold a folder until its handle is closed, by this process or by its end."""
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise TrainingError(f"{path}: another process is training here; wait for it or name another folder") from None


def _sweep(path: Path) -> None:
    """Remove what was being written when a training was killed."""
    for left in _left(path) + _left(path / CHECKPOINTS):
        with suppress(OSError):
            left.unlink()


def _left(folder: Path) -> list[Path]:
    return list(folder.glob(".mimoc-*.tmp"))


def _clear(path: Path) -> None:
    for name in (STATE, POLICY, CURVE, PICTURE, RUN):
        (path / name).unlink(missing_ok=True)
    for old in (path / CHECKPOINTS).glob("*.zip"):
        old.unlink()
    rmtree(path / BUNDLE, ignore_errors=True)


def _describe(path: Path, began: dict[str, Any] | None, settings: Settings, bundle: Bundle) -> None:
    """Write down what is trained, how and with what; software that has changed since is added."""
    sessions = began["sessions"] if began else []
    if not sessions or sessions[-1] != _versions():
        sessions = [*sessions, _versions()]
    if began:  # It may be done, and be asked for less.
        settings = replace(settings, steps=max(settings.steps, began["settings"]["steps"]))
    run = {
        "run": 1,
        "command": shlex.join(["mimoc", "train", BUNDLE, "-o", "NEW", *settings.options()]),
        "settings": settings.data(),
        "bundle": _digest(bundle),
        "sessions": sessions,
    }
    write_file(path / RUN, (json.dumps(run, indent=1, sort_keys=True) + "\n").encode())
    if not (path / BUNDLE / LOCK).exists():
        rmtree(path / BUNDLE, ignore_errors=True)
        write_bundle(bundle, path / BUNDLE)


def _digest(bundle: Bundle) -> str:
    return f"sha256:{sha256(bundle.files[LOCK]).hexdigest()}"


def _versions() -> dict[str, str]:
    found = {name: version(name) for name in LIBRARIES}
    return {"mimoc": __version__, "python": platform.python_version(), "machine": platform.machine(), **found}
