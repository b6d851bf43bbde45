"""The sound of a video: what reaches the two ears of the infant in it, as a WAV file and as the track of an MP4."""

import io
import wave
from pathlib import Path

import numpy as np
import numpy.typing as npt

from mimoc.bundle.files import write_file
from mimoc.components.senses.hearing.run import Hearing
from mimoc.runtime.infant import Infant

LOUDEST = 32_000
"""The loudest sample of a track, of 32,767: tracks are as loud as they can be, whatever their sound pressure."""
SUFFIX = ".wav"


def sound_file(video: str | Path) -> Path:
    """Return the file of the sound that belongs to a video."""
    return Path(video).expanduser().with_suffix(SUFFIX)


def hears(env: Infant) -> bool:
    """Return whether the infant of an environment has ears."""
    return isinstance(env.senses.get("hearing"), Hearing)


class SoundTrack:
    """What reaches an infant's ears, from the first time that it is asked, whatever its age hears of it."""

    def __init__(self, infant: Infant):
        self._infant, listener = infant, _hearing(infant).listener
        self.rate_hz = round(listener.rate_hz)
        self._index, self._blocks = listener.index, list[npt.NDArray[np.float32]]()

    def hear(self) -> None:
        """Take what has reached the ears since the last time; call this after each control step."""
        listener = _hearing(self._infant).listener
        count = listener.index - (self._index if listener.index >= self._index else 0)  # Else an episode began.
        self._index = listener.index
        if count:
            self._blocks.append(listener.pressure_pa[:, -count:].astype(np.float32))

    @property
    def samples(self) -> npt.NDArray[np.int16]:
        """All of it, shape (n, 2), the left ear first; the loudest sample is `LOUDEST`."""
        pressure = np.concatenate([np.zeros((2, 0), np.float32), *self._blocks], axis=1)
        loudest = float(np.abs(pressure).max(initial=0.0)) or 1.0
        return np.rint(pressure.T * (LOUDEST / loudest)).astype(np.int16)

    def save(self, file: Path) -> Path:
        """Write a WAV file in stereo, and return its path."""
        content = io.BytesIO()
        with wave.open(content, "wb") as written:
            written.setnchannels(2)
            written.setsampwidth(2)
            written.setframerate(self.rate_hz)
            written.writeframes(self.samples.astype("<i2").tobytes())
        return write_file(file, content.getvalue())


def _hearing(env: Infant) -> Hearing:
    hearing = env.senses["hearing"]
    assert isinstance(hearing, Hearing)
    return hearing
