"""The noise of an infant: what its spec gives, and for a word, the amount at its age."""

from collections.abc import Iterator

from mimoc.body.maturation import Decay
from mimoc.body.origins import Entry, Origin
from mimoc.noise.spec import NoiseEntry, noise_keys
from mimoc.schema.infant import InfantSpec
from mimoc.senses import SENSES

ADULT_SHARE, NEWBORN_SHARE = 0.10, 0.30
"""Motor noise from 18 months on, and at birth, as shares of the command. Derived, as no infant was measured: models of
adults use .1 to .2, and adults' isometric forces vary by .02 to .05 (from memory)."""
MATURING = Decay(tau_months=8.0, power=1.0)
"""How the newborn's part of it is lost; derived."""


def noise(spec: InfantSpec) -> NoiseEntry:
    """Return the noise of commands, senses and delays."""
    given = {key: getattr(spec.noise, key) for key in ("delay_jitter_ms", *noise_keys().values())}
    motor = motor_share(spec.age_months) if spec.noise.motor == "maturing" else spec.noise.motor
    return NoiseEntry(motor=motor, **given)


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
    for name, key in noise_keys().items():
        option = SENSES[name].noise
        units[key] = option.unit if option else ""
    for key, unit in units.items():
        rule, sources = "given by the spec", [f"spec.noise.{key}"]
        if getattr(spec.noise, key) == "maturing":
            rule, sources = BY_AGE, [*sources, "spec.age_months"]
        yield f"noise.{key}", Origin(rule, tuple(sources), unit).entry(getattr(noise, key))
    yield "noise.low_pass_ms", Origin(LOW_PASS, (), "ms").entry(noise.low_pass_ms)
