"""Where each noise comes from."""

from collections.abc import Iterator

from mimoc.body.origins import Entry
from mimoc.noise.presets import ADULT_SHARE, NEWBORN_SHARE
from mimoc.noise.presets import MATURING as LOSS
from mimoc.noise.spec import NoiseEntry, noise_keys
from mimoc.schema.infant import InfantSpec
from mimoc.senses import SENSES

MATURING = (
    f"derived: {ADULT_SHARE} + {NEWBORN_SHARE - ADULT_SHARE:.1f} of the newborn share, "
    f"with tau {LOSS.tau_months:g} months and power {LOSS.power:g}; no infant was measured"
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
            rule, sources = MATURING, [*sources, "spec.age_months"]
        yield f"noise.{key}", {"value": getattr(noise, key), "unit": unit, "rule": rule, "from": sources}
    yield "noise.low_pass_ms", {"value": noise.low_pass_ms, "unit": "ms", "rule": LOW_PASS}
