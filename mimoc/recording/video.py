"""Video files: MP4 by PyAV, GIF by Pillow; and FFV1 in Matroska by PyAV, without loss."""

import io
import math
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import islice, pairwise
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from PIL import Image

from mimoc.base.errors import MissingExtraError, OutputError, RecordingError
from mimoc.bundle import files
from mimoc.bundle.regular_files import UnusableFileError, is_regular_file
from mimoc.recording.folder import opened

Picture = npt.NDArray[np.uint8]  # Shape (height, width, 3).

Sound = npt.NDArray[np.int16]  # Samples of the left and the right ear, shape (n, 2).

SOUND_CODEC, SOUND_RATES_HZ = (
    "aac",
    (8000, 11_025, 12_000, 16_000, 22_050, 24_000, 32_000, 44_100, 48_000, 64_000, 96_000),
)
CODECS = ("libx264", "mpeg4")  # Codecs for MP4 in order of preference; not every build of FFmpeg has the first.
QUALITY = {"crf": "20"}  # Constant quality of H.264, with hardly visible losses.
SMALL = {"crf": "26", "preset": "veryfast", "bf": "0"}
"""Settings of H.264 for what eyes saw: small, and pictures stand in the order in which they are shown."""
CONTAINER, LOSSLESS = "matroska", "ffv1"  # Names of container and codec of the pictures of a recording.
MIN_PX = 4  # Smallest side of a picture that FFV1 can cut into slices, as it does by itself.
SETTINGS = {"level": "3", "coder": "1", "context": "1", "g": "50"}
"""Settings of FFV1: range coder, large context, and what it has learned of the pictures is kept for that many of them,
which are decoded to reach the last one. The eyes of an infant that moves take 6.6 % of the raw size, where pictures
coded one by one take 8.2 %, PNG 10 % and the columns of a table, compressed by zstd, 11 to 14 %."""
GIF_TICKS_HZ = 100  # A GIF measures time in hundredths of a second.
GIF_COLOURS = 256
GIF_SAMPLES = 16  # Number of frames that the colours of a GIF are chosen from.
MAX_GIF_FRAMES = 3000
"""A GIF is assembled in memory, at about 50 kB per frame, and browsers do not handle longer ones well."""


SAME_BYTES = {"fflags": "+bitexact"}
"""Lets FFmpeg leave out of a container what differs each time: a random ID of Matroska's."""


class Video(ABC):
    """A video that is written to a temporary file, which is renamed when it is complete."""

    def __init__(self, file: Path, rate_hz: Fraction):
        self.file, self.rate_hz, self.pictures = file, rate_hz, 0
        self._temporary = files.temporary_path(file)

    def add(self, picture: Picture) -> None:
        """Add a frame, of the same size as the first."""
        self._write(picture)
        self.pictures += 1

    def open_sound(self, rate_hz: int) -> None:
        """Have a track of sound, if the format can; call this before the first frame."""
        return

    def save(self, sound: Sound | None = None) -> Path:
        """Save the frames added so far, at least one, and return the path of the file, or raise an OutputError."""
        try:
            self._finish(sound)
            return files.move_into_place(self._temporary, self.file)
        except BaseException as error:
            self.discard()
            raise files.write_error(self.file, error) if isinstance(error, OSError) else error from None

    def discard(self) -> None:
        """Remove the temporary file."""
        files.discard(self._temporary)

    @abstractmethod
    def _write(self, picture: Picture) -> None:
        """Write a frame."""

    @abstractmethod
    def _finish(self, sound: Sound | None) -> None:
        """Write everything that remains to be written."""


class _Encoded(Video):
    """A video of one stream, which FFmpeg encodes."""

    def __init__(self, file: Path, rate_hz: Fraction, container: str, codec: str, pixels: str, **how: Any):
        super().__init__(file, rate_hz)
        self._av = require_av()
        options = {**SAME_BYTES, **how.pop("flags", {})}
        self._container = self._av.open(str(self._temporary), "w", format=container, options=options)
        self._stream = self._container.add_stream(codec, rate=rate_hz, **how)
        self._stream.pix_fmt = pixels
        self._track: Any = None

    def _write(self, picture: Picture) -> None:
        if not self.pictures:
            self._stream.height, self._stream.width = picture.shape[:2]
        self._container.mux(self._stream.encode(self._av.VideoFrame.from_ndarray(picture, "rgb24")))

    def _finish(self, sound: Sound | None) -> None:
        self._container.mux(self._stream.encode())
        if self._track is not None and sound is not None and len(sound):
            frame = self._av.AudioFrame.from_ndarray(sound.reshape(1, -1), format="s16", layout="stereo")
            frame.sample_rate = self._track.rate
            self._container.mux(self._track.encode(frame))
            self._container.mux(self._track.encode())
        self._container.close()

    def discard(self) -> None:
        self._container.close()
        super().discard()


class Mp4(_Encoded):
    """H.264 in an MP4 file, which browsers and presentations can play."""

    def __init__(self, file: Path, rate_hz: Fraction, quality: Mapping[str, str] = QUALITY):
        codec = next(name for name in CODECS if name in require_av().codecs_available)
        options = quality if codec == CODECS[0] else {}
        super().__init__(file, rate_hz, "mp4", codec, "yuv420p", options=options, flags={"movflags": "+faststart"})

    def open_sound(self, rate_hz: int) -> None:
        """Have a track of sound in AAC, if that has this sample rate."""
        if rate_hz in SOUND_RATES_HZ:
            self._track = self._container.add_stream(SOUND_CODEC, rate=rate_hz, layout="stereo")

    def _write(self, picture: Picture) -> None:
        rows, columns = (side % 2 for side in picture.shape[:2])
        super()._write(np.pad(picture, ((0, rows), (0, columns), (0, 0)), mode="edge"))  # Chroma is halved.


class Lossless(_Encoded):
    """FFV1 in a Matroska file, from which every pixel comes back as it was."""

    def __init__(self, file: Path, rate_hz: Fraction):
        super().__init__(file, rate_hz, CONTAINER, LOSSLESS, "bgr0", options=SETTINGS)

    def _write(self, picture: Picture) -> None:
        if min(picture.shape[:2]) < MIN_PX:
            self._stream.codec_context.options = {**SETTINGS, "slices": "1"}
        super()._write(picture)


class Gif(Video):
    """A looping GIF whose frames share one palette."""

    def __init__(self, file: Path, rate_hz: Fraction):
        super().__init__(file, rate_hz)
        self._temporary.touch()
        self._kept: list[io.BytesIO] = []

    def _write(self, picture: Picture) -> None:
        if self.pictures == MAX_GIF_FRAMES:
            raise OutputError(
                f"{self.file}: a GIF can have at most {MAX_GIF_FRAMES} frames; record fewer steps, or an .mp4"
            )
        png = io.BytesIO()
        Image.fromarray(picture).save(png, "PNG", compress_level=1)
        self._kept.append(png)

    def _finish(self, sound: Sound | None) -> None:
        samples = self._kept[:: -(-self.pictures // GIF_SAMPLES)]
        together = np.concatenate([np.asarray(Image.open(png)) for png in samples])
        palette = Image.fromarray(together).quantize(GIF_COLOURS, Image.Quantize.FASTOCTREE)  # Keeps small bright ones.
        first, *others = (Image.open(png).quantize(palette=palette, dither=Image.Dither.NONE) for png in self._kept)
        ends = [round(GIF_TICKS_HZ * number / self.rate_hz) for number in range(self.pictures + 1)]
        durations_ms = [1000 // GIF_TICKS_HZ * (end - start) for start, end in pairwise(ends)]
        first.save(self._temporary, "GIF", save_all=True, append_images=others, duration=durations_ms, loop=0)


FORMATS: Mapping[str, type[Video]] = {".mp4": Mp4, ".gif": Gif}  # Formats by file extension.


def check_video(file: str | Path) -> Path:
    """Check, before anything is recorded, that a video can be written to a file; return its path."""
    path = Path(file).expanduser()
    if path.suffix.lower() not in FORMATS:
        raise OutputError(f"{path}: not a supported video format; end the name in {' or '.join(FORMATS)}")
    if path.is_dir():
        raise OutputError(f"{path}: this is a folder; choose another file")
    if not path.parent.is_dir():
        raise OutputError(f"{path}: there is no folder {path.parent}; create it, or choose another file")
    if path.suffix.lower() == ".mp4":
        require_av()
    return path


def open_video(file: str | Path, rate_hz: Fraction) -> Video:
    """Return a video to add frames to, in the format of the extension of its file; see `check_video`."""
    path = check_video(file)
    try:
        return FORMATS[path.suffix.lower()](path, rate_hz)
    except OSError as error:
        raise files.write_error(path, error) from None


def require_av() -> Any:
    """Return PyAV."""
    try:
        import av
    except ImportError:
        raise MissingExtraError("av", "record") from None
    return av


PICTURES_SUFFIX = ".mkv"
SMALL_BYTES, MAX_RATIO = 2**28, 1000
"""What pictures may take however small their file is, and how many times its size."""
MAX_BYTES = 2**29  # Largest size of a video, besides twice its pictures.


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
        if raw_bytes > SMALL_BYTES and raw_bytes > MAX_RATIO * path.stat().st_size:
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
    av = require_av()
    most_bytes = MAX_BYTES + 2 * math.prod(shape) * most
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
