"""The delays of an infant of some age, as far as balance depends on them."""

from mimoc.delays.presets import PRESETS, given_keys
from mimoc.schema.infant import InfantSpec
from mimoc.units import ms_to_s

SENSED = ("proprioception", "vestibular")
"""The senses that tell posture and balance."""


def longest_delays_s(spec: InfantSpec) -> tuple[float, float]:
    """Return the longest delays of posture senses and of commands, those of the legs: the whole state waits for them.

    They are those of the spec, or physiological ones of its age if it asks for none.
    """
    sensory_ms = max(_longest_ms(spec, signal) for signal in SENSED)
    return ms_to_s(sensory_ms), ms_to_s(_longest_ms(spec, "motor"))


def _longest_ms(spec: InfantSpec, signal: str) -> float:
    if keys := given_keys(spec.delays, signal):
        return float(getattr(spec.delays, keys[0]))
    preset = "physiological" if spec.delays.preset == "none" else spec.delays.preset
    entry = PRESETS[preset](signal, spec.age_months, spec.control.timestep_ms)
    return max(entry.ms, entry.legs_ms or 0.0)
