"""An infant's voice while it lives: its two commands, pitch and loudness, the last ones of an action."""

import math

import numpy as np
import numpy.typing as npt

from mimoc.schema.actuation import VoiceEntry

FloatArray = npt.NDArray[np.float64]

LOW, HIGH = np.array([-1.0, 0.0]), np.array([1.0, 1.0])
"""Range of both commands."""


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
        self.commanded: FloatArray = np.zeros(2)
        """Pitch and loudness."""

    @property
    def fundamental_hz(self) -> float:
        """Fundamental frequency now."""
        return self._fundamental_hz(float(self.commanded[0]))

    @property
    def first_hz(self) -> float:
        """Fundamental frequency at the start of every episode, whatever was commanded in the one before."""
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
