"""The noise of an infant, as its spec gives it."""

from mimoc.noise.spec import NoiseEntry, noise_keys
from mimoc.schema.infant import InfantSpec


def noise(spec: InfantSpec) -> NoiseEntry:
    """Return the noise of commands, senses and delays."""
    keys = ("motor", "delay_jitter_ms", *noise_keys().values())
    return NoiseEntry(**{key: getattr(spec.noise, key) for key in keys})
