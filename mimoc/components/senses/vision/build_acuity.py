"""Visual acuity by age: the finest grating that an infant sees."""

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from mimoc.components.senses.vision import AcuitySpec, VisionSpec

NEWBORN_CPD = 0.64
"""Acuity at birth on the scale of the TAC II, estimated: the fit of `tac2` begins at one month, with 0.66."""
TAC2_MONTHS = 1.0, 36.0
"""Ages that the fit of `tac2` covers."""
TAC2_LOG2_CPD = -0.1839, 1.8235, -0.5889
"""Binary logarithm of acuity over the natural logarithm of months, highest power first. It rises until 142 months.

Fitted by weight to the monocular acuities of Mayer et al. 1995 and of Salomão & Ventura 1995, lowered by 0.3 octave to
the scale of the TAC II: what Neijzen et al. 2025, the source of MIMo v2's paper, pools (rms 0.26 octave).
"""
MAYER_1995_CPD: Mapping[float, float] = dict(
    zip(
        (1, 1.5, 2.5, 4, 6, 9, 12, 18, 24, 30, 36, 48),
        (0.94, 1.11, 2.16, 2.68, 5.65, 6.79, 6.42, 8.59, 9.57, 11.52, 21.81, 24.81),
        strict=True,
    )
)
"""Mean monocular acuity by months, Mayer et al. 1995; it falls a little from 9 months to 12."""
MIMO_V2_CPD: Mapping[float, float] = {
    1: 0.85,
    2: 1.74,
    3: 2.67,
    4: 3.63,
    6: 5.64,
    9: 8.29,
    12: 9.38,
    18: 9.89,
    24: 11.6,
}
"""By months, as MIMo v2 has it."""


def resolve_acuity(vision: VisionSpec, age_months: float) -> float | None:
    """Return the finest grating that an infant sees, in cycles per degree; None where nothing is blurred."""
    if isinstance(vision.acuity, AcuitySpec):
        return vision.acuity.cpd
    if vision.acuity == "off":
        return None
    return acuity_at(age_months if vision.acuity == "age" else vision.acuity, vision.acuity_profile)


def acuity_at(age_months: float, profile: str) -> float:
    """Return the finest grating seen at an age, in cycles per degree, by one of `PROFILES`."""
    return PROFILES[profile](age_months)


def _tac2(age_months: float) -> float:
    """Return what the fit says; below its first month, acuity rises evenly from a newborn's."""
    first, last = TAC2_MONTHS
    fitted = 2 ** np.polyval(TAC2_LOG2_CPD, np.log(np.clip(age_months, first, last)))
    return float(NEWBORN_CPD + min(age_months / first, 1.0) * (fitted - NEWBORN_CPD))


def _interpolated(table_cpd: Mapping[float, float], age_months: float) -> float:
    """Return a table's acuity, its logarithm interpolated over that of age; before its first age it is the first's."""
    months, cpd = np.log(list(table_cpd)), np.log(list(table_cpd.values()))
    return float(np.exp(np.interp(np.log(max(age_months, min(table_cpd))), months, cpd)))


PROFILES: Mapping[str, Callable[[float], float]] = {
    "tac2": _tac2,
    "mayer1995": partial(_interpolated, MAYER_1995_CPD),
    "mimo_v2": partial(_interpolated, MIMO_V2_CPD),
}
"""Acuity by age, by whose measurements it goes. From birth to 24 months, none but Mayer's ever falls."""
