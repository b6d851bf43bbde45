"""Sounds on their way to the ears: each as its source made it, later and weaker by its way to each ear.

Between two times at which they are mixed, the way of each sound changes evenly, so that nothing clicks where they meet:

    p(t) = Σ sources  a(t) w(t - start - d(t)) + b(t) v(t - start - d(t))

with the wave w and its low part v, the delay d = distance / c + T(γ), a = a(γ) / distance, b = (1 - a(γ)) / distance
(`mimoc.geometry.spherical_head`).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from mimoc.geometry.spherical_head import SOUND_M_S, ear_angles, ear_delays_s, high_share
from mimoc.senses.hearing.timbres import FINER, Head, Timbre, Wave, wave_of, wave_of_pressure
from mimoc.senses.sense import FloatArray, IntArray

MOST = 32
"""Sounds that are heard at once; of more, the quietest are not."""


@dataclass(frozen=True, slots=True)
class Source:
    """A sound from its beginning on."""

    what: Timbre | FloatArray
    """What it is like, or its pressure in [Pa] at 1 m, shape (n,), at the sample rate."""
    gain: float
    """By which its wave is multiplied."""
    start: float
    """When it begins, in samples from the start of the episode."""
    body: int
    """The body that it is on."""
    point_m: FloatArray
    """Its place in the frame of that body, shape (3,)."""

    def wave(self, head: Head) -> Wave:
        """Return its wave."""
        if isinstance(self.what, Timbre):
            return wave_of(self.what, head)
        return wave_of_pressure(self.what, head.sample_rate_hz, head)


class Mixer:
    """The sounds that are on their way to one head."""

    def __init__(self, head: Head, body: int, centre_m: Sequence[float]):
        """Hear with a head, whose centre is at a place in the frame of a body."""
        self._head, self._body, self._centre_m = head, body, np.array(centre_m)
        self.forget()

    def forget(self) -> None:
        """Forget all sounds."""
        self.sources: list[Source] = []
        self.ways: FloatArray = np.zeros((0, 2, 3))
        """Delay [samples], a and b of each sound to each ear when they were mixed last; NaN before."""
        self._stack([])

    def add(self, sources: Sequence[Source]) -> None:
        """Let sounds begin."""
        self.ways = np.concatenate([self.ways, np.full((len(sources), 2, 3), np.nan)])
        self._stack([*self.sources, *sources])
        if len(self.sources) > MOST:
            self._keep(np.sort(np.argsort([-source.gain for source in self.sources], kind="stable")[:MOST]))

    def restore(self, sources: Sequence[Source], ways: FloatArray) -> None:
        """Go on with sounds on their way."""
        self.ways = ways
        self._stack(list(sources))

    def mix(self, data: mujoco.MjData, index: int, count: int) -> FloatArray:
        """Return what reaches the ears in some samples from the one with an index on, shape (2, count), in [Pa]."""
        if not self.sources:
            return np.zeros((2, count))
        ways = self._ways_now(data)
        before = np.where(np.isnan(self.ways), ways, self.ways)
        between = np.arange(1, count + 1) / count
        delays, high, low = (before[..., None] + (ways - before)[..., None] * between).transpose(2, 0, 1, 3)
        places = (np.arange(index, index + count) - self._starts[:, None, None] - delays) * FINER
        whole = np.floor(places)
        first = whole.astype(np.int64)
        sounds = (first >= 0) & (first < self._lengths[:, None, None] - 1)
        first = np.where(sounds, first + self._offsets[:, None, None], 0)
        wave = self._bank.take(first)
        wave += (places - whole).astype(np.float32) * (self._bank.take(first + 1) - wave)
        mixed: FloatArray = np.sum((high * wave.real + low * wave.imag) * sounds, axis=0)
        self.ways = ways
        self._keep(np.flatnonzero(places[:, :, -1].min(axis=1) < self._lengths))
        return mixed

    def _ways_now(self, data: mujoco.MjData) -> FloatArray:
        """Return the delay [samples], a and b of each sound to each ear, shape (sounds, 2, 3)."""
        world_from_head = data.xmat[self._body].reshape(3, 3)
        centre_m = data.xpos[self._body] + world_from_head @ self._centre_m
        turned_m = (data.xmat.take(self._bodies, 0).reshape(-1, 3, 3) @ self._points_m[:, :, None])[:, :, 0]
        towards_m = (data.xpos.take(self._bodies, 0) + turned_m - centre_m) @ world_from_head
        distances_m = np.maximum(np.sqrt(np.sum(towards_m**2, axis=1)), 1e-6)[:, None]
        angles = ear_angles(towards_m / distances_m)
        distances_m = np.maximum(distances_m, self._head.radius_m)
        delays_s = distances_m / SOUND_M_S + ear_delays_s(angles, self._head.radius_m)
        gains = self._gains[:, None] / distances_m
        high = high_share(angles) * gains
        return np.stack([delays_s * self._head.sample_rate_hz, high, gains - high], axis=2)

    def _keep(self, kept: IntArray) -> None:
        if len(kept) < len(self.sources):
            self.ways = self.ways[kept]
            self._stack([self.sources[place] for place in kept.tolist()])

    def _stack(self, sources: list[Source]) -> None:
        """Put the waves of sounds, those that are alike once, and all else of them into arrays."""
        self.sources = sources
        waves: dict[Any, Wave] = {}
        for source in sources:
            key = source.what if isinstance(source.what, Timbre) else id(source)
            waves.setdefault(key, source.wave(self._head))
        ends = dict(zip(waves, np.cumsum([len(wave) for wave in waves.values()]).tolist(), strict=True))
        keys = [source.what if isinstance(source.what, Timbre) else id(source) for source in sources]
        self._bank = np.concatenate([*waves.values(), np.zeros(1, np.complex64)])
        self._lengths = np.array([len(waves[key]) for key in keys], np.int64)
        self._offsets = np.array([ends[key] for key in keys], np.int64) - self._lengths
        self._starts = np.array([source.start for source in sources])
        self._gains = np.array([source.gain for source in sources])
        self._bodies = np.array([source.body for source in sources], np.intp)
        self._points_m = np.array([source.point_m for source in sources]).reshape(-1, 3)
