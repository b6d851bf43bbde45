"""Reading points on infants who were filmed, whatever wrote them."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from mimoc.base.errors import RecordingError, check_name
from mimoc.base.kinds import MotionFormat, function_of
from mimoc.bundle.regular_files import UnusableFileError
from mimoc.motion import FORMATS
from mimoc.motion.checks import check_points, check_timing
from mimoc.motion.labels import check_labels, name_points
from mimoc.motion.options import VIEWS, ReadOptions, View
from mimoc.motion.point_recording import Camera, PointRecording
from mimoc.plugins import load_plugins


def read_points(
    path: str | Path,
    *,
    format: str | None = None,  # noqa: A002
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
        names: Mimoc's names by the labels of the files, such as `{"marker 3": "left_knee"}`, for those it does not know.
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
    try:
        kind = FORMATS.find(format) if format else _recognised(place)
        if not place.exists():
            raise UnusableFileError("there is no such file or folder; check the path")
        options = ReadOptions(rate_hz, camera, infant, names or {}, view)
        recording: PointRecording = function_of(kind.read, "read")(
            place.resolve() if place.is_dir() else place, options
        )
        check_labels(recording.names)
        timed = check_timing(name_points(recording, names), rate_hz)
        return check_points(replace(timed, camera=_camera(timed, camera)), view)
    except UnusableFileError as error:
        raise RecordingError(f"{place}: {error}") from None


def _recognised(place: Path) -> MotionFormat:
    """Return the format that a file or folder is in, or raise an UnusableFileError."""
    if not place.exists():
        raise UnusableFileError("there is no such file or folder; check the path")
    for kind in FORMATS.values():
        if function_of(kind.recognise, "recognise")(place):
            return kind
    if place.is_dir() and not any(place.iterdir()):
        raise UnusableFileError("the folder is empty; give the one with the files of the pose estimator")
    raise UnusableFileError(f"is in no format that mimoc recognises; give its format: {', '.join(FORMATS)}")


def _camera(recording: PointRecording, camera: Camera | None) -> Camera | None:
    return None if recording.unit == "m" else camera or recording.camera
