"""The delays and the noise of an infant: those that its spec gives, else those of a preset or a word for its age.

Measured conduction times, at birth and later, are the visual P1 (Lee et al. 2012; McCulloch et al. 1999), the
somatosensory N20 (Thieme et al. 2005) and P37, F waves of 229 infants (Clinical Neurophysiology 2020) and vestibular
evoked myogenic potentials. Values between them are interpolated, or estimated from conduction velocity, which is
half of an adult's at birth and an adult's by 3 to 5 years (Garcia-Garcia and Calleja-Fernandez 2004). The table of
each sense is in its record.
"""

import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from itertools import product
from typing import Any

import numpy as np

from mimoc.body.maturation import Decay
from mimoc.body.origins import Entry, Origin
from mimoc.body.tree import BodyTree
from mimoc.schema.infant import InfantSpec
from mimoc.schema.kinds import AGES_MONTHS, SENSES, AgeTable, NoiseOption
from mimoc.schema.names import SIDES, in_regions, of_place
from mimoc.schema.senses import (
    MOTOR,
    DelayEntry,
    DelaysEntry,
    NoiseEntry,
    PartDelay,
    ProcessingEntry,
    given_keys,
    low_pass_key,
    noise_keys,
    signals,
)

LEGS = ("right_upper_leg", "left_upper_leg")  # The first body of each leg.

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
    return round(time_ms / timestep_ms) * timestep_ms


RULES = {
    "none": "no preset",
    "paper": "the paper: 50 ms for senses, one physics step for motors",
    "physiological": "conduction times by age, interpolated (see mimoc/compiler/presets.py), "
    "to the nearest physics step",
}
"""The rule of each preset."""


def trace_delays(spec: InfantSpec, delays: DelaysEntry) -> Iterator[tuple[str, Entry]]:
    """Yield an entry for each delay in the manifest."""
    for signal in signals():
        if signal in SENSES and SENSES[signal].omit_if_absent and getattr(spec.senses, signal) is None:
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


SIGHT = "vision"
SACCADE_MS: Mapping[float, float] = dict(
    zip((0, 1, 2, 3, 4, 6, 8.5, 12, 24), (800, 600, 500, 450, 420, 350, 300, 250, 230), strict=True)
)
"""From a new target to the beginning of a saccade, by months. Derived (D): below 500 ms on many trials at 1 and 2
months (R), 242 to 250 at 9 to 15 (S)."""
REACH_MS: Mapping[float, float] = {4: 1500, 6: 600, 8.5: 500, 12: 450, 24: 400}
"""From a seen object to the first movement of the hand, by months (from memory, M); earlier as at 4."""
ADULT_SACCADE_MS, ADULT_REACH_MS = 180.0, 250.0
VARIATION: Mapping[float, float] = {4: 0.35, 12: 0.2}
"""Standard deviation of the response of one infant, as a share of its mean, by months (from memory, M)."""
MIN_MS = 60.0  # No decision is quicker on average.
RESPONSES = {"look": (SACCADE_MS, ADULT_SACCADE_MS), "reach": (REACH_MS, ADULT_REACH_MS)}
RESPONSE_RULES = {
    "look": "time to a saccade (D: < 500 ms at 1 and 2 months, 242 to 250 at 9 to 15)",
    "reach": "time to the first movement of the hand (from memory, M)",
}
VARIES = "an infant's responses vary by .35 of their mean until 4 months, by .2 from 12 (from memory, M)"


def processing(spec: InfantSpec, delays: DelaysEntry) -> ProcessingEntry | None:
    """Return the decisions of an infant with some delays, or None if it decides at once.

    A response of mean t and variation v, of which conduction takes c, has a decision of mean d = max(t - c, 60 ms) and
    of variation v t / d, so that the whole response varies by v.
    """
    if spec.delays.processing in (None, "off"):
        return None
    is_adult = spec.delays.processing == "adult"
    months = spec.corrected_age_months
    conduction_ms = getattr(delays, SIGHT).ms + delays.motor.ms
    numbers = dict[str, float]()
    for name, (by_age, adult_ms) in RESPONSES.items():
        mean_ms = adult_ms if is_adult else _at(by_age, months)
        decision_ms = max(MIN_MS, mean_ms - conduction_ms)
        variation = _at(VARIATION, math.inf if is_adult else months)
        numbers |= {f"{name}_ms": decision_ms, f"{name}_variation": variation * mean_ms / decision_ms}
    return ProcessingEntry(**numbers)


def _at(by_age: Mapping[float, float], months: float) -> float:
    return float(np.interp(months, list(by_age), list(by_age.values())))


def trace_processing(spec: InfantSpec, delays: DelaysEntry) -> Iterator[tuple[str, Entry]]:
    """Yield an entry for each number of the decisions in the manifest."""
    if delays.processing is None:
        return
    sources = ["spec.delays.processing", f"delays.{SIGHT}.ms", "delays.motor.ms"]
    sources += ["spec.age_months"] if spec.delays.processing == "age" else []
    for name, rule in RESPONSE_RULES.items():
        for key, text, unit in (
            (f"{name}_ms", f"{rule}, less conduction in and out, {MIN_MS:g} ms or more", "ms"),
            (f"{name}_variation", f"{VARIES}; such that all of the response varies so", "1"),
        ):
            yield f"delays.processing.{key}", Origin(text, tuple(sources), unit).entry(getattr(delays.processing, key))


ADULT_SHARE, NEWBORN_SHARE = 0.10, 0.30
"""Motor noise from 18 months on, and at birth, as shares of the command. Derived, as no infant was measured: models of
adults use .1 to .2, and adults' isometric forces vary by .02 to .05 (from memory)."""
MATURING = Decay(tau_months=8.0, power=1.0)  # How the newborn's part of it is lost; derived.


def noise(spec: InfantSpec, joints: Sequence[str]) -> NoiseEntry:
    """Return the noise of commands, senses and delays; *joints* are those that the numbers of an action move."""
    given = {"delay_jitter_ms": spec.noise.delay_jitter_ms}
    for name, key in noise_keys().items():
        option, amount = _option(name), getattr(spec.noise, key)
        given[key] = _by_age(option, amount, spec.corrected_age_months)
        if isinstance(amount, str) and option.low_pass_ms:
            given[low_pass_key(name)] = option.low_pass_ms
    motor = motor_share(spec.corrected_age_months) if spec.noise.motor == "maturing" else spec.noise.motor
    noisy = in_regions(spec.impairments.complete.noise, joints) if spec.impairments else {}
    of_commands = tuple(noisy[joint][1] if joint in noisy else motor for joint in joints) if noisy else ()
    return NoiseEntry(motor=motor, of_commands=of_commands, **given)


def _option(sense: str) -> NoiseOption:
    option = SENSES[sense].noise
    assert option is not None, "senses with a key of noise have noise"
    return option


def _by_age(option: NoiseOption, amount: float | str | None, age_months: float) -> float:
    """Return an amount of noise as it is given, or that of the infant's age or of adults."""
    if amount == "age":
        months, amounts = zip(*option.by_age, strict=True)
        return float(np.interp(age_months, months, amounts))
    return option.adult if isinstance(amount, str) else amount or 0.0


def motor_share(age_months: float) -> float:
    """Return the standard deviation of motor noise at an age, as a share of the command."""
    return ADULT_SHARE + (NEWBORN_SHARE - ADULT_SHARE) * MATURING(age_months)


BY_AGE = (
    f"derived: {ADULT_SHARE} + {NEWBORN_SHARE - ADULT_SHARE:.1f} of the newborn share, "
    f"with tau {MATURING.tau_months:g} months and power {MATURING.power:g}; no infant was measured"
)
LOW_PASS = "assumed time constant of an infant's muscles (half-relaxation is 90 ms at 3 years, Lin et al. 1994; D)"


def trace_noise(spec: InfantSpec, noise: NoiseEntry) -> Iterator[tuple[str, Entry]]:
    """Yield an entry for each noise in the manifest."""
    units = {"motor": "1", "delay_jitter_ms": "ms"}
    rules = {"motor": BY_AGE}
    for name, key in noise_keys().items():
        units[key], rules[key] = _option(name).unit, _option(name).source
        if (low_pass_ms := getattr(noise, low_pass_key(name), None)) is not None:
            yield f"noise.{low_pass_key(name)}", Origin("assumed (D)", (f"spec.noise.{key}",), "ms").entry(low_pass_ms)
    for key, unit in units.items():
        if key not in noise.model_dump():
            continue
        rule = "given by the spec"
        sources = [f"spec.noise.{key}"]
        given = getattr(spec.noise, key)
        if isinstance(given, str):
            rule = rules[key]
            sources = [*sources, *(["spec.age_months"] if given != "adult" else [])]
        yield f"noise.{key}", Origin(rule, tuple(sources), unit).entry(getattr(noise, key))
    if noise.of_commands:
        rule = "given by the spec, by region of the body; elsewhere as noise.motor"
        yield "noise.of_commands", Origin(rule, (*_keys(spec), "noise.motor"), "1").entry(noise.of_commands)
    yield "noise.low_pass_ms", Origin(LOW_PASS, (), "ms").entry(noise.low_pass_ms)


def _keys(spec: InfantSpec) -> Iterator[str]:
    for region in spec.impairments.noise if spec.impairments else ():
        yield f"spec.impairments.noise.{region}"
