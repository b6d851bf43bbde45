"""What hits what in a physics step, and how it sounds.

Two bodies that come into contact with a closing speed v sound with a share η of the kinetic energy E = m v² / 2 that is
at stake, with the reduced mass m of both. At 1 m the mean square of the pressure over T = 125 ms is

    p² = η E Z / (4 π T)

with the impedance Z of air. Each of the two rings at frequencies f that are inversely proportional to its size, and
loses a share of its amplitude per period that is its material's: exp(-t π f φ) (Wildes & Richards 1988). What is soft
touches for longer, and so excites no high frequencies. All figures of materials are assumed: they put impacts of toys
on floors at the 60 to 80 dB of everyday, but no sound of an object is that of a real one. Nothing sounds that rolls or
slides.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from mimoc.bundle.io import Bundle
from mimoc.bundle.model import in_subtrees
from mimoc.components.senses.hearing.cochlea import REFERENCE_PA
from mimoc.components.senses.hearing.timbres import IMPACT_S, Timbre
from mimoc.runtime.model_fields import WORLD
from mimoc.runtime.sense import FloatArray, IntArray

AIR_KG_M2S = 413.0
"""Impedance of air, Z, at 20 °C: density x speed of sound."""
LEAST_M_S = 0.01
"""Closing speed below which nothing sounds."""
APART_S = 0.05
"""How long two bodies must have been apart to hit each other again."""
DROWNED_DB = 15.0
"""Of two bodies that hit each other, one that is so much quieter is left out."""
RINGS_FROM_M_S, RESTS_BELOW_M_S, CLAPPER_KG = 0.1, 0.05, 0.002
"""A bell rings whenever its speed exceeds the first, after it was below the second; by its clapper's mass. Assumed."""


@dataclass(frozen=True, slots=True)
class Substance:
    """How something of a material sounds; all figures are assumed."""

    speed_m_s: float
    """Lowest frequency x size."""
    loss: float
    """Share φ of the amplitude that is lost per period, over π."""
    efficiency: float
    """Share of the energy that is radiated, η."""
    contact_ms: float
    """Half the time that a knock with its like takes."""


SUBSTANCES = {
    "plastic": Substance(70.0, 0.06, 1e-5, 0.15),
    "wood": Substance(110.0, 0.025, 3e-5, 0.15),
    "metal": Substance(250.0, 0.002, 1e-4, 0.02),
    "rubber": Substance(20.0, 0.3, 1e-6, 3.0),
    "cloth": Substance(15.0, 0.5, 1e-7, 5.0),
    "body": Substance(30.0, 0.5, 3e-7, 3.0),
    "floor": Substance(100.0, 0.2, 3e-6, 0.05),
}
TOYS, BELL_SIZE_M = "plastic", 0.04
"""What toys are made of whose material nobody says; and the size of a bell."""


@dataclass(frozen=True, slots=True)
class Impact:
    """The sound of one of two bodies that hit each other."""

    timbre: Timbre
    level_db: float
    """At 1 m."""
    place_m: FloatArray
    """In the world, shape (3,)."""


class Resonators:
    """The bodies of a model, and how each sounds."""

    def __init__(self, model: mujoco.MjModel, bundle: Bundle):
        manifest = bundle.manifest
        self.count, self.solid = model.nbody, model.body_weldid.astype(np.intp)
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
        if closing_m_s < LEAST_M_S:
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
