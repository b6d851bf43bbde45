"""What sounds are like: the sound pressure of an impact, a voice or a tone by time.

They are made at `FINER` times the sample rate, so that they can be heard with any delay, by linear interpolation. Each
is a complex array: its real part is the sound as it is, its imaginary part what all heads let pass alike
(`mimoc.base.geometry.spherical_head.low_part`).

Two bodies that come into contact with a closing speed v sound with a share η of the kinetic energy E = m v² / 2 that is
at stake, with the reduced mass m of both. At 1 m the mean square of the pressure over T = 125 ms is

    p² = η E Z / (4 π T)

with the impedance Z of air. Each of the two rings at frequencies f that are inversely proportional to its size, and
loses a share of its amplitude per period that is its material's: exp(-t π f φ) (Wildes & Richards 1988). What is soft
touches for longer, and so excites no high frequencies. All figures of materials are assumed: they put impacts of toys
on floors at the 60 to 80 dB of everyday, but no sound of an object is that of a real one. Nothing sounds that rolls or
slides.

An infant hears its own voice and those of others in its world. Its own comes through the air, from the mouth around
half of a quarter of the head, and through the bones as loud as that (Békésy 1949, from memory), at once and alike at
both ears. Those of others come through the air only, later and weaker by their way to each ear. Pitch and loudness
change evenly within each physics step.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.geometry.spherical_head import low_part
from mimoc.base.state_form import check_form
from mimoc.bundle.io import Bundle
from mimoc.bundle.model import in_subtrees
from mimoc.runtime.model_fields import WORLD
from mimoc.runtime.sense import FloatArray, IntArray
from mimoc.runtime.sound import Voice

Wave = npt.NDArray[np.complex64]

REFERENCE_PA = 20e-6  # Reference pressure of sound pressure levels, p₀.
FINER = 4  # A frequency of a third of the sample rate loses .3 dB at most.
PARTIALS = np.array([1.0, 2.757, 5.404, 8.933])
"""Frequencies of a free beam, relative to the lowest (Fletcher & Rossing 1998), for want of an object's own."""
LONGEST_S, SHORTEST_S = 10.0, 2e-3  # Durations of sounds.
GLIDE_S = 0.02  # Duration of the onset and the end of voices and tones, and of the end of what rings on.
HARMONICS, SLOPE_DB = 30, 12.0
"""Number of a voice's harmonics, and by how much they fall per octave, as the glottal source's do (Fant 1960, from
memory); there are no formants."""
PERIOD = 2048  # Samples of a period of a voice.
IMPACT_S = 0.125
"""Time over which the level of an impact is the mean, as that of `fast` sound level meters (IEC 61672)."""


class Timbre(NamedTuple):
    """What a sound is like; equal ones are made once."""

    kind: str  # `impact`, `voice`, or a pure tone for all else.
    fundamental_hz: float  # Frequency of the lowest partial.
    duration_ms: float  # Duration of a voice or a tone; time after which an impact's lowest partial is down by 60 dB.
    contact_ms: float = 0.0  # How long the objects touch that hit each other: partials of shorter periods are weak.


@dataclass(frozen=True)
class Head:
    """The head that sounds are made for, and how many samples per second they have."""

    radius_m: float
    sample_rate_hz: float

    @property
    def finer_hz(self) -> float:
        """Sample rate of waves."""
        return FINER * self.sample_rate_hz


@lru_cache(maxsize=64)
def wave_of(timbre: Timbre, head: Head) -> Wave:
    """Return the wave of a timbre, in [Pa] at 1 m; its level is 0 dB re 20 µPa, of hard contacts."""
    duration_s = min(max(timbre.duration_ms / 1000, SHORTEST_S), LONGEST_S)
    times_s = np.arange(math.ceil(duration_s * head.finer_hz)) / head.finer_hz
    wave = (_impact if timbre.kind == "impact" else _harmonic)(timbre, times_s, head)
    wave = (REFERENCE_PA * wave).astype(np.complex64)
    wave.flags.writeable = False
    return wave


def wave_of_pressure(pressure_pa: FloatArray, rate_hz: float, head: Head) -> Wave:
    """Return the wave of a recorded pressure at 1 m, shape (n,)."""
    size = max(2, round(len(pressure_pa) * head.finer_hz / rate_hz))
    spectrum = np.fft.rfft(pressure_pa)[: size // 2 + 1]
    low = low_part(np.arange(len(spectrum)) * rate_hz / len(pressure_pa), head.radius_m)
    sounds = np.fft.irfft(np.stack([spectrum, spectrum * low]), size) * (size / len(pressure_pa))
    return (sounds[0] + 1j * sounds[1]).astype(np.complex64)


def resampled(pressure_pa: FloatArray, rate_hz: float, wanted_hz: float) -> FloatArray:
    """Return a recorded pressure, shape (n,), at another sample rate."""
    size = max(2, round(len(pressure_pa) * wanted_hz / rate_hz))
    spectrum = np.fft.rfft(pressure_pa)[: size // 2 + 1]
    return np.fft.irfft(spectrum, size) * (size / len(pressure_pa))


def _impact(timbre: Timbre, times_s: FloatArray, head: Head) -> Any:
    """Return partials that decay together with their periods: each by 60 dB within the same number of them."""
    frequencies_hz, sizes = partials_of(timbre, head)
    decays_s = timbre.duration_ms / 1000 / math.log(1000) * frequencies_hz[0] / frequencies_hz
    hard = 1 / (np.arange(len(frequencies_hz)) + 1)
    energy = float(np.sum(hard**2 * decays_s)) / 4  # A decaying sine has size² decay / 4.
    ends = np.minimum(1.0, (times_s[-1] - times_s) / min(GLIDE_S, times_s[-1] / 2))
    wave = np.zeros(len(times_s), complex)
    for frequency_hz, decay_s, size in zip(frequencies_hz, decays_s, sizes, strict=True):
        partial = np.exp(-times_s / decay_s) * np.sin(2 * np.pi * frequency_hz * times_s)
        wave += size * (1 + 1j * low_part(frequency_hz, head.radius_m)) * partial
    return ends * wave / math.sqrt(energy / IMPACT_S)


@lru_cache(maxsize=256)
def partials_of(timbre: Timbre, head: Head) -> tuple[FloatArray, FloatArray]:
    """Return the frequencies of an impact's partials, and their amplitudes relative to the first of a hard contact."""
    frequencies_hz = _below(timbre.fundamental_hz * PARTIALS, head)
    softness = 2e-3 * frequencies_hz * timbre.contact_ms
    return frequencies_hz, 1 / (np.arange(len(frequencies_hz)) + 1) / (1 + softness**2)


def _harmonic(timbre: Timbre, times_s: FloatArray, head: Head) -> Any:
    period = harmonic_period(timbre.fundamental_hz, HARMONICS if timbre.kind == "voice" else 1, head)
    places = (times_s * min(timbre.fundamental_hz, 0.45 * head.sample_rate_hz) * PERIOD).astype(np.int64) % PERIOD
    ends = np.minimum(times_s, times_s[-1] - times_s) / min(GLIDE_S, times_s[-1] / 4)
    return period[places] * np.sin(np.pi / 2 * np.minimum(1.0, ends)) ** 2


def harmonic_period(fundamental_hz: float, harmonics: int, head: Head) -> npt.NDArray[np.complex128]:
    """Return a period of a sound with some harmonics, shape (`PERIOD`,), with a root mean square of 1."""
    frequencies_hz = _below(fundamental_hz * np.arange(1, harmonics + 1), head)
    numbers = np.arange(1, len(frequencies_hz) + 1)
    sizes = numbers ** -(SLOPE_DB / (20 * math.log10(2)))
    weights = sizes * (1 + 1j * low_part(frequencies_hz, head.radius_m))
    return weights @ _SINES[: len(numbers)] / math.sqrt(float(np.sum(sizes**2)) / 2)


_SINES = np.sin(2 * np.pi / PERIOD * np.outer(np.arange(1, HARMONICS + 1), np.arange(PERIOD)))


def _below(frequencies_hz: Any, head: Head) -> FloatArray:
    """Return those frequencies that the sample rate can hold, or the highest that it can."""
    highest_hz = 0.45 * head.sample_rate_hz
    kept = frequencies_hz[frequencies_hz < highest_hz]
    return kept if len(kept) else np.array([highest_hz])


BONES = math.sqrt(2.0)  # By how much bones make the voice louder: both ways add their power.
FARTHEST_S = 0.06  # How long a voice is on its way at most: from 20 m away, nobody is heard.


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
        self._phase = 0.0
        self._gain = 0.0
        self._rate_hz = self._voice.first_hz
        self._end = 0
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
        self._phases = phases[-self._kept :]
        self._gains = gains[-self._kept :]
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


AIR_KG_M2S = 413.0  # Impedance of air, Z, at 20 °C: density x speed of sound.
MIN_M_S = 0.01  # Closing speed below which nothing sounds.
APART_S = 0.05  # How long two bodies must have been apart to hit each other again.
DROWNED_DB = 15.0  # If one of two bodies that hit each other is so much quieter, it is left out.
RINGS_FROM_M_S, RESTS_BELOW_M_S, CLAPPER_KG = 0.1, 0.05, 0.002
"""A bell rings whenever its speed exceeds the first, after it was below the second; by its clapper's mass. Assumed."""


@dataclass(frozen=True, slots=True)
class Substance:
    """How something of a material sounds; all figures are assumed."""

    speed_m_s: float  # Lowest frequency x size.
    loss: float  # Share φ of the amplitude that is lost per period, over π.
    efficiency: float  # Share of the energy that is radiated, η.
    contact_ms: float  # Half the time that a knock with its like takes.


SUBSTANCES = {
    "plastic": Substance(70.0, 0.06, 1e-5, 0.15),
    "wood": Substance(110.0, 0.025, 3e-5, 0.15),
    "metal": Substance(250.0, 0.002, 1e-4, 0.02),
    "rubber": Substance(20.0, 0.3, 1e-6, 3.0),
    "cloth": Substance(15.0, 0.5, 1e-7, 5.0),
    "body": Substance(30.0, 0.5, 3e-7, 3.0),
    "floor": Substance(100.0, 0.2, 3e-6, 0.05),
}
TOYS, BELL_SIZE_M = "plastic", 0.04  # What toys are made of whose material nobody says; and the size of a bell.


@dataclass(frozen=True, slots=True)
class Impact:
    """The sound of one of two bodies that hit each other."""

    timbre: Timbre
    level_db: float  # At 1 m.
    place_m: FloatArray  # In the world, shape (3,).


class Resonators:
    """The bodies of a model, and how each sounds."""

    def __init__(self, model: mujoco.MjModel, bundle: Bundle):
        manifest = bundle.manifest
        self.count = model.nbody
        self.solid = model.body_weldid.astype(np.intp)
        self._second: IntArray = self.solid[model.geom_bodyid]
        self._first: IntArray = self._second * model.nbody
        materials = [TOYS] * model.nbody
        for body in np.flatnonzero(in_subtrees(model, [model.body(manifest.root_body).id])).tolist():
            materials[body] = "body"
        materials[WORLD] = "floor"
        for thing in (item for item in manifest.objects if item.geoms):
            for body in np.flatnonzero(in_subtrees(model, [model.body(thing.body).id])).tolist():
                materials[body] = thing.material
        self.substances = [SUBSTANCES[material] for material in materials]
        self.sizes_m = np.ones(model.nbody)
        for geom, body in enumerate(model.geom_bodyid.tolist()):
            if body != WORLD:
                self.sizes_m[body] = 2 * max(model.geom_rbound[geom], 0.005)
        masses_kg = np.where(model.body_weldid == WORLD, np.inf, model.body_mass)
        self.per_kg = 1 / np.maximum(masses_kg, 1e-6)
        self.bells = [(bell, model.geom(bell).bodyid[0]) for thing in manifest.objects for bell in thing.bells]
        self._root: IntArray = model.body_rootid.astype(np.intp)

    def codes(self, data: mujoco.MjData) -> list[int]:
        """Return the two bodies of each contact as one number: that of bodies x the first + the second."""
        first, second = data.contact.geom.T
        return (self._first.take(first) + self._second.take(second)).tolist()

    def impact(self, data: mujoco.MjData, contact: int, first: int, second: int) -> Iterator[Impact]:
        """Yield what is heard of a contact that two bodies have just made."""
        place_m = np.array(data.contact.pos[contact])
        normal = data.contact.frame[contact, :3]
        closing_m_s = float(normal @ (self._velocity(data, first, place_m) - self._velocity(data, second, place_m)))
        if closing_m_s < MIN_M_S:
            return
        energy_j = closing_m_s**2 / 2 / float(self.per_kg[first] + self.per_kg[second])
        contact_ms = self.substances[first].contact_ms + self.substances[second].contact_ms
        sounds = [
            self._sound(body, energy_j, contact_ms, place_m, float(self.sizes_m[body])) for body in (first, second)
        ]
        loudest_db = max(sound.level_db for sound in sounds)
        yield from (sound for sound in sounds if sound.level_db > loudest_db - DROWNED_DB)

    def chime(self, speed_m_s: float, body: int, place_m: FloatArray) -> Impact:
        """Return the sound of a bell on a body that swings with a speed."""
        return self._sound(body, CLAPPER_KG * speed_m_s**2 / 2, 0.1, place_m, BELL_SIZE_M, SUBSTANCES["metal"])

    def speed(self, data: mujoco.MjData, body: int, place_m: FloatArray) -> float:
        """Return the speed of a place on a body, [m/s]."""
        return float(np.linalg.norm(self._velocity(data, body, place_m)))

    def _sound(
        self,
        body: int,
        energy_j: float,
        contact_ms: float,
        place_m: FloatArray,
        size_m: float,
        made_of: Substance | None = None,
    ) -> Impact:
        substance = made_of or self.substances[body]
        frequency_hz = float(f"{substance.speed_m_s / size_m:.3g}")  # Alike ones share their waves.
        duration_ms = 1000 * math.log(1000) / (math.pi * frequency_hz * substance.loss)
        mean_square = substance.efficiency * energy_j * AIR_KG_M2S / (4 * math.pi * IMPACT_S)
        level_db = 10 * math.log10(mean_square / REFERENCE_PA**2 + 1e-30)
        return Impact(Timbre("impact", frequency_hz, duration_ms, contact_ms), level_db, place_m)

    def _velocity(self, data: mujoco.MjData, body: int, place_m: FloatArray) -> Any:
        """Return the velocity of a place on a body, shape (3,), [m/s], in the world."""
        rx, ry, rz, *velocity = data.cvel[body].tolist()
        x, y, z = (place_m - data.subtree_com[self._root[body]]).tolist()
        return np.array([ry * z - rz * y, rz * x - rx * z, rx * y - ry * x]) + velocity


class Contacts:
    """Which bodies have touched lately."""

    def __init__(self, resonators: Resonators):
        self._resonators = resonators
        self.last_s: dict[int, float] = {}
        """When two bodies touched last, by number of bodies x the first + the second."""
        self.ringing: set[str] = set()
        """Bells whose speed has not fallen since they rang."""

    def impacts(self, data: mujoco.MjData) -> list[Impact]:
        """Return what is heard of contacts that were made since the last physics step, and of bells that swing."""
        known, time_s, impacts = self.last_s, data.time, list[Impact]()
        for contact, code in enumerate(self._resonators.codes(data)):
            if time_s - known.get(code, -1.0) < APART_S:
                known[code] = time_s
            elif data.contact.efc_address[contact] >= 0:
                known[code] = time_s
                impacts += self._resonators.impact(data, contact, *divmod(code, self._resonators.count))
        impacts += self._chimes(data)
        return impacts

    def _chimes(self, data: mujoco.MjData) -> Iterator[Impact]:
        for bell, body in self._resonators.bells:
            place_m = np.array(data.geom(bell).xpos)
            speed_m_s = self._resonators.speed(data, body, place_m)
            if bell not in self.ringing and speed_m_s > RINGS_FROM_M_S:
                self.ringing.add(bell)
                yield self._resonators.chime(speed_m_s, body, place_m)
            elif speed_m_s < RESTS_BELOW_M_S:
                self.ringing.discard(bell)

    def forget(self, data: mujoco.MjData) -> None:
        """Begin an episode, in which what touches now has always touched."""
        self.ringing.clear()
        self.last_s = dict.fromkeys(self._resonators.codes(data), float(data.time))
