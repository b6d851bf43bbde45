"""What is to be heard of a world: it sees each physics step for impacts, and mixes sounds for the ears when asked.

physics steps  |  1  |  2  |  3  |  4  |  impacts are found after each of them
samples        |.....|.....|.....|.....|  mixed when the sense is sampled, of all time since it last was,
the sense            ^           ^        so that they follow each other without a gap
"""

from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np

from mimoc.actuation.voice import Voice
from mimoc.base.sound import Sound, SoundSources
from mimoc.base.state_form import check_form, demand
from mimoc.bundle.io import Bundle
from mimoc.companions.companion import Companion
from mimoc.senses.hearing import HearingEntry
from mimoc.senses.hearing.impacts import Contacts, Impact, Resonators
from mimoc.senses.hearing.mixing import Mixer, Source
from mimoc.senses.hearing.own_voice import OwnVoice
from mimoc.senses.hearing.playback import Playback
from mimoc.senses.hearing.timbres import Head, Timbre, resampled
from mimoc.senses.sense import FloatArray


class Listener(Companion):
    """The ears of one infant: the sound pressure at each, of all sounds in its world."""

    def __init__(self, entry: HearingEntry, model: mujoco.MjModel, bundle: Bundle, samples: int, least_db: float):
        """Listen in a model.

        Args:
            entry: The sense.
            model: The model.
            bundle: The infant.
            samples: How many samples are kept.
            least_db: Level of impacts at the head below which they are left out.
        """
        self._head = Head(entry.radius_m, float(entry.sample_rate_hz))
        self._body, self._least_db = model.body(entry.head).id, least_db
        self._timestep_s, self._samples = model.opt.timestep, samples
        self._contacts = Contacts(Resonators(model, bundle))
        self._mixer = Mixer(self._head, self._body, entry.centre_m)
        self._sources: Sequence[SoundSources] = ()
        self._voice: OwnVoice | None = None
        self._forget()

    @property
    def rate_hz(self) -> float:
        """Samples per second."""
        return self._head.sample_rate_hz

    def listen_to(self, sources: SoundSources, voice: Voice | None = None) -> None:
        """Hear what these let sound, and the infant's own voice."""
        self._sources = (sources,)
        self._voice = OwnVoice(voice, self._head) if voice else None

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
        if self._voice:
            self._voice.after_step(round(data.time * self._head.sample_rate_hz))
        if impacts := self._contacts.impacts(data):
            start = (data.time - self._timestep_s) * self._head.sample_rate_hz
            head_m = data.xpos[self._body]
            self._mixer.add([_of_impact(one, start) for one in impacts if self._is_heard(one, head_m)])

    def heard(self, data: mujoco.MjData) -> FloatArray:
        """Return the sound pressure at the left and the right ear until now, shape (2, samples), in [Pa]."""
        self._begin_sounds(data)
        count = round(data.time * self._head.sample_rate_hz) - self.index
        if count > 0:
            count = min(count, 4 * self._samples)
            mixed = self._mixer.mix(data, self.index, count)
            if self._voice:
                mixed += self._voice.heard(self.index, count)
            self.pressure_pa = np.concatenate([self.pressure_pa, mixed], axis=1)[:, -self._samples :]
            self.index += count
        return self.pressure_pa

    def _forget(self) -> None:
        self._mixer.forget()
        if self._voice:
            self._voice.forget()
        self._begun: list[list[Any]] = []
        self.pressure_pa = np.zeros((2, self._samples))
        """The sound pressure at both ears, up to the sample before `index`."""
        self.index = 0
        """Samples since the start of the episode."""

    def _is_heard(self, impact: Impact, head_m: FloatArray) -> bool:
        distance_m = max(float(np.linalg.norm(impact.place_m - head_m)), self._head.radius_m)
        return impact.level_db - 20 * np.log10(distance_m) > self._least_db

    def _begin_sounds(self, data: mujoco.MjData) -> None:
        """Let sounds of others begin that have not yet."""
        sounds = [sound for sources in self._sources for sound in sources.sounds(data)]
        if sounds or self._begun:
            keys = [[sound.source, sound.kind, sound.start_step, sound.fundamental_hz] for sound in sounds]
            new = [sound for sound, key in zip(sounds, keys, strict=True) if key not in self._begun]
            self._mixer.add([self._of_sound(sound) for sound in new])
            self._begun = keys

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
            "voice": self._voice and self._voice.state,
        }

    @state.setter
    def state(self, state: dict[str, Any]) -> None:
        check_form(state, {"index": 0, "pressure": self.pressure_pa}, "companions.hearing")
        sources = [
            Source(what if isinstance(what, np.ndarray) else Timbre(*what), gain, start, body, point_m)
            for what, gain, start, body, point_m in state["sources"]
        ]
        for name in ("delays", "gains"):
            demand(np.shape(state[name]) == (len(sources), 2), f"companions.hearing.{name}", state[name])
        self.index, self.pressure_pa = state["index"], state["pressure"]
        self._contacts.last_s = dict(zip(*state["touched"], strict=True))
        self._contacts.ringing = set(state["ringing"])
        self._begun = [list(key) for key in state["begun"]]
        if self._voice:
            self._voice.state = state["voice"]
        self._mixer.restore(sources, state["delays"], state["gains"])


def _of_impact(impact: Impact, start: float) -> Source:
    return Source(impact.timbre, 10 ** (impact.level_db / 20), start, 0, impact.place_m)


def _listed(source: Source) -> list[Any]:
    what = list(source.what) if isinstance(source.what, Timbre) else source.what
    return [what, source.gain, source.start, source.body, source.point_m]
