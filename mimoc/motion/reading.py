"""Reading points on infants who were filmed, whatever wrote them."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from mimoc.base.classes import PATH, takes
from mimoc.base.errors import RecordingError, check_name
from mimoc.base.kinds import MotionFormat, function_of
from mimoc.bundle.regular_files import UnusableFileError, one_line
from mimoc.motion import FORMATS
from mimoc.motion.checks import check_numbers, check_points, check_timing
from mimoc.motion.labels import name_points
from mimoc.motion.options import VIEWS, ReadOptions, View
from mimoc.motion.point_recording import Camera, PointRecording
from mimoc.plugins import load_plugins


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
) -> PointRecording:
    """Read points on a filmed infant that a pose estimator, a depth camera or motion capture has written.

    Args:
        path: A file, or a folder with a file for each frame.
        format: Its format, one of `mimoc.motion.FORMATS`; None recognises it.
        rate_hz: Frames per second; needed where the files do not say it.
        camera: The camera of pixels, if the files do not say it.
        infant: Which of several persons is the infant: its identity or, where persons have none, its number in the
            first frame with several, from 0. None takes the largest.
        names: Mimoc's names by the labels of the files, such as `{"marker 3": "left_knee"}`, where needed.
        view: What the camera sees: the infant's `front`, its `back`, a `mirrored` picture (or y upwards); `swapped` is
            left and right exchanged. The last two are put right.

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
    place = Path(path).expanduser()
    options = ReadOptions(rate_hz, camera, infant, names or {}, view)
    try:
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # Of numbers that are then refused.
            return _checked(_read(place, format, options), options)
    except UnusableFileError as error:
        raise RecordingError(one_line(f"{place}: {error}")) from None
    except OSError as error:
        reason = f"cannot be read ({error.strerror}); check the path and its permissions"
        raise RecordingError(one_line(f"{place}: {reason}")) from None


def _read(place: Path, name: str | None, options: ReadOptions) -> PointRecording:
    """Return what a file or folder holds, with its own labels."""
    kind = FORMATS.find(name) if name else None
    if not place.exists():
        raise UnusableFileError("there is no such file or folder; check the path")
    read = function_of((kind or _recognised(place)).read, "read")
    return read(place.resolve() if place.is_dir() else place, options)


def _checked(recording: PointRecording, options: ReadOptions) -> PointRecording:
    """Return it with mimoc's names, and with what else a user says of it, if it can be that of an infant."""
    named = name_points(check_numbers(recording), options.names)
    camera = None if named.unit == "m" else options.camera or named.camera
    return check_points(replace(check_timing(named, options.rate_hz), camera=camera), options.view)


def _recognised(place: Path) -> MotionFormat:
    """Return the format that a file or folder is in, or raise an UnusableFileError."""
    for kind in FORMATS.values():
        if function_of(kind.recognise, "recognise")(place):
            return kind
    if place.is_dir() and not any(place.iterdir()):
        raise UnusableFileError("the folder is empty; give the one with the files of the pose estimator")
    raise UnusableFileError(f"is in no format that mimoc recognises; give its format: {', '.join(FORMATS)}")
