"""Where each noise comes from."""

from collections.abc import Iterator

from mimoc.body.provenance import Entry
from mimoc.noise.spec import NoiseEntry, noise_keys
from mimoc.senses import SENSES

LOW_PASS = "assumed time constant of an infant's muscles (half-relaxation is 90 ms at 3 years, Lin et al. 1994)"


def trace_noise(noise: NoiseEntry) -> Iterator[tuple[str, Entry]]:
    """Yield an entry for each noise in the manifest."""
    units = {"motor": "1", "delay_jitter_ms": "ms"}
    for name, key in noise_keys().items():
        option = SENSES[name].noise
        units[key] = option.unit if option else ""
    for key, unit in units.items():
        value = getattr(noise, key)
        yield f"noise.{key}", {"value": value, "unit": unit, "rule": "given by the spec", "from": [f"spec.noise.{key}"]}
    yield "noise.low_pass_ms", {"value": noise.low_pass_ms, "unit": "ms", "rule": LOW_PASS}
