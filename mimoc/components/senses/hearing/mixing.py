"""Sounds on their way to the ears: each as its source made it, later and weaker by its way to each ear.

Between two times at which they are mixed, the way of each sound changes evenly, so that nothing clicks where they meet:

    p(t) = Σ sources  a(t) w(t - start - d(t)) + b(t) v(t - start - d(t))

with the wave w and its low part v, the delay d = distance / c + T(β), a = a(β) / distance, b = (1 - a(β)) / distance
(`mimoc.base.geometry.spherical_head`).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from mimoc.base.geometry.spherical_head import SOUND_M_S, ear_angles, ear_delays_s, high_share
from mimoc.components.senses.hearing.timbres import FINER, LONGEST_S, Head, Timbre, Wave, wave_of, wave_of_pressure
from mimoc.runtime.sense import FloatArray, IntArray

SILENCE = np.zeros(2, np.complex64)
"""Before the first wave of the bank, and after each."""
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
    lasts: float = math.inf
    """Samples after which nobody hears it any more."""

    def wave(self, head: Head) -> Wave:
        """Return its wave."""
        if isinstance(self.what, Timbre):
            return wave_of(self.what, head)
        return wave_of_pressure(self.what, head.sample_rate_hz, head)


class Mixer:
    """The sounds that are on their way to one head."""

    def __init__(self, head: Head, body: int, centre_m: Sequence[float]):
        self._head, self._body, self._centre_m = head, body, np.array(centre_m)
        self.forget()

    def forget(self) -> None:
        """Forget all sounds."""
        self.sources: list[Source] = []
        self.delays: FloatArray = np.zeros((0, 2))
        """Of each sound to each ear when they were mixed last, in samples; NaN before."""
        self.gains: Any = np.zeros((0, 2), complex)
        """Likewise a - i b, by which its wave w + i v is multiplied, of which the real part is heard."""
        self._stack([])

    def add(self, sources: Sequence[Source]) -> None:
        """Let sounds begin."""
        unknown = np.full((len(sources), 2), np.nan)
        self.delays, self.gains = np.concatenate([self.delays, unknown]), np.concatenate([self.gains, unknown])
        self._stack([*self.sources, *sources])
        if len(self.sources) > MOST:
            self._keep(np.sort(np.argsort([-source.gain for source in self.sources], kind="stable")[:MOST]))

    def restore(self, sources: Sequence[Source], delays: FloatArray, gains: Any) -> None:
        """Go on with sounds on their way."""
        self.delays, self.gains = delays, gains
        self._stack(list(sources))

    def mix(self, data: mujoco.MjData, index: int, count: int) -> FloatArray:
        """Return what reaches the ears in some samples from the one with an index on, shape (2, count), in [Pa]."""
        if not self.sources:
            return np.zeros((2, count))
        delays, gains = self._ways(data, self._bodies, self._points_m, self._loudness)
        delays_before, gains_before = (
            np.where(np.isnan(self.delays), now, before) for now, before in ((delays, self.delays), (gains, self.gains))
        )
        later = np.arange(1, count + 1)
        slopes = FINER * (1 - (delays - delays_before) / count)
        places = (FINER * (index - 1 - self._starts[:, None] - delays_before))[..., None] + slopes[..., None] * later
        whole = np.floor(places)
        first = np.minimum(np.maximum(whole, -1.0), self._lengths[:, None, None]).astype(np.intp)
        first += self._offsets[:, None, None]
        wave = self._bank.take(first)
        wave += (places - whole).astype(np.float32) * (self._bank.take(first + 1) - wave)
        wave *= whole < self._lengths[:, None, None]
        wave *= gains_before[..., None] + ((gains - gains_before) / count)[..., None] * later
        self.delays, self.gains = delays, gains
        self._keep(np.flatnonzero(places[:, :, -1].min(axis=1) < self._lengths))
        return np.add.reduce(wave.real, axis=0, dtype=np.float64)

    def way(self, data: mujoco.MjData, body: int, point_m: FloatArray) -> tuple[FloatArray, Any]:
        """Return delays and gains of a sound of a place on a body, shape (2,) each; see `_ways`."""
        delays, gains = self._ways(data, np.array([body]), point_m[None], np.ones(1))
        return delays[0], gains[0]

    def _ways(
        self, data: mujoco.MjData, bodies: IntArray, points_m: FloatArray, loudness: FloatArray
    ) -> tuple[FloatArray, Any]:
        """Return the delays of each sound to each ear [samples], and the gains a - i b, shape (sounds, 2) each."""
        world_from_head = data.xmat[self._body].reshape(3, 3)
        centre_m = data.xpos[self._body] + world_from_head @ self._centre_m
        turned_m = (data.xmat.take(bodies, 0).reshape(-1, 3, 3) @ points_m[:, :, None])[:, :, 0]
        towards_m = (data.xpos.take(bodies, 0) + turned_m - centre_m) @ world_from_head
        distances_m = np.maximum(np.sqrt(np.add.reduce(towards_m**2, axis=1)), 1e-6)[:, None]
        angles = ear_angles(towards_m / distances_m)
        distances_m = np.maximum(distances_m, self._head.radius_m)
        delays_s = distances_m / SOUND_M_S + ear_delays_s(angles, self._head.radius_m)
        high = high_share(angles)
        gains = (high - 1j * (1 - high)) * (loudness[:, None] / distances_m)
        return delays_s * self._head.sample_rate_hz, gains

    def _keep(self, kept: IntArray) -> None:
        if len(kept) < len(self.sources):
            self.delays, self.gains = self.delays[kept], self.gains[kept]
            self._stack([self.sources[place] for place in kept.tolist()])

    def _stack(self, sources: list[Source]) -> None:
        """Put the waves of sounds, those that are alike once, and all else of them into arrays."""
        self.sources = sources
        keys: list[Any] = [source.what if isinstance(source.what, Timbre) else id(source) for source in sources]
        waves = {key: source.wave(self._head) for key, source in dict(zip(keys, sources, strict=True)).items()}
        starts, bank = dict[Any, int](), [SILENCE]
        for key, wave in waves.items():
            starts[key] = sum(map(len, bank))
            bank += [wave, SILENCE]
        self._bank = np.concatenate(bank)
        ends = [FINER * min(source.lasts, LONGEST_S * self._head.sample_rate_hz) for source in sources]
        self._lengths = np.array([min(len(waves[key]), int(end)) for key, end in zip(keys, ends, strict=True)], np.intp)
        self._offsets = np.array([starts[key] for key in keys], np.intp)
        self._starts = np.array([source.start for source in sources])
        self._loudness = np.array([source.gain for source in sources])
        self._bodies = np.array([source.body for source in sources], np.intp)
        self._points_m = np.array([source.point_m for source in sources]).reshape(-1, 3)
