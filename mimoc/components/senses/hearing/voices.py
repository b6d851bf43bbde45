"""Voices at the ears of an infant: its own, and those of other infants in its world.

Its own comes through the air, from the mouth around half of a quarter of the head, and through the bones as loud as
that (Békésy 1949, from memory), at once and alike at both ears. Those of others come through the air only, later and
weaker by their way to each ear. Pitch and loudness change evenly within each physics step.
"""

import math
from typing import Any

import numpy as np

from mimoc.base.state_form import check_form
from mimoc.components.senses.hearing.cochlea import REFERENCE_PA
from mimoc.components.senses.hearing.timbres import HARMONICS, PERIOD, Head, harmonic_period
from mimoc.runtime.sense import FloatArray
from mimoc.runtime.voice import Voice

BONES = math.sqrt(2.0)
"""By how much bones make the voice louder: both ways add their power."""
FARTHEST_S = 0.06
"""How long a voice is on its way at most: from 20 m away, nobody is heard."""


class VoiceTrack:
    """The wave of a voice by samples: its phase, in periods, and its gain, re 20 µPa at 1 m."""

    def __init__(self, voice: Voice, head: Head):
        self._voice, self._head = voice, head
        harmonics = max(1, min(HARMONICS, int(0.45 * head.sample_rate_hz / voice.entry.high_hz)))
        self.period = REFERENCE_PA * harmonic_period(voice.entry.high_hz, harmonics, head)
        """The wave w and its low part v by phase, as w + i v, shape (`PERIOD`,), [Pa]."""
        self.forget()

    def forget(self) -> None:
        """Begin an episode in silence; the voice itself, be it of another infant, may be reset after this."""
        self._phase, self._gain, self._rate_hz, self._end = 0.0, 0.0, self._voice.first_hz, 0
        self._parts: list[list[float]] = []

    def after_step(self, end: int) -> None:
        """Note what was commanded in a physics step that has been made, up to the sample with an index."""
        self._parts.append([end, self._voice.fundamental_hz, self._voice.gain])

    def take(self, count: int) -> tuple[FloatArray, FloatArray]:
        """Return phases and gains of the last samples since they were taken before, shape (count,) each."""
        phases, gains = zip(
            *[(np.zeros(count), np.zeros(count)), *(self._part(*part) for part in self._parts)], strict=True
        )
        self._parts = []
        return np.concatenate(phases)[-count:], np.concatenate(gains)[-count:]

    def _part(self, end: float, rate_hz: float, gain: float) -> tuple[FloatArray, FloatArray]:
        """Return phases and gains up to some sample, in which pitch and loudness become those of its end."""
        count = max(int(end) - self._end, 0)
        share = np.arange(1, count + 1) / max(count, 1)
        phases = self._phase + np.cumsum(self._rate_hz + share * (rate_hz - self._rate_hz)) / self._head.sample_rate_hz
        gains = self._gain + share * (gain - self._gain)
        self._phase = float(phases[-1] % 1.0) if count else self._phase
        self._rate_hz, self._gain, self._end = rate_hz, gain, int(end)
        return phases, gains

    @property
    def state(self) -> list[Any]:
        """Where the wave is, and what was commanded since it was taken."""
        return [[self._phase, self._gain, self._rate_hz, self._end], self._parts]

    @state.setter
    def state(self, state: list[Any]) -> None:
        check_form(state[0], [0.0, 0.0, 0.0, 0], "companions.hearing.voice")
        (self._phase, self._gain, self._rate_hz, self._end), parts = state
        self._parts = [[float(number) for number in part] for part in parts]


class OwnVoice:
    """The sound pressure of an infant's voice at its own ears."""

    def __init__(self, voice: Voice, head: Head):
        self.track = VoiceTrack(voice, head)
        self._period_pa: FloatArray = BONES / (math.pi / 2 * head.radius_m) * self.track.period.real

    def heard(self, count: int) -> FloatArray:
        """Return the pressure in the last samples, shape (count,), [Pa]."""
        phases, gains = self.track.take(count)
        if not gains.any():
            return np.zeros(count)
        return gains * self._period_pa.take((phases * PERIOD).astype(np.intp), mode="wrap")


class OtherVoice:
    """The sound pressure of another infant's voice at the ears of this one."""

    def __init__(self, voice: Voice, body: int, head: Head):
        self.track, self.body = VoiceTrack(voice, head), body
        self.point_m = np.array(voice.entry.mouth_m)
        """The mouth in the frame of the body, shape (3,)."""
        self._kept = round(FARTHEST_S * head.sample_rate_hz)
        self.forget()

    def forget(self) -> None:
        """Begin an episode in silence."""
        self.track.forget()
        self._phases, self._gains = np.zeros(self._kept), np.zeros(self._kept)
        self._way: tuple[FloatArray, Any] | None = None

    def heard(self, way: tuple[FloatArray, Any], count: int) -> FloatArray:
        """Return the pressure at both ears in the last samples, shape (2, count), [Pa].

        Args:
            way: The delay to each ear, in samples, and the gain a - i b, by which its wave w + i v is multiplied and of
                which the real part is heard, shape (2,) each, both of now; see `Mixer`.
            count: Number of samples.
        """
        phases, gains = self.track.take(count)
        phases += self._phases[-1] - self._phases[-1] % 1.0  # As if it had never been wrapped.
        phases, gains = np.concatenate([self._phases, phases]), np.concatenate([self._gains, gains])
        self._phases, self._gains = phases[-self._kept :], gains[-self._kept :]
        (delays, paths), (delays_before, paths_before) = way, self._way or way
        self._way = way
        if not gains.any():
            return np.zeros((2, count))
        share = np.arange(1, count + 1) / count
        places = (
            len(phases) - count + np.arange(count) - (delays_before[:, None] + np.outer(delays - delays_before, share))
        )
        samples = np.arange(len(phases))
        loudness = np.interp(places, samples, gains, left=0.0)
        wave = self.track.period.take((np.interp(places, samples, phases) * PERIOD).astype(np.intp), mode="wrap")
        return (wave * (paths_before[:, None] + np.outer(paths - paths_before, share))).real * loudness

    @property
    def state(self) -> list[Any]:
        """Its wave so far, and its way to the ears."""
        return [self.track.state, self._phases, self._gains, self._way and list(self._way)]

    @state.setter
    def state(self, state: list[Any]) -> None:
        check_form(state[1:3], [self._phases, self._gains], "companions.hearing.others")
        self.track.state, self._phases, self._gains, way = state
        self._way = way and (way[0], way[1])
