"""The folder of a retargeted recording: a child, its motion as a recording of mimoc, and the points that it came from.

| file | what |
|---|---|
| `recording.json`, `bundles/`, `episodes/` | the motion as a recording: `mimoc replay`, `view`, `export` read it |
| `child.yaml` | the child's spec |
| `motion.npz` | joint angles at each frame; see `mimoc.motion.joint_motion` |
| `points.npz`, `fitted.npz` | the points as recorded, and where those of the child are |
| `account.json` | how far the motion can be trusted |
| `README.md` | what is in the folder |
"""

import json
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from mimoc.base.classes import PATH, takes
from mimoc.base.errors import MimocError, OutputError
from mimoc.bundle.files import check_place, staged_folder, write_file
from mimoc.bundle.io import Bundle
from mimoc.bundle.model import load_model
from mimoc.bundle.regular_files import UnusableFileError, is_regular_file, read_regular_file
from mimoc.compiler.building import build
from mimoc.compiler.provenance import SCALE_NOT_KNOWN, SPEC_FILE
from mimoc.motion import read_npz
from mimoc.motion.joint_motion import MOTION, JointMotion, motion_of, pack_motion, read_motion
from mimoc.motion.point_recording import PointRecording, ReadOptions
from mimoc.movement.retargeting.puppet import record_motion
from mimoc.movement.retargeting.result import Retargeted
from mimoc.recording.description import RECORDING
from mimoc.recording.folder import read_infant

CHILD, POINTS, FITTED, ACCOUNT, README = "child.yaml", "points.npz", "fitted.npz", "account.json", "README.md"
Progress = Callable[[int, int], None]
_ADVICE = "write it again with 'mimoc retarget'"


@dataclass(frozen=True)
class RetargetedFolder:
    """What is in the folder of a retargeted recording."""

    path: Path
    bundle: Bundle
    motion: JointMotion
    """The child's motion, at the frames of the recording."""
    recording: PointRecording
    """The points as recorded."""
    fitted: PointRecording
    """The same points on the child; NaN for those that it does not have."""
    account: Mapping[str, Any]
    """How far the motion can be trusted, as `Account.to_data` gives it."""


@takes("what mimoc.retarget returns", Retargeted)
def write_retargeted(
    retargeted: Retargeted, out: str | Path, *, force: bool = False, progress: Progress = lambda done, total: None
) -> Path:
    """Write a child and its motion into a folder, all or nothing.

    Args:
        retargeted: What `mimoc.retarget` returns.
        out: A new or empty folder or, with *force*, that of another retargeted recording.
        force: Replace such a folder, together with any other files in it.
        progress: Called with the control steps recorded, and their number.

    Raises:
        OutputError: If the folder holds anything else, or cannot be written.
        MimocError: If the child's task ends before the motion does, or the motion cannot be recorded.
        RenderingError: If the child has vision, and there is no OpenGL here.

    Example:
        >>> import mimoc
        >>> child = mimoc.retarget(mimoc.read_points("filmed.npz"), age_months=9)
        >>> folder = mimoc.write_retargeted(child, "retargeted/child")
        >>> sorted(path.name for path in folder.iterdir())[:4]
        ['README.md', 'account.json', 'bundles', 'child.yaml']
    """
    target = check_writable(out, force)
    with staged_folder(target, force=force) as staging:
        bundle = retargeted.bundle
        recording = retargeted.recording
        motion = motion_of(load_model(bundle), bundle.manifest.root_body, retargeted.qpos, retargeted.rate_hz)
        record_motion(bundle, motion, staging, progress)
        write_file(staging / CHILD, bundle.files[SPEC_FILE])
        write_file(staging / MOTION, pack_motion(motion))
        seen = np.isfinite(retargeted.fitted).all(axis=-1).astype(float)
        fitted = replace(recording, positions=retargeted.fitted, confidence=seen, depth_m=None, notes=())
        for name, points in ((POINTS, recording), (FITTED, fitted)):
            write_file(staging / name, read_npz.pack(points))
        account = json.dumps(retargeted.account.to_data(), ensure_ascii=False, indent=1, allow_nan=False)
        write_file(staging / ACCOUNT, f"{account}\n".encode())
        write_file(staging / README, _readme(retargeted, motion).encode())
    return target


def altered(retargeted: Retargeted, senses: Sequence[str] | None, actuation: str | None) -> Retargeted:
    """Return a motion's child with other senses or actuation model, None for the same, or raise a SpecError."""
    changes: dict[str, Any] = {}
    if senses is not None:
        all_senses = type(retargeted.spec.senses).model_fields
        changes["senses"] = {name: {} for name in senses} | {name: None for name in all_senses if name not in senses}
    if actuation is not None:
        changes["actuation"] = {"model": actuation}
    if not changes:
        return retargeted
    spec = retargeted.spec.with_(**changes)
    return replace(retargeted, spec=spec, bundle=build(spec))


def check_writable(out: str | Path, force: bool) -> Path:
    """Return the path of a folder for a retargeted recording, or raise an OutputError if it holds anything to keep."""
    target = Path(out).expanduser()
    check_place(target)
    if not os.path.lexists(target):
        return target
    if not target.is_dir():
        raise OutputError(f"{target}: this is a file; name a new folder")
    if not any(target.iterdir()):
        return target
    if not is_retargeted(target):
        raise OutputError(f"{target}: the folder is not empty and no retargeted recording; name a new or empty folder")
    if not force:
        raise OutputError(f"{target}: a retargeted recording is here already; replace it with --force, or name another")
    return target


def is_retargeted(path: str | Path) -> bool:
    """Return whether this is the folder of a retargeted recording."""
    folder = Path(path).expanduser()
    return all(is_regular_file(folder / name) for name in (RECORDING, MOTION))


@takes("a folder of mimoc.write_retargeted", *PATH)
def read_retargeted(folder: str | Path) -> RetargetedFolder:
    """Read the folder of a retargeted recording.

    Raises:
        MimocError: If the folder is no retargeted recording, or is damaged.

    Example:
        >>> import mimoc
        >>> mimoc.read_retargeted("retargeted/kim").motion.qpos.shape[0]
        12
    """
    path = Path(folder).expanduser()
    if not is_retargeted(path):
        raise MimocError(f"{path}: this is not a retargeted recording; make one with 'mimoc retarget RECORDING -o DIR'")
    recording, fitted = (_points(path / name) for name in (POINTS, FITTED))
    if fitted.positions.shape != recording.positions.shape or fitted.names != recording.names:
        raise MimocError(f"{path / FITTED}: it has other points or frames than {POINTS}; {_ADVICE}")
    return RetargetedFolder(path, read_infant(path), read_motion(path), recording, fitted, _account(path / ACCOUNT))


def _points(path: Path) -> PointRecording:
    try:
        return read_npz.read(path, ReadOptions())
    except UnusableFileError as error:
        raise MimocError(f"{path}: {error}; {_ADVICE}") from None


def _account(path: Path) -> Mapping[str, Any]:
    try:
        account = json.loads(read_regular_file(path) or b"")
        if not isinstance(account, dict):
            raise ValueError
    except UnusableFileError as error:
        raise MimocError(f"{path}: {error}; {_ADVICE}") from None
    except (ValueError, RecursionError):
        raise MimocError(f"{path}: the file is damaged or missing; {_ADVICE}") from None
    return account


def _readme(retargeted: Retargeted, motion: JointMotion) -> str:
    child, account = retargeted.bundle.manifest.child, retargeted.account
    error = 100 * account.error_median / account.trunk
    size = f"{child.length_cm:.0f} cm long" if account.size_is_known else SCALE_NOT_KNOWN
    unseen = ", ".join(name.removeprefix("robot:") for name in account.unseen)
    told = f"\n\nWhat was filmed does not tell these angles; they are what is usual: {unseen}." if unseen else ""
    return f"""# {retargeted.bundle.manifest.name}: a recorded infant on its own body

A child of {child.age_months:g} months ({size}),
and {motion.seconds:.1f} s of its motion, fitted by mimoc to recorded points (median error {error:.1f} % of the trunk).
This folder derives from a recording of a child: whatever holds for that recording holds for this folder.{told}

- `mimoc view . -o page.html` shows it beside its points; `mimoc replay .` and `mimoc export .` read it as a recording.
- `mimoc run . --policy motion` replays it physically, within the infant's strength. Take senses from such a run, with
  `--record DIR`: the episode here is the motion itself, in which parts of the body may lie within each other, so what
  its skin feels is no contact that the infant had.
- `child.yaml` is its spec, `motion.npz` its joint angles, `points.npz` what was recorded, `fitted.npz` where its own
  points are, `account.json` how far all that can be trusted.
"""
