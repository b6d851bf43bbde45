"""An infant's own voice at its ears.

It comes through the air, from the mouth around half of a quarter of the head, and through the bones as loud as that
(Békésy 1949, from memory), at once and alike at both ears. Pitch and loudness change evenly within each physics step.
"""

import math
from typing import Any

import numpy as np

from mimoc.actuation.voice import Voice
from mimoc.base.state_form import check_form
from mimoc.senses.hearing.cochlea import REFERENCE_PA
from mimoc.senses.hearing.timbres import HARMONICS, PERIOD, Head, harmonic_period
from mimoc.senses.sense import FloatArray

BONES = math.sqrt(2.0)
"""By how much bones make the voice louder: both ways add their power."""


class OwnVoice:
    """The sound pressure of an infant's voice at its ears."""

    def __init__(self, voice: Voice, head: Head):
        """Hear a voice with a head."""
        self._voice, self._head = voice, head
        way_m = math.pi / 2 * head.radius_m
        harmonics = max(1, min(HARMONICS, int(0.45 * head.sample_rate_hz / voice.entry.high_hz)))
        period = harmonic_period(voice.entry.high_hz, harmonics, head).real
        self._period_pa: FloatArray = BONES * REFERENCE_PA / way_m * period
        self.forget()

    def forget(self) -> None:
        """Begin an episode in silence."""
        self._phase, self._gain, self._rate_hz, self._end = 0.0, 0.0, self._voice.fundamental_hz, 0
        self._parts: list[list[float]] = []

    def after_step(self, end: int) -> None:
        """Note what was commanded in a physics step that has been made, up to the sample with an index."""
        self._parts.append([end, self._voice.fundamental_hz, self._voice.gain])

    def heard(self, index: int, count: int) -> FloatArray:
        """Return the pressure in some samples from the one with an index on, shape (count,), in [Pa]."""
        sounds = [self._sound(*part) for part in self._parts]
        self._parts = []
        return np.concatenate([np.zeros(count), *sounds])[-count:]

    def _sound(self, end: float, rate_hz: float, gain: float) -> FloatArray:
        """Return the pressure up to some sample, in which pitch and loudness become those of its end."""
        count = max(int(end) - self._end, 0)
        share = np.arange(1, count + 1) / max(count, 1)
        phases = self._phase + np.cumsum(self._rate_hz + share * (rate_hz - self._rate_hz)) / self._head.sample_rate_hz
        gains = self._gain + share * (gain - self._gain)
        silent = not (gain or self._gain)
        self._phase = float(phases[-1] % 1.0) if count else self._phase
        self._rate_hz, self._gain, self._end = rate_hz, gain, int(end)
        if silent:
            return np.zeros(count)
        return gains * self._period_pa.take((phases * PERIOD).astype(np.intp), mode="wrap")

    @property
    def state(self) -> list[Any]:
        """Where its wave is, and what was commanded since it was heard last."""
        return [[self._phase, self._gain, self._rate_hz, self._end], self._parts]

    @state.setter
    def state(self, state: list[Any]) -> None:
        check_form(state[0], [0.0, 0.0, 0.0, 0], "companions.hearing.voice")
        (self._phase, self._gain, self._rate_hz, self._end), parts = state
        self._parts = [[float(number) for number in part] for part in parts]
