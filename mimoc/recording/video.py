"""Video files: MP4 by PyAV, GIF by Pillow."""

import io
from abc import ABC, abstractmethod
from collections.abc import Mapping
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from PIL import Image

from mimoc.bundle import files
from mimoc.errors import MissingExtraError, OutputError

Picture = npt.NDArray[np.uint8]
"""Shape (height, width, 3)."""

CODECS = ("libx264", "mpeg4")
"""For MP4, the better one first; not every build of FFmpeg has it."""
QUALITY = {"crf": "20"}
"""Constant quality of H.264: hardly to be told from what was drawn."""
GIF_TICKS_HZ = 100
"""A GIF counts time in hundredths of a second."""
GIF_COLOURS = 256
GIF_SAMPLES = 16
"""Pictures of a GIF that its colours are chosen from."""
MOST_OF_A_GIF = 3000
"""Pictures: a GIF is put together in memory, of some 50 kB for each, and no browser likes one of two minutes."""


class Video(ABC):
    """A film that is being written, beside the file whose place it takes once it is whole."""

    def __init__(self, file: Path, rate_hz: Fraction):
        self.file, self.rate_hz, self.pictures = file, rate_hz, 0
        self._temporary = files.temporary_path(file)

    def add(self, picture: Picture) -> None:
        """Add a picture, of the size of the first."""
        self._write(picture)
        self.pictures += 1

    def save(self) -> Path:
        """Put what was added so far, at least one picture, into its place, and return where that is.

        Raises:
            OutputError: If it cannot be written.
        """
        try:
            self._finish()
        except OSError as error:
            self.discard()
            raise files.write_error(self.file, error) from None
        return files.move_into_place(self._temporary, self.file)

    def discard(self) -> None:
        """Leave nothing behind."""
        files.discard(self._temporary)

    @abstractmethod
    def _write(self, picture: Picture) -> None:
        """Take a picture."""

    @abstractmethod
    def _finish(self) -> None:
        """Write all that there is to write."""


class Mp4(Video):
    """H.264 in an MP4 file, which browsers and slides play."""

    def __init__(self, file: Path, rate_hz: Fraction):
        super().__init__(file, rate_hz)
        self._av = _require_av()
        self._container = self._av.open(str(self._temporary), "w", format="mp4", options={"movflags": "+faststart"})
        codec = next(name for name in CODECS if name in self._av.codecs_available)
        self._stream = self._container.add_stream(codec, rate=rate_hz, options=QUALITY if codec == CODECS[0] else {})
        self._stream.pix_fmt = "yuv420p"

    def _write(self, picture: Picture) -> None:
        rows, columns = (side % 2 for side in picture.shape[:2])
        even = np.pad(picture, ((0, rows), (0, columns), (0, 0)), mode="edge")  # Colours have half the pixels.
        if not self.pictures:
            self._stream.height, self._stream.width = even.shape[:2]
        self._container.mux(self._stream.encode(self._av.VideoFrame.from_ndarray(even, "rgb24")))

    def _finish(self) -> None:
        self._container.mux(self._stream.encode())
        self._container.close()

    def discard(self) -> None:
        """Leave nothing behind."""
        self._container.close()
        super().discard()


class Gif(Video):
    """A GIF that is played for ever; its pictures share their colours."""

    def __init__(self, file: Path, rate_hz: Fraction):
        super().__init__(file, rate_hz)
        self._temporary.touch()
        self._kept: list[bytes] = []

    def _write(self, picture: Picture) -> None:
        if self.pictures == MOST_OF_A_GIF:
            raise OutputError(f"{self.file}: a GIF has at most {MOST_OF_A_GIF} pictures; film fewer steps, or an .mp4")
        png = io.BytesIO()
        Image.fromarray(picture).save(png, "PNG", compress_level=1)
        self._kept.append(png.getvalue())

    def _finish(self) -> None:
        palette = self._palette()
        first, *others = (
            Image.open(io.BytesIO(png)).quantize(palette=palette, dither=Image.Dither.NONE) for png in self._kept
        )
        ends = [round(GIF_TICKS_HZ * number / self.rate_hz) for number in range(self.pictures + 1)]
        durations_ms = [1000 // GIF_TICKS_HZ * (end - start) for start, end in pairwise(ends)]
        first.save(self._temporary, "GIF", save_all=True, append_images=others, duration=durations_ms, loop=0)

    def _palette(self) -> Image.Image:
        """Return a picture with the colours of all."""
        samples = self._kept[:: -(-self.pictures // GIF_SAMPLES)]
        together = np.concatenate([np.asarray(Image.open(io.BytesIO(png))) for png in samples])
        return Image.fromarray(together).quantize(GIF_COLOURS, Image.Quantize.FASTOCTREE)  # Keeps small bright things.


FORMATS: Mapping[str, type[Video]] = {".mp4": Mp4, ".gif": Gif}
"""By the end of a file's name."""


def check_video(file: str | Path) -> Path:
    """Return the path of a video that can be written, as far as can be told beforehand.

    Raises:
        OutputError: If it is no name for a video, or in a place where none can be.
        MissingExtraError: If PyAV is not installed, which MP4 needs.
    """
    path = Path(file).expanduser()
    if path.suffix.lower() not in FORMATS:
        raise OutputError(f"{path}: not a video that mimoc writes; end its name with {' or '.join(FORMATS)}")
    if path.is_dir():
        raise OutputError(f"{path}: this is a folder; choose another place")
    if not path.parent.is_dir():
        raise OutputError(f"{path}: there is no folder {path.parent}; make it, or choose another place")
    if path.suffix.lower() == ".mp4":
        _require_av()
    return path


def open_video(file: str | Path, rate_hz: Fraction) -> Video:
    """Return a video to add pictures to.

    Args:
        file: Where it goes; the end of its name says what it is.
        rate_hz: Pictures a second.

    Raises:
        OutputError: If it cannot be written there.
        MissingExtraError: If PyAV is not installed, which MP4 needs.
    """
    path = check_video(file)
    try:
        return FORMATS[path.suffix.lower()](path, rate_hz)
    except OSError as error:
        raise files.write_error(path, error) from None


def _require_av() -> Any:
    """Return PyAV."""
    try:
        import av
    except ImportError:
        raise MissingExtraError("av", "record") from None
    return av
