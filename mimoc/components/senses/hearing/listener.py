"""What is to be heard of a world: it sees each physics step for impacts, and mixes sounds for the ears when asked.

physics steps  |  1  |  2  |  3  |  4  |  impacts are found after each of them
samples        |.....|.....|.....|.....|  mixed when the sense is sampled, of all time since it last was,
the sense            ^           ^        so that they follow each other without a gap
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from mimoc.base.state_form import check_form, demand
from mimoc.bundle.io import Bundle
from mimoc.components.senses.hearing import HearingEntry
from mimoc.components.senses.hearing.impacts import Contacts, Impact, Resonators
from mimoc.components.senses.hearing.mixing import Mixer, Source
from mimoc.components.senses.hearing.timbres import Head, Timbre, partials_of, resampled
from mimoc.components.senses.hearing.voices import OtherVoice, OwnVoice, VoiceTrack
from mimoc.runtime.companion import Companion
from mimoc.runtime.sense import FloatArray
from mimoc.runtime.sound import Sound, SoundSources
from mimoc.runtime.voice import Voice

MAX_SAMPLES = 3_000_000
"""A minute at 48 kHz."""
MAX_S = 60.0
"""Longest sound: whatever its own rate, it is kept at that of the ears."""
MAX_PA = 1e5
"""Largest sound pressure: that of the air, below which no sound in air can fall."""
MAX_M = 1000.0
"""Largest coordinate of a place."""
RATES_HZ = 1000.0, 400_000.0


@dataclass(frozen=True, slots=True)
class Playback:
    """A sound and its place."""

    pressure_pa: FloatArray
    """Sound pressure at 1 m, shape (n,), [Pa]."""
    rate_hz: float
    """Samples per second."""
    point_m: tuple[float, ...]
    """Place in the frame of its body, shape (3,)."""
    body: int
    """The body that it moves with; 0 is the world."""


def checked_playback(pressure_pa: Any, rate_hz: Any, point_m: Any, body: int) -> Playback:
    """Return a sound, or raise a ValueError that says what is wrong with it."""
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
    return Playback(pressure, float(rate), tuple(place.tolist()), body)


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
        """Listen in a model.

        Args:
            entry: The sense.
            model: The model.
            bundle: The infant.
            samples: How many samples are kept.
        """
        self._model, self._head = model, Head(entry.radius_m, float(entry.sample_rate_hz))
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

    def play(self, sound: Playback, data: mujoco.MjData) -> None:
        """Let a sound begin now."""
        start, pressure_pa = data.time * self._head.sample_rate_hz, np.asarray(sound.pressure_pa, np.float64)
        if sound.rate_hz != self._head.sample_rate_hz:
            pressure_pa = resampled(pressure_pa, sound.rate_hz, self._head.sample_rate_hz)
        self._mixer.add([Source(pressure_pa, 1.0, start, sound.body, np.array(sound.point_m, np.float64))])

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
            demand(np.shape(state[name]) == (len(sources), 2), f"companions.hearing.{name}", state[name])
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
