"""Sounds in an infant's world, for senses to hear and for the tracks of videos, and the infant's own voice."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.schema.actuation import VoiceEntry

FloatArray = npt.NDArray[np.float64]

VOICE_LOW, VOICE_HIGH = np.array([-1.0, 0.0]), np.array([1.0, 1.0])  # Range of the commands: pitch and loudness.


class Voice:
    """What a voice is commanded now.

    A pitch p from -1 to 1 is the fundamental frequency low (high / low)^((p + 1) / 2), and a loudness of 0 to 1 is the
    share of the largest sound pressure.
    """

    def __init__(self, entry: VoiceEntry):
        self.entry = entry
        self.reset()

    def reset(self) -> None:
        """Fall silent."""
        self.commanded: FloatArray = np.zeros(2)  # Pitch and loudness.

    @property
    def fundamental_hz(self) -> float:
        """Fundamental frequency now."""
        return self._fundamental_hz(float(self.commanded[0]))

    @property
    def first_hz(self) -> float:
        """Fundamental frequency at the start of every episode."""
        return self._fundamental_hz(0.0)

    def _fundamental_hz(self, pitch: float) -> float:
        low_hz, high_hz = self.entry.low_hz, self.entry.high_hz
        return low_hz * (high_hz / low_hz) ** (min(max(pitch, -1.0), 1.0) / 2 + 0.5)

    @property
    def level_db(self) -> float:
        """Sound pressure level at 1 m now, re 20 µPa; minus infinity in silence."""
        return 20 * math.log10(self.gain) if self.gain else -math.inf

    @property
    def gain(self) -> float:
        """Root mean square of the sound pressure at 1 m now, re 20 µPa."""
        return min(max(float(self.commanded[1]), 0.0), 1.0) * math.pow(10, self.entry.loudest_db / 20)


SILENT_AFTER_MS = 2000.0  # Until then, delays and echoes can bring an ended sound to an ear.


@dataclass(frozen=True, slots=True)
class Sound:
    """A sound that has begun at a physics step, at a point of a body."""

    start_step: int  # Physics steps from the start of the episode to its beginning, of `step_of`.
    duration_ms: float  # How long its source sounds, onset and decay included.
    fundamental_hz: float  # Fundamental frequency; of an impact, that of the lowest mode.
    level_db: float  # Sound pressure level at 1 m from the source, in free field, re 20 µPa.
    kind: str  # What it is like: `voice`, `impact` ...
    source: str  # What sounds, such as `caregiver`.
    body: int  # The body of the model that it is on; 0 is the world.
    point_m: tuple[float, float, float]  # Its place in the frame of that body.


class SoundSources(Protocol):
    """A source of sounds in a world."""

    def sounds(self, data: mujoco.MjData) -> Sequence[Sound]:
        """Return what has begun by now and sounds, or ended within `SILENT_AFTER_MS`."""
        ...


def step_of(time_s: float, timestep_s: float) -> int:
    """Return the number of physics steps at a time of the simulation (`data.time`)."""
    return round(time_s / timestep_s)
