"""Where each delay comes from."""

from collections.abc import Iterator

from mimoc.body.origins import Entry
from mimoc.delays.spec import DelaysEntry, given_keys, signals
from mimoc.schema.infant import InfantSpec

PRESETS = {
    "none": "no preset",
    "paper": "the paper: 50 ms for senses, one physics step for motors",
    "physiological": "conduction times by age, interpolated (see mimoc/delays/presets.py), to the nearest physics step",
}
"""The rule of each preset."""


def trace_delays(spec: InfantSpec, delays: DelaysEntry) -> Iterator[tuple[str, Entry]]:
    """Yield an entry for each delay in the manifest."""
    for signal in signals():
        keys = given_keys(spec.delays, signal)[:1]
        rule = "given by the spec" if keys else PRESETS[spec.delays.preset]
        sources = [f"spec.delays.{key}" for key in keys] or [
            "spec.delays.preset",
            "spec.age_months",
            "spec.control.timestep_ms",
        ]
        delay = getattr(delays, signal)
        for name, ms in (("ms", delay.ms), ("legs_ms", delay.legs_ms)):
            if ms is not None:
                yield f"delays.{signal}.{name}", {"value": ms, "unit": "ms", "rule": rule, "from": sources}
