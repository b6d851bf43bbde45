"""Reading points on infants who were filmed, whatever wrote them."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from mimoc.base.classes import PATH, takes
from mimoc.base.errors import OutputError, RecordingError, check_name
from mimoc.base.kinds import function_of
from mimoc.bundle.files import write_file
from mimoc.bundle.regular_files import UnusableFileError, one_line
from mimoc.motion.checks import check_numbers, check_points, check_rate, check_timing, drop_unsure, in_pixels
from mimoc.motion.labels import name_points
from mimoc.motion.point_recording import UPS, VIEWS, Camera, PointRecording, ReadOptions, Up, View
from mimoc.motion.read_npz import pack
from mimoc.motion.sides import turned
from mimoc.schema.kinds import FORMATS, MotionFormat
from mimoc.schema.plugins import load_plugins

MAX_PIXELS = 100_000  # Largest width or height of a picture.


@takes("the path of a recording of points", *PATH)
def read_points(
    path: str | Path,
    *,
    format: str | None = None,
    rate_hz: float | None = None,
    camera: Camera | None = None,
    infant: int | str | None = None,
    names: Mapping[str, str] | None = None,
    view: View = "front",
    min_score: float | None = None,
    picture_px: tuple[int, int] | None = None,
    up: Up | None = None,
) -> PointRecording:
    """Read points on a filmed infant that a pose estimator, a depth camera or motion capture has written.

    Args:
        path: A file, or a folder with a file for each frame.
        format: Its format, one of `mimoc.schema.kinds.FORMATS`; None recognises it.
        rate_hz: Frames per second; needed where the files do not say it.
        camera: The camera of pixels, if the files do not say it.
        infant: Which of several persons is the infant: its identity or, where persons have none, its number in the
            first frame with several, from 0. None takes the largest.
        names: Mimoc's names by the labels of the files, such as `{"marker 3": "left_knee"}`, where needed.
        view: What the camera sees: the infant's `front`, its `back`, a `mirrored` picture (or y upwards); `swapped` is
            left and right exchanged. The last two are put right.
        min_score: Confidence, from 0 to 1, below which points are taken not to be seen. None is what the format's own
            programs go by: OpenPose .05, COCO and tables .3, MediaPipe .5, DeepLabCut .6.
        picture_px: Width and height of the picture, if points are shares of it; by default, those of the camera.
        up: The axis of places in space that points upwards; None takes z, and asks if the infant then does not lie.

    Returns:
        The recording; its `notes` say what was assumed and what is missing.

    Raises:
        RecordingError: If it cannot be used: one line that says why, and what to do.
        UnknownNameError: If there is no such format, point or view.

    Example:
        >>> import mimoc
        >>> mimoc.read_points("filmed", rate_hz=30)
        Traceback (most recent call last):
        mimoc.base.errors.RecordingError: filmed: there is no such file or folder; check the path
    """
    load_plugins()
    check_name("view", view, VIEWS)
    if up is not None:
        check_name("choice of the axis that points upwards", up, UPS)
    place = Path(path).expanduser()
    if min_score is not None and not 0 <= min_score <= 1:
        raise RecordingError(f"{place}: min_score={min_score:g} is no confidence; give one from 0 to 1")
    if picture_px is None and camera is not None:
        picture_px = camera.size_px
    if picture_px is not None and not (len(picture_px) == 2 and all(1 <= size <= MAX_PIXELS for size in picture_px)):
        raise RecordingError(f"{place}: the size of the picture is {picture_px}; give width and height in pixels")
    options = ReadOptions(rate_hz, camera, infant, names or {}, view, min_score, picture_px, up)
    return _read_or_explain(place, format, options)


def read_again(path: Path) -> PointRecording:
    """Read points that mimoc has written, without asking how the infant lies, or raise a RecordingError."""
    return _read_or_explain(path, "npz", ReadOptions(view=None, up="z"))


def _read_or_explain(place: Path, format: str | None, options: ReadOptions) -> PointRecording:
    """Return a recording, or raise a RecordingError that says in one line why it cannot be read."""
    try:
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # Such numbers are refused below.
            kind = FORMATS.find(format) if format else None
            if not place.exists():
                raise UnusableFileError("there is no such file or folder; check the path")
            if options.rate_hz is not None:
                check_rate(options.rate_hz)
            kind = kind or _recognised(place)
            read = function_of(kind.read, "read")
            recording = check_numbers(read(place.resolve() if place.is_dir() else place, options))
            recording = drop_unsure(recording, options.least_score(0.0))
            recording = in_pixels(recording, options.picture_px)
            recording = turned(recording, options.up)
            recording = name_points(recording, options.names)
            camera = None if recording.unit == "m" else options.camera or recording.camera
            recording = replace(check_timing(recording, options.rate_hz), camera=camera)
            return check_points(recording, options.view, options.up)
    except UnusableFileError as error:
        raise RecordingError(one_line(f"{place}: {error}")) from None
    except OSError as error:
        reason = f"cannot be read ({error.strerror}); check the path and its permissions"
        raise RecordingError(one_line(f"{place}: {reason}")) from None


def _recognised(place: Path) -> MotionFormat:
    for kind in FORMATS.values():
        if function_of(kind.recognise, "recognise")(place):
            return kind
    if place.is_dir() and not any(place.iterdir()):
        raise UnusableFileError("the folder is empty; give the one with the files of the pose estimator")
    raise UnusableFileError(f"is in no format that mimoc recognises; give its format: {', '.join(FORMATS)}")


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
    if path.suffix.lower() == ".npz":
        return write_file(path, pack(recording))
    return write_file(path, "\n".join([*_lines(recording), ""]).encode())


def _lines(recording: PointRecording) -> Iterator[str]:
    columns = ["x_m", "y_m", "z_m"] if recording.unit == "m" else ["x", "y"]  # Columns of each point.
    columns.append("confidence")
    parts = [recording.positions, recording.confidence[..., None]]
    if recording.depth_m is not None:
        columns.append("depth_m")
        parts.append(recording.depth_m[..., None])
    yield ",".join(["frame", "time_s", *(f"{name}_{column}" for name in recording.names for column in columns)])
    values = np.concatenate(parts, axis=-1)
    for frame, row in enumerate(values.reshape(recording.frames, -1).tolist()):
        numbers = ["" if math.isnan(number) else repr(number) for number in row]
        yield ",".join([str(frame), repr(frame / recording.rate_hz), *numbers])
