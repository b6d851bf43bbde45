"""What is just heard: the thresholds of adults by frequency, and how much higher an infant's are by age."""

from collections.abc import Mapping

import numpy as np

ADULT_DB: Mapping[float, float] = dict(
    zip(
        (125, 250, 500, 1000, 1500, 2000, 3000, 4000, 6000, 8000, 12_500),
        (22.1, 11.4, 4.4, 2.4, 2.4, -1.3, -5.8, -5.4, 4.3, 12.6, 11.9),
        strict=True,
    )
)
"""Adults' thresholds in a free field, in dB re 20 µPa by frequency (ISO 389-7; from memory)."""
EXCESS_MONTHS = 0.0, 3.0, 6.0, 12.0, 24.0
EXCESS_HZ = 500.0, 1000.0, 4000.0, 8000.0
EXCESS_DB = (
    (40, 38, 33, 38),
    (22, 20, 18, 28),
    (15, 14, 9, 10),
    (13, 12, 6, 6),
    (10, 8, 4, 4),
)
"""How much higher infants' thresholds are, by age and frequency, in dB: derived from Olsho & Gillenwater 1989 (2 to 4
weeks), Olsho et al. 1988 (3 to 12 months) and Nozza & Wilson 1984 (6 and 12 months). That of 24 months is a guess."""


def excess_db(age_months: float, frequency_hz: float) -> float:
    """Return how much higher than adults' an infant's threshold is, interpolated by age and the logarithm of frequency.

    Below 500 Hz and above 8 kHz it is that there.
    """
    of_age = [np.interp(age_months, EXCESS_MONTHS, column) for column in zip(*EXCESS_DB, strict=True)]
    return float(np.interp(np.log(frequency_hz), np.log(EXCESS_HZ), of_age))


def threshold_table(thresholds: str, age_months: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return frequencies and what is just heard there [dB re 20 µPa]; nothing of both where everything is heard.

    Args:
        thresholds: `age`, `adult` or `off`.
        age_months: Age of the infant.
    """
    if thresholds == "off":
        return (), ()
    at_age = thresholds == "age"
    levels_db = (level + (excess_db(age_months, hz) if at_age else 0.0) for hz, level in ADULT_DB.items())
    return tuple(map(float, ADULT_DB)), tuple(levels_db)
