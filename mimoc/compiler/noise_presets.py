"""The noise of an infant: what its spec gives, and for a word, the amount at its age."""

from collections.abc import Iterator, Sequence

import numpy as np

from mimoc.body.maturation import Decay
from mimoc.body.origins import Entry, Origin
from mimoc.schema.components.senses import SENSES
from mimoc.schema.infant import InfantSpec
from mimoc.schema.kinds import NoiseOption
from mimoc.schema.noise import NoiseEntry, low_pass_key, noise_keys
from mimoc.schema.regions import in_regions

ADULT_SHARE, NEWBORN_SHARE = 0.10, 0.30
"""Motor noise from 18 months on, and at birth, as shares of the command. Derived, as no infant was measured: models of
adults use .1 to .2, and adults' isometric forces vary by .02 to .05 (from memory)."""
MATURING = Decay(tau_months=8.0, power=1.0)
"""How the newborn's part of it is lost; derived."""


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
    units, rules = {"motor": "1", "delay_jitter_ms": "ms"}, {"motor": BY_AGE}
    for name, key in noise_keys().items():
        units[key], rules[key] = _option(name).unit, _option(name).source
        if (low_pass_ms := getattr(noise, low_pass_key(name), None)) is not None:
            yield f"noise.{low_pass_key(name)}", Origin("assumed (D)", (f"spec.noise.{key}",), "ms").entry(low_pass_ms)
    for key, unit in units.items():
        if key not in noise.model_dump():
            continue
        rule, sources, given = "given by the spec", [f"spec.noise.{key}"], getattr(spec.noise, key)
        if isinstance(given, str):
            rule, sources = rules[key], [*sources, *(["spec.age_months"] if given != "adult" else [])]
        yield f"noise.{key}", Origin(rule, tuple(sources), unit).entry(getattr(noise, key))
    if noise.of_commands:
        rule = "given by the spec, by region of the body; elsewhere as noise.motor"
        yield "noise.of_commands", Origin(rule, (*_keys(spec), "noise.motor"), "1").entry(noise.of_commands)
    yield "noise.low_pass_ms", Origin(LOW_PASS, (), "ms").entry(noise.low_pass_ms)


def _keys(spec: InfantSpec) -> Iterator[str]:
    """Yield the keys of the spec that give noise by region."""
    for region in spec.impairments.noise if spec.impairments else ():
        yield f"spec.impairments.noise.{region}"
