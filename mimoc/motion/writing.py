"""Writing recordings of points."""

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from mimoc.base.classes import takes
from mimoc.base.errors import OutputError
from mimoc.bundle.files import make_folder, write_file
from mimoc.motion.point_recording import PointRecording
from mimoc.motion.read_mini_rgbd import FOLDERS, JOINTS, POINTS
from mimoc.motion.read_npz import pack

SUFFIXES = ".npz", ".csv"


@takes("a recording of points, from mimoc.read_points", PointRecording)
def write_points(recording: PointRecording, path: str | Path) -> Path:
    """Write a recording of points that `read_points` reads.

    Args:
        recording: The recording.
        path: A file in an existing folder: `.npz` holds all of it, `.csv` all but its camera, name and notes.

    Raises:
        OutputError: If its name ends in something else, or it cannot be written.

    Example:
        >>> import mimoc
        >>> import numpy as np
        >>> from mimoc.motion.body_points import film
        >>> env = mimoc.make("nine_months.yaml")
        >>> _ = env.reset(seed=0, options={"pose": "supine"})
        >>> still = np.repeat(env.unwrapped.data.qpos[None], 90, axis=0)
        >>> mimoc.read_points(mimoc.write_points(film(env.unwrapped.model, still, 30), "still.npz")).frames
        90
    """
    path = Path(path)
    if path.suffix.lower() not in SUFFIXES:
        raise OutputError(f"{path}: not a name for points; end it in {' or '.join(SUFFIXES)}")
    content = pack(recording) if path.suffix.lower() == ".npz" else "\n".join([*_lines(recording), ""]).encode()
    return write_file(path, content)


def write_mini_rgbd(recording: PointRecording, folder: Path) -> Path:
    """Write a recording as a sequence of MINI-RGBD: joints in pixels with their depth, or in space.

    Of 25 joints it has those that are points of the recording and are seen; places in space are in the frame of a
    camera that looks down from the height of 1 m.
    """
    joints = FOLDERS[recording.unit == "m"]
    place = make_folder(folder / joints.folder, below=folder.parent)
    numbers = [JOINTS.index(POINTS[name]) for name in recording.names]
    depth_m = np.zeros(recording.confidence.shape) if recording.depth_m is None else recording.depth_m
    columns = np.concatenate([recording.positions, depth_m[..., None]], axis=-1)[..., :3]
    if joints.in_space:
        columns = columns * (1.0, -1.0, -1.0) + (0.0, 0.0, 1.0)
    for frame, rows in enumerate(columns.tolist()):
        seen = [(row, number) for row, number in zip(rows, numbers, strict=True) if not math.isnan(sum(row))]
        text = "".join(f"{first!r} {second!r} {third!r} {number}\n" for (first, second, third), number in seen)
        write_file(place / f"{joints.prefix}{frame:05d}.txt", text.encode())
    return folder


def _lines(recording: PointRecording) -> Iterator[str]:
    depth = () if recording.depth_m is None else (recording.depth_m[..., None],)
    axes = ("x_m", "y_m", "z_m") if recording.unit == "m" else ("x", "y")
    ends = (*axes, "confidence", *(("depth_m",) if depth else ()))
    yield ",".join(["frame", "time_s", *(f"{name}_{end}" for name in recording.names for end in ends)])
    values = np.concatenate([recording.positions, recording.confidence[..., None], *depth], axis=-1)
    for frame, row in enumerate(values.reshape(recording.frames, -1).tolist()):
        numbers = ["" if math.isnan(number) else repr(number) for number in row]
        yield ",".join([str(frame), repr(frame / recording.rate_hz), *numbers])
