"""Pictures of a recording: written without loss and, beside it, as a small video; joined and read again."""

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from fractions import Fraction
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from mimoc.bundle import files
from mimoc.bundle.regular_files import UnusableFileError, is_regular_file, open_regular_file, read_regular_file
from mimoc.errors import RecordingError
from mimoc.recording.video import Lossless, Mp4, Picture, Video, require_av

SMALL = {"crf": "26", "preset": "veryfast", "bf": "0"}
"""Settings of H.264: small, and its pictures stand in the order in which they are shown."""
LOSSLESS, VIDEO = ".mkv", ".mp4"
SMALL_BYTES, MOST_RATIO = 2**28, 1000
"""What pictures may take however small their file is, and how many times its size."""
CONTAINERS = {LOSSLESS: "matroska", VIDEO: "mp4"}
CODECS = {LOSSLESS: ("ffv1",), VIDEO: ("h264", "mpeg4")}
"""What pictures are encoded by in a file of each extension; nothing else is decoded."""
MOST_BYTES = 2**29
"""Of a small video, or that of a part; of a lossless one, besides twice its pictures."""


def write_pictures(stem: Path, pictures: Picture, rate_hz: Fraction) -> None:
    """Write pictures as `<stem>.mkv`, without loss, and as `<stem>.mp4`.

    Args:
        stem: Path without its extension.
        pictures: Shape (n, height, width, 3).
        rate_hz: Pictures per second.

    Raises:
        OutputError: If a file cannot be written.
    """
    opening: dict[str, Callable[[Path, Fraction], Video]] = {LOSSLESS: Lossless, VIDEO: open_small}
    for extension, open_one in opening.items():
        path = Path(f"{stem}{extension}")
        try:
            video = open_one(path, rate_hz)
            for picture in pictures:
                video.add(picture)
        except OSError as error:
            raise files.write_error(path, error) from None
        video.save()


def open_small(path: Path, rate_hz: Fraction) -> Video:
    """Return a small video to add pictures to."""
    return Mp4(path, rate_hz, SMALL)


def join_videos(path: Path, parts: Sequence[Path], rate_hz: Fraction) -> None:
    """Write the frames of some videos of the same settings into one, as they are encoded.

    Raises:
        OutputError: If the file cannot be written.
        RecordingError: If a part is damaged.
    """
    av, temporary = require_av(), files.temporary_path(path)
    options = {"movflags": "+faststart"} if path.suffix == VIDEO else {}
    try:
        with av.open(str(temporary), "w", format=CONTAINERS[path.suffix], options=options) as joined:
            _copy(joined, parts, rate_hz)
    except RecordingError:
        files.discard(temporary)
        raise
    except (av.error.FFmpegError, IndexError, ValueError):
        files.discard(temporary)
        raise RecordingError(f"{path}: its parts cannot be joined") from None
    except OSError as error:
        files.discard(temporary)
        raise files.write_error(path, error) from None
    files.move_into_place(temporary, path)


def read_pictures(paths: Sequence[Path], count: int | None = None, shape: Sequence[int] | None = None) -> Picture:
    """Return the pictures of lossless videos that follow each other, shape (n, height, width, 3).

    Args:
        paths: The videos, of an episode or of its parts.
        count: How many pictures there are.
        shape: Shape of each of them, (height, width, 3).

    Raises:
        RecordingError: If a file is damaged or missing, far too small for so many pictures, or there are fewer.
    """
    found = list[Picture]()
    for path in paths:
        wanted = None if count is None else count - len(found)
        _check_holds(path, shape, wanted)
        found += decoded(path, shape, wanted)
    if not found or len(found) < (count or 0):
        raise RecordingError(f"{paths[-1]}: there are {len(found)} pictures up to its end, where {count} were recorded")
    return np.stack(found)


def _check_holds(path: Path, shape: Sequence[int] | None, count: int | None) -> None:
    """Check that a file is not far smaller than some pictures of a shape.

    Raises:
        RecordingError: If it is.
    """
    wanted = math.prod(shape) * count if shape is not None and count is not None and is_regular_file(path) else 0
    if wanted > SMALL_BYTES and wanted > MOST_RATIO * path.stat().st_size:
        raise RecordingError(f"{path}: the file is damaged: it cannot hold {count} such pictures")


def decoded(path: Path, shape: Sequence[int] | None = None, most: int | None = None) -> Iterator[Picture]:
    """Yield the pictures of a video, one after the other.

    Args:
        path: The video.
        shape: Shape of each of them, (height, width, 3).
        most: How many of them are wanted; a file that is far too large for these is not searched for them.

    Raises:
        RecordingError: If the file is damaged or missing, or its pictures are of another shape.
    """
    raw_bytes = math.prod(shape) * most if shape is not None and most is not None else 0
    with _opened(path, MOST_BYTES + 2 * raw_bytes) as (container, stream):
        _check_size(stream, shape)
        for frame in islice(container.decode(stream), most):
            _check_size(frame, shape)
            yield frame.to_ndarray(format="rgb24")


def read_video(path: Path) -> bytes:
    """Return the content of a small video.

    Raises:
        RecordingError: If the file is missing, or is not one.
    """
    with _opened(path):
        pass
    content = read_regular_file(path, MOST_BYTES, below=path.parents[1])
    if content is None:
        raise RecordingError(f"{path}: the file is missing")
    return content


@contextmanager
def _opened(path: Path, most_bytes: int = MOST_BYTES) -> Iterator[tuple[Any, Any]]:
    """Open a video as what its extension says, and its stream; whatever is wrong with it is one clear line.

    By its content, a file may be a list of others, elsewhere, which FFmpeg would open.
    """
    av, extension = require_av(), path.suffix
    try:
        file = open_regular_file(path, most_bytes, below=path.parents[1])
        if file is None:
            raise UnusableFileError("the file is missing")
        with file, av.open(file, format=CONTAINERS[extension]) as container:
            stream = container.streams.video[0]
            if stream.codec_context.name not in CODECS[extension]:
                raise UnusableFileError(f"its pictures are not encoded by {' or '.join(CODECS[extension])}")
            yield container, stream
    except UnusableFileError as error:
        raise RecordingError(f"{path}: {error}") from None
    # ValueError: also what PyAV makes of texts that are no UTF-8; AttributeError: there is no decoder.
    except (av.error.FFmpegError, OSError, IndexError, ValueError, AttributeError, MemoryError):
        raise RecordingError(f"{path}: the file is damaged") from None


def _check_size(pictures: Any, shape: Sequence[int] | None) -> None:
    """Check that a frame, or all of a stream, are of some shape, before anything of this size is made.

    Raises:
        UnusableFileError: If they are not.
    """
    if shape is not None and (pictures.height, pictures.width, 3) != tuple(shape):
        raise UnusableFileError(f"its pictures are of another size than {shape[1]} x {shape[0]} pixels")


def _copy(joined: Any, parts: Sequence[Path], rate_hz: Fraction) -> None:
    """Copy the packets of some videos, one after the other in time."""
    stream, done = None, 0
    for part in parts:
        with _opened(part) as (container, source):
            stream = stream or joined.add_stream_from_template(source)
            begin = round(done / rate_hz / source.time_base)
            for packet in container.demux(source):
                if packet.dts is not None:
                    packet.pts, packet.dts, packet.stream = packet.pts + begin, packet.dts + begin, stream
                    joined.mux(packet)
                    done += 1
