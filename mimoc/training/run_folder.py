"""The folder of a training run: settings, checkpoints, policy and learning curve, each written atomically."""

import json
import os
import shlex
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

from mimoc.base.errors import BundleError, MimocError, OutputError, TrainingError
from mimoc.bundle.files import check_unlinked, discard, make_folder, remove, write_file
from mimoc.bundle.io import LOCK, Bundle, read_bundle, write_bundle
from mimoc.bundle.regular_files import UnusableFileError, one_line, read_json_file, read_regular_file
from mimoc.bundle.world import WorldBundle, is_world_folder, read_world_bundle
from mimoc.policies.policy_file import MAX_BYTES
from mimoc.recording.folder import digest, lock_folder, versions
from mimoc.schema.base import Model
from mimoc.schema.quantities import Plain, bounded
from mimoc.training.curve import Curve
from mimoc.training.settings import CPU, TrainingSettings

AnyBundle = Bundle | WorldBundle
RUN, STATE, POLICY, CURVE, PICTURE = "run.json", "state.zip", "policy.zip", "curve.csv", "curve.png"
CHECKPOINTS, BUNDLE = "checkpoints", "bundle"
LIBRARIES = ("mujoco", "gymnasium", "numpy", "torch", "stable_baselines3")
DEVICE_LIBRARIES = ("mujoco", "mujoco-warp", "warp-lang", "gymnasium", "numpy", "torch", "rsl-rl-lib")
"""Libraries of a training on a device."""


class RunFile(Model):
    """What `run.json` contains: what the result of a training depends on, and what it was done with."""

    run: Literal[1]
    """Version of this kind of file."""
    command: str = ""
    """Command that trains another infant with these settings."""
    settings: TrainingSettings
    bundle: str
    """Digest of the lock of its infant."""
    sessions: tuple[Mapping[str, str], ...]
    """Versions of the software of each session with other ones than the session before."""
    origin: Mapping[str, Plain] | None = None
    """What the run belongs to, such as the name of a cohort and of a job."""


@dataclass(frozen=True, slots=True)
class RunFolder:
    """The folder of one training run, locked against other processes."""

    path: Path

    def read_checkpoint(self) -> bytes | None:
        """Return the checkpoint to resume from, None if there is none yet."""
        path = self.path / STATE
        content = _content(path)
        if content is None and os.path.lexists(path):
            raise TrainingError(f"{path}: cannot be read")
        return content

    def write_checkpoint(self, steps: int, policy: bytes, state: bytes) -> None:
        """Write a policy and a checkpoint; the checkpoint last, as the rest can be recomputed from the previous one."""
        for name, content in ((f"{CHECKPOINTS}/{steps:010d}.zip", policy), (POLICY, policy), (STATE, state)):
            self.write(name, content)

    def write(self, name: str, content: bytes) -> None:
        """Write a file: the latest policy, which may be later than the checkpoint, the curve, or its plot."""
        write_file(self.path / name, content)


def read_training_run(path: Path) -> tuple[RunFile, Curve]:
    """Return what is in the folder of a training run, which may still be going on; the curve may be empty yet."""
    run = _read_run(path)
    if run is None:
        raise TrainingError(f"{path}: not the folder of a training run; name one written by 'mimoc train -o'")
    try:
        csv = _content(path / CURVE)
        return run, Curve() if csv is None else Curve.from_csv(csv.decode())
    except (ValueError, TrainingError):
        raise TrainingError(f"{path / CURVE}: file is damaged; run the same 'mimoc train' again to renew it") from None


def read_run_bundle(path: Path) -> AnyBundle:
    """Return the infant or the world of the training run in a folder."""
    try:
        place = check_unlinked(path / BUNDLE, below=path)
        return read_world_bundle(place) if is_world_folder(place) else read_bundle(place)
    except OutputError as error:
        raise BundleError(str(error)) from None


@contextmanager
def open_run_folder(
    out: str | Path,
    settings: TrainingSettings,
    bundle: Bundle | WorldBundle,
    *,
    force: bool,
    origin: Mapping[str, Any] | None = None,
) -> Iterator[RunFolder]:
    """Open and lock the folder of a training run: a new or empty folder, or that of the same run, to resume it.

    With *force*, the training run in the folder is discarded, even one with other settings.
    """
    path = Path(out).expanduser()
    _check_is_run_folder(path)
    previous = _read_run(path)
    if previous is not None and not force:
        differences = settings.differences(previous.settings)
        differences += [] if previous.bundle == digest(bundle) else ["another infant"]
        if differences:
            advice = "use the same settings to resume it, name another folder, or start over with --force"
            others = one_line("; ".join(differences))
            raise TrainingError(f"{path}: the training run here was started with {others}; {advice}")
    busy = TrainingError(f"{path}: another process is training here; wait for it or name another folder")
    handle = lock_folder(path, busy)
    try:
        make_folder(path / CHECKPOINTS, below=path)
        for leftover in (*_leftovers(path), *_leftovers(path / CHECKPOINTS)):
            discard(leftover)
        if force:
            files = [path / name for name in (STATE, POLICY, CURVE, PICTURE, RUN)]
            try:
                for file in (*files, *(path / CHECKPOINTS).glob("*.zip")):
                    file.unlink(missing_ok=True)
            except OSError as error:
                raise OutputError(
                    f"{error.filename}: cannot be removed ({error.strerror}); name another folder"
                ) from None
            remove(path / BUNDLE)
        _write_description(path, previous if not force else None, settings, bundle, origin)
        yield RunFolder(path)
    finally:
        os.close(handle)


def _check_is_run_folder(path: Path) -> None:
    if os.path.lexists(path) and not path.is_dir():
        raise TrainingError(f"{path}: this is a file; name a new folder")
    try:
        inside = {file.name for file in path.iterdir() if file not in _leftovers(path)} if path.is_dir() else set()
    except OSError as error:
        raise TrainingError(f"{path}: cannot be read ({error.strerror}); choose another folder") from None
    if inside - {CHECKPOINTS} and RUN not in inside:
        raise TrainingError(f"{path}: not the folder of a training run; name a new or empty folder")


def _read_run(path: Path) -> RunFile | None:
    if not os.path.lexists(path / RUN):
        return None
    try:
        if (run := read_json_file(path / RUN, RunFile)) is None:
            raise UnusableFileError("cannot be read")
        TrainingSettings.choose(**bounded(run.settings.data()))
    except (UnusableFileError, ValueError, MimocError) as error:
        reason = error if isinstance(error, UnusableFileError) else one_line(f"settings: {error}")
        raise TrainingError(f"{path / RUN}: file is damaged ({reason}); name another folder") from None
    return run


def _content(path: Path) -> bytes | None:
    """Return the content of a regular file no larger than any checkpoint, None if there is none or it is unreadable."""
    try:
        return read_regular_file(path, MAX_BYTES)
    except UnusableFileError as error:
        raise TrainingError(f"{path}: {error}") from None


def _leftovers(folder: Path) -> list[Path]:
    return list(folder.glob(".mimoc-*.tmp"))


def _write_description(
    path: Path,
    previous: RunFile | None,
    settings: TrainingSettings,
    bundle: Bundle | WorldBundle,
    origin: Mapping[str, Any] | None,
) -> None:
    """Write the bundle, the settings and the software versions; versions that have changed are appended."""
    sessions = [dict(session) for session in previous.sessions] if previous else []
    software = versions(LIBRARIES if settings.device == CPU else DEVICE_LIBRARIES)
    if software not in sessions[-1:]:
        sessions.append(software)
    if previous:  # A finished run may be called again with fewer steps.
        settings = replace(settings, steps=max(settings.steps, previous.settings.steps))
    run = {
        "run": 1,
        "command": shlex.join(["mimoc", "train", BUNDLE, "-o", "NEW", *settings.options()]),
        "settings": settings.data(),
        "bundle": digest(bundle),
        "sessions": sessions,
        **({"origin": dict(origin)} if origin else {}),
    }
    write_file(path / RUN, (json.dumps(run, indent=1, sort_keys=True) + "\n").encode())
    if not (check_unlinked(path / BUNDLE, below=path) / LOCK).exists():
        remove(path / BUNDLE)
        write_bundle(bundle, path / BUNDLE)
