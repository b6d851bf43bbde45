"""Where each number of the senses and their delays comes from."""

from collections.abc import Iterator

from mimoc.body.provenance import Entry
from mimoc.bundle.manifest import DelaysEntry, Manifest, TouchEntry, VisionEntry
from mimoc.delays.presets import PHYSIOLOGICAL
from mimoc.schema.infant import InfantSpec

AGE, TIMESTEP = "spec.age_months", "spec.control.timestep_ms"
PROFILES = {
    "tac2": "log2 of acuity = -.1839 ln²t + 1.8235 ln t - .5889 at t months, fitted to Mayer et al. 1995 and Salomão & "
    "Ventura 1995 on the scale of the TAC II (Neijzen et al. 2025)",
    "mayer1995": "Mayer et al. 1995, log acuity interpolated over log age",
    "mimo_v2": "the figures of MIMo v2, log acuity interpolated over log age",
}
"""What each acuity profile goes by."""
PRESETS = {
    "none": "no preset",
    "paper": "the paper: 50 ms for senses, one physics step for motors",
    "physiological": "conduction times by age, interpolated (see mimoc/scene/latency.py), to the nearest physics step",
}
"""What each preset of delays goes by."""


def trace_senses(spec: InfantSpec, manifest: Manifest) -> dict[str, Entry]:
    """Return an entry for each number of touch, vision and delays that the manifest holds."""
    return {
        **dict(_trace_delays(spec, manifest.delays)),
        **dict(_trace_touch(manifest.senses.touch) if manifest.senses.touch else ()),
        **dict(_trace_vision(spec, manifest.senses.vision) if manifest.senses.vision else ()),
    }


def _trace_delays(spec: InfantSpec, delays: DelaysEntry) -> Iterator[tuple[str, Entry]]:
    given = {key for key, ms in spec.delays if ms is not None}
    for channel in PHYSIOLOGICAL:
        common_key = "motor_ms" if channel == "motor" else "sensory_ms"
        keys = [key for key in (f"{channel}_ms", common_key) if key in given][:1]
        rule = "given by the spec" if keys else PRESETS[spec.delays.preset]
        sources = [f"spec.delays.{key}" for key in keys] or ["spec.delays.preset", AGE, TIMESTEP]
        delay = getattr(delays, channel)
        for name, ms in (("ms", delay.ms), ("legs_ms", delay.legs_ms)):
            if ms is not None:
                yield f"delays.{channel}.{name}", {"value": ms, "unit": "ms", "rule": rule, "from": sources}


def _trace_touch(touch: TouchEntry) -> Iterator[tuple[str, Entry]]:
    rule = "two-point discrimination there at 18 months (MIMo) / sqrt(density), grown with the body's skin"
    for body, spacing_m in touch.spacing_m.items():
        sources = ["spec.senses.touch.density", AGE]
        yield f"skin.{body}.spacing", {"value": spacing_m, "unit": "m", "rule": rule, "from": sources}


def _trace_vision(spec: InfantSpec, vision: VisionEntry) -> Iterator[tuple[str, Entry]]:
    assert spec.senses.vision
    sources = [f"spec.senses.vision.{key}" for key in ("acuity", "acuity_profile")]
    by_age = isinstance(spec.senses.vision.acuity, (int, float, str))
    rule = PROFILES[spec.senses.vision.acuity_profile] if by_age else "given by the spec"
    if vision.acuity_cpd is not None:
        entry = {"value": vision.acuity_cpd, "unit": "cycles/deg", "rule": rule, "from": [*sources, AGE]}
        yield "vision.acuity_cpd", entry
