"""Pictures of a recording: written without loss and, beside it, as a small video; joined and read again."""

import math
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from mimoc.bundle import files
from mimoc.errors import RecordingError
from mimoc.recording.video import Lossless, Mp4, Picture, Video, require_av

SMALL = {"crf": "26", "preset": "veryfast", "bf": "0"}
"""Settings of H.264: small, and its pictures stand in the order in which they are shown."""
LOSSLESS, VIDEO = ".mkv", ".mp4"
SMALL_BYTES, MOST_RATIO = 2**28, 1000
"""What pictures may take however small their file is, and how many times its size."""
CONTAINERS = {LOSSLESS: "matroska", VIDEO: "mp4"}


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
            _copy(av, joined, parts, rate_hz)
    except (IndexError, ValueError):  # ValueError: also what PyAV makes of texts that are no UTF-8.
        files.discard(temporary)
        raise RecordingError(f"{path}: a part of it is damaged") from None
    except OSError as error:
        files.discard(temporary)
        raise files.write_error(path, error) from None
    files.move_into_place(temporary, path)


def read_pictures(path: Path, count: int | None = None, shape: Sequence[int] | None = None) -> Picture:
    """Return the pictures of a lossless video, shape (n, height, width, 3), of the size that is given.

    Raises:
        RecordingError: If the file is damaged or missing, or has fewer pictures than *count*.
    """
    found = some_pictures(path, shape, count)
    if count is not None and len(found) < count:
        raise RecordingError(f"{path}: there are {len(found)} pictures in it, where {count} were recorded")
    return np.stack(found)


def some_pictures(path: Path, shape: Sequence[int] | None, most: int | None) -> list[Picture]:
    """Return the first pictures of a lossless video, of a shape if one is given.

    Raises:
        RecordingError: If the file is damaged or missing, or is far too small for so many pictures of this shape.
    """
    wanted = math.prod(shape) * most if shape is not None and most is not None and path.is_file() else 0
    if wanted > SMALL_BYTES and wanted > MOST_RATIO * path.stat().st_size:
        raise RecordingError(f"{path}: the file is damaged: it cannot hold {most} such pictures")
    return list(islice(decoded(path, shape), most))


def decoded(path: Path, shape: Sequence[int] | None = None) -> Iterator[Picture]:
    """Yield the pictures of a video, one after the other, each of some shape (height, width, 3), if one is given.

    Raises:
        RecordingError: If the file is damaged or missing.
    """
    av = require_av()
    try:
        # By its content, a file may be a list of others, elsewhere, which FFmpeg would open.
        with av.open(str(path), format=CONTAINERS[path.suffix]) as container:
            for frame in container.decode(video=0):
                if shape is not None and (frame.height, frame.width, 3) != tuple(shape):
                    raise ValueError("pictures of another size")
                yield frame.to_ndarray(format="rgb24")
    except (av.error.FFmpegError, OSError, IndexError, ValueError):
        raise RecordingError(f"{path}: the file is damaged or missing") from None


def _copy(av: Any, joined: Any, parts: Sequence[Path], rate_hz: Fraction) -> None:
    """Copy the packets of some videos, one after the other in time."""
    stream, done = None, 0
    for part in parts:
        with av.open(str(part), format=CONTAINERS[part.suffix]) as container:
            source = container.streams.video[0]
            stream = stream or joined.add_stream_from_template(source)
            begin = round(done / rate_hz / source.time_base)
            for packet in container.demux(source):
                if packet.dts is not None:
                    packet.pts, packet.dts, packet.stream = packet.pts + begin, packet.dts + begin, stream
                    joined.mux(packet)
                    done += 1
