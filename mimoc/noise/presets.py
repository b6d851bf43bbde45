"""The noise of an infant: what its spec gives, and for a word, the amount at its age."""

from mimoc.body.decay import Decay
from mimoc.noise.spec import NoiseEntry, noise_keys
from mimoc.schema.infant import InfantSpec

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
