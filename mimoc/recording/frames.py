"""Pictures of a recording: one lossless video for each part of an episode and each eye."""

import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from mimoc.base.errors import RecordingError
from mimoc.bundle import files
from mimoc.bundle.regular_files import UnusableFileError, is_regular_file
from mimoc.recording.folder import opened
from mimoc.recording.video import CONTAINER, LOSSLESS, Lossless, Picture, require_av

EXTENSION = ".mkv"
SMALL_BYTES, MOST_RATIO = 2**28, 1000
"""What pictures may take however small their file is, and how many times its size."""
MOST_BYTES = 2**29
"""Of a video, besides twice its pictures."""


def write_pictures(path: Path, pictures: Picture, rate_hz: Fraction) -> None:
    """Write pictures, shape (n, height, width, 3), as a video without loss, or raise an OutputError."""
    try:
        video = Lossless(path, rate_hz)
        for picture in pictures:
            video.add(picture)
    except OSError as error:
        raise files.write_error(path, error) from None
    video.save()


def read_pictures(paths: Sequence[Path], count: int, shape: Sequence[int]) -> Picture:
    """Return the pictures in the videos of an episode's parts, shape (count, height, width, 3)."""
    pictures = list[Picture]()
    for path in paths:
        wanted = count - len(pictures)
        raw_bytes = math.prod(shape) * wanted if is_regular_file(path) else 0
        if raw_bytes > SMALL_BYTES and raw_bytes > MOST_RATIO * path.stat().st_size:
            raise RecordingError(f"{path}: the file is damaged: it cannot hold {wanted} such pictures")
        pictures += decoded(path, shape, wanted)
    if len(pictures) < count:
        raise RecordingError(
            f"{paths[-1]}: there are {len(pictures)} pictures up to its end, where {count} were recorded"
        )
    return np.stack(pictures)


def decoded(path: Path, shape: Sequence[int], most: int) -> Iterator[Picture]:
    """Yield the pictures of a video, at most so many, one after the other, each of *shape* (height, width, 3).

    The container is named: by its content, a file may be a list of others, elsewhere, which FFmpeg would open. A file
    that is far too large for so many pictures is not searched for them.
    """
    av, most_bytes = require_av(), MOST_BYTES + 2 * math.prod(shape) * most
    # ValueError: also what PyAV makes of texts that are no UTF-8; AttributeError: there is no decoder.
    damage = av.error.FFmpegError, OSError, IndexError, ValueError, AttributeError, MemoryError
    with opened(path, most_bytes, *damage) as file, av.open(file, format=CONTAINER) as container:
        stream = container.streams.video[0]
        if stream.codec_context.name != LOSSLESS:
            raise UnusableFileError(f"its pictures are not encoded by {LOSSLESS}")
        _check_size(stream, shape)
        for frame in islice(container.decode(stream), most):
            _check_size(frame, shape)
            yield frame.to_ndarray(format="rgb24")


def _check_size(pictures: Any, shape: Sequence[int]) -> None:
    """Check that a frame, or all of a stream, are of some shape, before anything of this size is made."""
    if (pictures.height, pictures.width, 3) != tuple(shape):
        raise UnusableFileError(f"its pictures are of another size than {shape[1]} x {shape[0]} pixels")
