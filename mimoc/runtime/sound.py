"""A sound in an infant's world, for senses to hear and for the tracks of videos."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import mujoco

SILENT_AFTER_MS = 2000.0
"""How long after its end a sound need not be known any more: until then, delays and echoes can bring it to an ear."""


@dataclass(frozen=True, slots=True)
class Sound:
    """A sound that has begun at a physics step, at a point of a body."""

    start_step: int
    """Physics steps from the start of the episode to its beginning, of `step_of`."""
    duration_ms: float
    """How long its source sounds, onset and decay included."""
    fundamental_hz: float
    """Fundamental frequency; of an impact, that of the lowest mode."""
    level_db: float
    """Sound pressure level at 1 m from the source, in free field, re 20 µPa."""
    kind: str
    """What it is like: `voice`, `impact` ..."""
    source: str
    """What sounds, such as `caregiver`."""
    body: int
    """The body of the model that it is on; 0 is the world."""
    point_m: tuple[float, float, float]
    """Its place in the frame of that body."""


class SoundSources(Protocol):
    """What lets sound in a world."""

    def sounds(self, data: mujoco.MjData) -> Sequence[Sound]:
        """Return what has begun by now and can still be heard: what sounds, or ended within `SILENT_AFTER_MS`."""
        ...


def step_of(time_s: float, timestep_s: float) -> int:
    """Return how many physics steps an episode has made at a time of its simulation (`data.time`)."""
    return round(time_s / timestep_s)
