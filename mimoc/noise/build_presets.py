"""The noise of an infant: what its spec gives, and for a word, the amount at its age."""

from collections.abc import Iterator, Sequence

from mimoc.body.maturation import Decay
from mimoc.body.origins import Entry, Origin
from mimoc.noise.spec import NoiseEntry, noise_keys
from mimoc.schema.infant import InfantSpec
from mimoc.schema.regions import in_regions
from mimoc.senses import SENSES

ADULT_SHARE, NEWBORN_SHARE = 0.10, 0.30
"""Motor noise from 18 months on, and at birth, as shares of the command. Derived, as no infant was measured: models of
adults use .1 to .2, and adults' isometric forces vary by .02 to .05 (from memory)."""
MATURING = Decay(tau_months=8.0, power=1.0)
"""How the newborn's part of it is lost; derived."""


def noise(spec: InfantSpec, joints: Sequence[str]) -> NoiseEntry:
    """Return the noise of commands, senses and delays; *joints* are those that the numbers of an action move."""
    given = {key: getattr(spec.noise, key) for key in ("delay_jitter_ms", *noise_keys().values())}
    motor = motor_share(spec.corrected_age_months) if spec.noise.motor == "maturing" else spec.noise.motor
    noisy = in_regions(spec.impairments.complete.noise, joints) if spec.impairments else {}
    of_commands = tuple(noisy[joint][1] if joint in noisy else motor for joint in joints) if noisy else ()
    return NoiseEntry(motor=motor, of_commands=of_commands, **given)


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
        if key not in noise.model_dump():
            continue
        rule, sources = "given by the spec", [f"spec.noise.{key}"]
        if getattr(spec.noise, key) == "maturing":
            rule, sources = BY_AGE, [*sources, "spec.age_months"]
        yield f"noise.{key}", Origin(rule, tuple(sources), unit).entry(getattr(noise, key))
    if noise.of_commands:
        rule = "given by the spec, by region of the body; elsewhere as noise.motor"
        yield "noise.of_commands", Origin(rule, (*_keys(spec), "noise.motor"), "1").entry(noise.of_commands)
    yield "noise.low_pass_ms", Origin(LOW_PASS, (), "ms").entry(noise.low_pass_ms)


def _keys(spec: InfantSpec) -> Iterator[str]:
    """Yield the keys of the spec that give noise by region."""
    for region in spec.impairments.noise if spec.impairments else ():
        yield f"spec.impairments.noise.{region}"
