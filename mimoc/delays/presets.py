"""How late signals are, by the spec and by age."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mimoc.body import BodyTree
from mimoc.bundle.manifest import DelayEntry, DelaysEntry
from mimoc.schema.infant import InfantSpec

LEGS = ("right_upper_leg", "left_upper_leg")
"""Bodies that the legs begin with."""

AGES_MONTHS = (0.0, 1.0, 3.0, 6.0, 12.0, 24.0)


@dataclass(frozen=True, slots=True)
class Nerve:
    """How long one way takes at `AGES_MONTHS`; conduction only."""

    ms: Sequence[float]
    """To or from all but the legs."""
    legs_ms: Sequence[float] | None = None
    """To or from legs and feet, if that is longer."""


_LIMBS = Nerve(ms=(40, 35, 25, 20, 20, 20), legs_ms=(40, 40, 35, 35, 30, 30))

PHYSIOLOGICAL: Mapping[str, Nerve] = {
    "proprioception": _LIMBS,
    "vestibular": Nerve(ms=(10, 10, 10, 10, 10, 10)),
    "touch": _LIMBS,
    "vision": Nerve(ms=(245, 205, 115, 105, 105, 105)),
    "motor": Nerve(ms=(30, 30, 25, 25, 20, 20), legs_ms=(40, 40, 35, 35, 30, 30)),
}
"""Conduction times by channel.

Measured, at birth and later, are the visual P1 (Lee et al. 2012; McCulloch et al. 1999), the somatosensory N20 (Thieme
et al. 2005) and P37, F waves of 229 infants (Clinical Neurophysiology 2020) and vestibular evoked myogenic potentials.
What lies between them is interpolated, or estimated from the speed of conduction: half of an adult's at birth, an
adult's by 3 to 5 years (Garcia-Garcia and Calleja-Fernandez 2004).
"""

PAPER_SENSORY_MS = 50.0
"""The middle one of the delays 0, 50 and 200 ms of the paper's reaching experiment; its motors are one step late."""


def delays(spec: InfantSpec, tree: BodyTree) -> DelaysEntry:
    """Return how late each sense and the motors are: what the spec gives, else what its preset says.

    Delays of a preset are rounded to whole physics steps; those that a spec gives are whole already.
    """
    here = {body.name for body in tree.bodies}
    channels = {channel: _delay(spec, channel) for channel in PHYSIOLOGICAL}
    return DelaysEntry(**channels, legs=tuple(leg for leg in LEGS if leg in here))


def _delay(spec: InfantSpec, channel: str) -> DelayEntry:
    given = {key: ms for key, ms in spec.delays if ms is not None}
    common_key = "motor_ms" if channel == "motor" else "sensory_ms"
    ms = given.get(f"{channel}_ms", given.get(common_key))
    if ms is not None:
        return DelayEntry(ms=ms)
    return PRESETS[spec.delays.preset](channel, spec.age_months, spec.control.timestep_ms)


def _none(channel: str, age_months: float, timestep_ms: float) -> DelayEntry:
    return DelayEntry()


def _paper(channel: str, age_months: float, timestep_ms: float) -> DelayEntry:
    return DelayEntry(ms=timestep_ms if channel == "motor" else _whole(PAPER_SENSORY_MS, timestep_ms))


def _physiological(channel: str, age_months: float, timestep_ms: float) -> DelayEntry:
    nerve = PHYSIOLOGICAL[channel]
    ms, legs_ms = (
        _whole(float(np.interp(age_months, AGES_MONTHS, times)), timestep_ms)
        for times in (nerve.ms, nerve.legs_ms or nerve.ms)
    )
    return DelayEntry(ms=ms, legs_ms=None if legs_ms == ms else legs_ms)


PRESETS: Mapping[str, Callable[[str, float, float], DelayEntry]] = {
    "none": _none,
    "paper": _paper,
    "physiological": _physiological,
}
"""By name: from the channel, the age in months and the physics step in ms to the delay."""


def _whole(time_ms: float, timestep_ms: float) -> float:
    """Return the whole number of physics steps that is nearest to a time."""
    return round(time_ms / timestep_ms) * timestep_ms
