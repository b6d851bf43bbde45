"""The delays of an infant: those that its spec gives, else those of a preset for its age.

Measured conduction times, at birth and later, are the visual P1 (Lee et al. 2012; McCulloch et al. 1999), the
somatosensory N20 (Thieme et al. 2005) and P37, F waves of 229 infants (Clinical Neurophysiology 2020) and vestibular
evoked myogenic potentials. Values between them are interpolated, or estimated from conduction velocity, which is
half of an adult's at birth and an adult's by 3 to 5 years (Garcia-Garcia and Calleja-Fernandez 2004). The table of
each sense is in its record.
"""

from collections.abc import Callable, Collection, Iterator, Mapping
from itertools import product
from typing import Any

import numpy as np

from mimoc.body.origins import Entry, Origin
from mimoc.body.tree import BodyTree
from mimoc.compiler.delays.processing import processing, trace_processing
from mimoc.schema.components.senses import SENSES
from mimoc.schema.delay_ages import AGES_MONTHS
from mimoc.schema.delays import MOTOR, DelayEntry, DelaysEntry, PartDelay, given_keys, signals
from mimoc.schema.infant import InfantSpec
from mimoc.schema.kinds import AgeTable
from mimoc.schema.names import SIDES
from mimoc.schema.regions import of_place

LEGS = ("right_upper_leg", "left_upper_leg")
"""The first body of each leg."""

MOTOR_DELAY = AgeTable(AGES_MONTHS, ms=(30, 30, 25, 25, 20, 20), legs_ms=(40, 40, 35, 35, 30, 30))
"""From command to actuator, by age."""


def delays(spec: InfantSpec, tree: BodyTree) -> DelaysEntry:
    """Return the delay of each sense and of the commands.

    Delays of a preset are rounded to whole physics steps; those that a spec gives are whole already.
    """
    bodies = {body.name for body in tree.bodies}
    delays: dict[str, Any] = {signal: _longer(_delay(spec, signal), spec, bodies) for signal in signals()}
    entry = DelaysEntry(**delays, legs=tuple(leg for leg in LEGS if leg in bodies))
    return entry.model_copy(update={"processing": processing(spec, entry)})


def _delay(spec: InfantSpec, signal: str) -> DelayEntry:
    keys = given_keys(spec.delays, signal)
    if keys:
        return DelayEntry(ms=getattr(spec.delays, keys[0]))
    return PRESETS[spec.delays.preset](signal, spec.corrected_age_months, spec.control.timestep_ms)


LIMBS = ((("shoulder", "upper_arm"), ("wrist", "hand")), (("hip", "upper_leg"), ("ankle", "foot")))
"""Where the parts of each limb begin to and from which delays can be longer, and their first bodies, outwards."""


def _longer(delay: DelayEntry, spec: InfantSpec, bodies: Collection[str]) -> DelayEntry:
    """Return a delay with the factors of the impairments, by first body of the parts that have one of their own."""
    if spec.impairments is None or not spec.impairments.delay:
        return delay
    factors, timestep_ms = spec.impairments.delay, spec.control.timestep_ms
    everywhere, parts = factors.get("body", 1.0), list[PartDelay]()
    for side, limb in product(SIDES, LIMBS):
        usual_ms = delay.legs_ms if limb is LIMBS[1] and delay.legs_ms is not None else delay.ms
        factor = everywhere
        for place, body in limb:
            _, wanted = of_place(f"{side}_{place}", factors) or ("", everywhere)
            if wanted != factor and f"{side}_{body}" in bodies:
                parts.append(PartDelay(body=f"{side}_{body}", ms=_whole(usual_ms * wanted, timestep_ms)))
                factor = wanted
    legs_ms = None if delay.legs_ms is None else _whole(delay.legs_ms * everywhere, timestep_ms)
    return DelayEntry(ms=_whole(delay.ms * everywhere, timestep_ms), legs_ms=legs_ms, parts=tuple(parts))


def _none(signal: str, age_months: float, timestep_ms: float) -> DelayEntry:
    return DelayEntry()


def _paper(signal: str, age_months: float, timestep_ms: float) -> DelayEntry:
    return DelayEntry(ms=timestep_ms if signal == MOTOR else _whole(SENSES[signal].paper_delay_ms, timestep_ms))


def _physiological(signal: str, age_months: float, timestep_ms: float) -> DelayEntry:
    table = MOTOR_DELAY if signal == MOTOR else SENSES[signal].physiological_delay
    if table is None:
        return DelayEntry()
    ms, legs_ms = (
        _whole(float(np.interp(age_months, table.ages_months, times)), timestep_ms)
        for times in (table.ms, table.legs_ms or table.ms)
    )
    return DelayEntry(ms=ms, legs_ms=None if legs_ms == ms else legs_ms)


PRESETS: Mapping[str, Callable[[str, float, float], DelayEntry]] = {
    "none": _none,
    "paper": _paper,
    "physiological": _physiological,
}
"""By name: from the signal, the age in months and the physics step in ms to its delay."""


def _whole(time_ms: float, timestep_ms: float) -> float:
    """Return the whole number of physics steps that is nearest to a time."""
    return round(time_ms / timestep_ms) * timestep_ms


RULES = {
    "none": "no preset",
    "paper": "the paper: 50 ms for senses, one physics step for motors",
    "physiological": "conduction times by age, interpolated (see mimoc/compiler/delays/presets.py), "
    "to the nearest physics step",
}
"""The rule of each preset."""


def trace_delays(spec: InfantSpec, delays: DelaysEntry) -> Iterator[tuple[str, Entry]]:
    """Yield an entry for each delay in the manifest."""
    for signal in signals():
        if signal in SENSES and SENSES[signal].is_recent and getattr(spec.senses, signal) is None:
            continue
        keys = given_keys(spec.delays, signal)[:1]
        rule = "given by the spec" if keys else RULES[spec.delays.preset]
        usual = ("spec.delays.preset", "spec.age_months", "spec.control.timestep_ms")
        origin = Origin(rule, tuple(f"spec.delays.{key}" for key in keys) or usual, "ms")
        for region, factor in (spec.impairments.delay if spec.impairments else {}).items():
            key = f"spec.impairments.delay.{region}"
            origin = origin.times(f"; x {factor:g} to and from {region} ({key})", key)
        delay = getattr(delays, signal)
        for name, ms in (("ms", delay.ms), ("legs_ms", delay.legs_ms)):
            if ms is not None:
                yield f"delays.{signal}.{name}", origin.entry(ms)
        for part in delay.parts:
            yield f"delays.{signal}.parts.{part.body}", origin.entry(part.ms)
    yield from trace_processing(spec, delays)
