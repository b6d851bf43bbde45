"""What is to be heard of a world: it sees each physics step for impacts, and mixes sounds for the ears when asked.

physics steps  |  1  |  2  |  3  |  4  |  impacts are found after each of them
samples        |.....|.....|.....|.....|  mixed when the sense is sampled, of all time since it last was,
the sense            ^           ^        so that they follow each other without a gap

Sounds on their way to the ears: each as its source made it, later and weaker by its way to each ear.

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
from mimoc.base.state_form import check_form, require
from mimoc.bundle.io import Bundle
from mimoc.components.senses.hearing import HearingEntry
from mimoc.components.senses.hearing.sounds import (
    FINER,
    LONGEST_S,
    Contacts,
    Head,
    Impact,
    OtherVoice,
    OwnVoice,
    Resonators,
    Timbre,
    VoiceTrack,
    Wave,
    partials_of,
    resampled,
    wave_of,
    wave_of_pressure,
)
from mimoc.runtime.companion import Companion
from mimoc.runtime.sense import FloatArray, IntArray
from mimoc.runtime.sound import Sound, SoundSources, Voice

SILENCE = np.zeros(2, np.complex64)  # Before the first wave of the bank, and after each.
MAX_SOURCES = 32  # Sounds that are heard at once; of more, the quietest are not.


@dataclass(frozen=True, slots=True)
class Source:
    """A sound from its beginning on."""

    what: Timbre | FloatArray  # What it is like, or its pressure in [Pa] at 1 m, shape (n,), at the sample rate.
    gain: float  # By which its wave is multiplied.
    start: float  # When it begins, in samples from the start of the episode.
    body: int  # The body that it is on.
    point_m: FloatArray  # Its place in the frame of that body, shape (3,).
    lasts: float = math.inf  # Samples after which nobody hears it any more.

    def wave(self, head: Head) -> Wave:
        """Return its wave."""
        if isinstance(self.what, Timbre):
            return wave_of(self.what, head)
        return wave_of_pressure(self.what, head.sample_rate_hz, head)


class Mixer:
    """The sounds that are on their way to one head."""

    def __init__(self, head: Head, body: int, centre_m: Sequence[float]):
        self._head = head
        self._body = body
        self._centre_m = np.array(centre_m)
        self.forget()

    def forget(self) -> None:
        """Forget all sounds."""
        self.sources: list[Source] = []
        self.delays: FloatArray = np.zeros((0, 2))
        """Delay of each sound to each ear when they were mixed last, in samples; NaN before."""
        self.gains: Any = np.zeros((0, 2), complex)
        """Likewise its gain a - i b: its wave w + i v is multiplied by it, and the real part is heard."""
        self._stack([])

    def add(self, sources: Sequence[Source]) -> None:
        """Let sounds begin."""
        unknown = np.full((len(sources), 2), np.nan)
        self.delays, self.gains = np.concatenate([self.delays, unknown]), np.concatenate([self.gains, unknown])
        self._stack([*self.sources, *sources])
        if len(self.sources) > MAX_SOURCES:
            self._keep(np.sort(np.argsort([-source.gain for source in self.sources], kind="stable")[:MAX_SOURCES]))

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


MAX_SAMPLES = 3_000_000  # A minute at 48 kHz.
MAX_S = 60.0  # Longest sound: whatever its own rate, it is kept at that of the ears.
MAX_PA = 1e5  # Largest sound pressure: that of the air, below which no sound in air can fall.
MAX_M = 1000.0  # Largest coordinate of a place.
RATES_HZ = 1000.0, 400_000.0


def checked_playback(pressure_pa: Any, rate_hz: Any, point_m: Any) -> tuple[FloatArray, float, FloatArray]:
    """Return a sound pressure, shape (n,), its sample rate and its place, shape (3,), as arrays.

    Raises:
        ValueError: If something is wrong with them.
    """
    pressure, place, rate = _numbers(pressure_pa), _numbers(point_m), _numbers(rate_hz)
    if rate is None or rate.shape != () or not RATES_HZ[0] <= rate <= RATES_HZ[1]:
        raise ValueError(f"expected a sample rate from {RATES_HZ[0]:g} to {RATES_HZ[1]:g} Hz, got {rate_hz!r:.60}")
    most = min(MAX_SAMPLES, int(MAX_S * rate))
    if pressure is None or pressure.ndim != 1 or not 2 <= len(pressure) <= most:
        shape = "other data" if pressure is None else f"shape {pressure.shape}"
        raise ValueError(f"expected 2 to {most:,} samples ({MAX_S:g} s at most) of a sound pressure, got {shape}")
    if not np.abs(pressure).max() <= MAX_PA:
        raise ValueError(f"expected finite sound pressures of at most {MAX_PA:g} Pa, got {np.abs(pressure).max():g}")
    if place is None or place.shape != (3,) or not np.abs(place).max() <= MAX_M:
        raise ValueError(f"expected a place of three numbers of at most {MAX_M:g} m, got {point_m!r:.60}")
    return pressure, float(rate), place


def _numbers(values: Any) -> FloatArray | None:
    try:
        array = np.asarray(values)
    except ValueError:  # Rows of several lengths.
        return None
    return array.astype(np.float64) if array.dtype.kind in "iuf" else None


CLOSE_DB = 10.0
"""Impacts end when all their partials are so far below their thresholds at the head: within 25 ms they are 7 dB louder
than within the 125 ms of their level."""


class Listener(Companion):
    """The ears of one infant: the sound pressure at each, of all sounds in its world."""

    def __init__(self, entry: HearingEntry, model: mujoco.MjModel, bundle: Bundle, samples: int):
        self._model = model
        self._head = Head(entry.radius_m, float(entry.sample_rate_hz))
        self._body = model.body(entry.head).id
        self._thresholds = np.log(entry.threshold_hz or (1.0,)), np.array(entry.threshold_db or (0.0,))
        self._timestep_s, self._samples = model.opt.timestep, samples
        self._contacts = Contacts(Resonators(model, bundle))
        self._mixer = Mixer(self._head, self._body, entry.centre_m)
        self._sources: Sequence[SoundSources] = ()
        self._voice: OwnVoice | None = None
        self._others: list[OtherVoice] = []
        self._forget()

    @property
    def rate_hz(self) -> float:
        """Samples per second."""
        return self._head.sample_rate_hz

    def listen_to(self, sources: SoundSources, voice: Voice | None = None, others: Sequence[Voice] = ()) -> None:
        """Hear what these let sound, the infant's own voice, and those of others in its world."""
        self._sources = (sources,)
        self._voice = OwnVoice(voice, self._head) if voice else None
        self._others = [OtherVoice(other, self._model.body(other.entry.head).id, self._head) for other in others]

    def play(self, pressure_pa: FloatArray, rate_hz: float, point_m: FloatArray, body: int, time_s: float) -> None:
        """Let a recorded sound begin at a time, at a point in the frame of a body."""
        if rate_hz != self._head.sample_rate_hz:
            pressure_pa = resampled(pressure_pa, rate_hz, self._head.sample_rate_hz)
        self._mixer.add([Source(pressure_pa, 1.0, time_s * self._head.sample_rate_hz, body, point_m)])

    def reset(self, data: mujoco.MjData) -> None:
        """Begin an episode in silence."""
        self._forget()
        self._contacts.forget(data)

    def after_step(self, data: mujoco.MjData) -> None:
        """Notice what hits what, and how the infant's voice sounds."""
        for track in self._tracks:
            track.after_step(round(data.time * self._head.sample_rate_hz))
        if impacts := self._contacts.impacts(data):
            start = (data.time - self._timestep_s) * self._head.sample_rate_hz
            head_m = data.xpos[self._body]
            sources = [self._source(impact, start, head_m) for impact in impacts]
            self._mixer.add([source for source in sources if source.lasts])

    def heard(self, data: mujoco.MjData) -> FloatArray:
        """Return the sound pressure at the left and the right ear until now, shape (2, samples), in [Pa]."""
        sounds = [sound for sources in self._sources for sound in sources.sounds(data)]
        if sounds or self._begun:
            keys = [[sound.source, sound.kind, sound.start_step, sound.fundamental_hz] for sound in sounds]
            new = [sound for sound, key in zip(sounds, keys, strict=True) if key not in self._begun]
            self._mixer.add([self._of_sound(sound) for sound in new])
            self._begun = keys
        count = round(data.time * self._head.sample_rate_hz) - self.index
        if count > 0:
            count = min(count, 4 * self._samples)
            mixed = self._mixer.mix(data, self.index, count)
            if self._voice:
                mixed += self._voice.heard(count)
            for other in self._others:
                mixed += other.heard(self._mixer.way(data, other.body, other.point_m), count)
            self.pressure_pa = np.concatenate([self.pressure_pa, mixed], axis=1)[:, -self._samples :]
            self.index += count
        return self.pressure_pa

    @property
    def _tracks(self) -> list[VoiceTrack]:
        voices = [*([self._voice] if self._voice else []), *self._others]
        return [voice.track for voice in voices]

    def _forget(self) -> None:
        self._mixer.forget()
        if self._voice:
            self._voice.track.forget()
        for other in self._others:
            other.forget()
        self._begun: list[list[Any]] = []
        self.pressure_pa = np.zeros((2, self._samples))
        """The sound pressure at both ears, up to the sample before `index`."""
        self.index = 0
        """Samples since the start of the episode."""

    def _source(self, impact: Impact, start: float, head_m: FloatArray) -> Source:
        """Return the source of an impact, which ends when all its partials are well below their thresholds."""
        frequencies_hz, shares = partials_of(impact.timbre, self._head)
        distance_m = max(math.dist(impact.place_m, head_m), self._head.radius_m)
        levels_db = impact.level_db + CLOSE_DB + 20 * np.log10(shares / distance_m)
        margins_db = levels_db - np.interp(np.log(frequencies_hz), *self._thresholds)
        heard_ms = float((margins_db / frequencies_hz).max()) * frequencies_hz[0] * impact.timbre.duration_ms / 60
        lasts = max(heard_ms, 0.0) / 1000 * self._head.sample_rate_hz
        return Source(impact.timbre, 10 ** (impact.level_db / 20), start, 0, impact.place_m, lasts)

    def _of_sound(self, sound: Sound) -> Source:
        timbre = Timbre(sound.kind, float(sound.fundamental_hz), float(sound.duration_ms))
        start = sound.start_step * self._timestep_s * self._head.sample_rate_hz
        return Source(timbre, 10 ** (sound.level_db / 20), start, sound.body, np.array(sound.point_m, np.float64))

    @property
    def state(self) -> dict[str, Any]:
        """What was heard last, and all that is on its way."""
        return {
            "index": self.index,
            "pressure": self.pressure_pa,
            "touched": [list(self._contacts.last_s), list(self._contacts.last_s.values())],
            "ringing": sorted(self._contacts.ringing),
            "begun": self._begun,
            "sources": [_listed(source) for source in self._mixer.sources],
            "delays": self._mixer.delays,
            "gains": self._mixer.gains,
            "voice": self._voice and self._voice.track.state,
            "others": [other.state for other in self._others],
        }

    @state.setter
    def state(self, state: dict[str, Any]) -> None:
        check_form(state, {"index": 0, "pressure": self.pressure_pa}, "companions.hearing")
        sources = [
            Source(what if isinstance(what, np.ndarray) else Timbre(*what), *others)
            for what, *others in state["sources"]
        ]
        for name in ("delays", "gains"):
            require(np.shape(state[name]) == (len(sources), 2), f"companions.hearing.{name}", state[name])
        self.index, self.pressure_pa = state["index"], state["pressure"]
        self._contacts.last_s = dict(zip(*state["touched"], strict=True))
        self._contacts.ringing = set(state["ringing"])
        self._begun = [list(key) for key in state["begun"]]
        if self._voice:
            self._voice.track.state = state["voice"]
        for other, kept in zip(self._others, state["others"], strict=True):
            other.state = kept
        self._mixer.restore(sources, state["delays"], state["gains"])


def _listed(source: Source) -> list[Any]:
    what = list(source.what) if isinstance(source.what, Timbre) else source.what
    return [what, source.gain, source.start, source.body, source.point_m, source.lasts]
