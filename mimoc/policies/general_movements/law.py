"""How infants move by themselves, by age: the numbers of `GeneralMovements`, and where they come from."""

from collections.abc import Mapping
from dataclasses import dataclass, fields

import numpy as np

AGES_MONTHS = (0.0, 1.0, 2.0, 3.0, 4.0, 6.0, 9.0, 12.0, 24.0)
"""Ages of the columns of `COLUMNS`."""


@dataclass(frozen=True, slots=True)
class Law:
    """Numbers of spontaneous movement at one age. A share is one of the strength of a joint, in its direction."""

    rate_hz: float
    """Bursts a second of a limb, on average."""
    strength: float
    """Median size of a burst, a share."""
    size_spread: float
    """Standard deviation of the logarithm of the sizes of bursts."""
    duration_s: float
    """Median duration of a burst."""
    duration_spread: float
    """Standard deviation of the logarithm of durations."""
    coherence: float
    """Correlation of what a burst asks of the joints of a limb with flexion or extension of all of it, from 0 to 1."""
    rebound: float
    """Size of the opposite burst that follows a burst, relative to it."""
    together: float
    """Share of the bursts that begin in both arms or in both legs at once."""
    whole: float
    """Share of the bursts that begin in all limbs at once."""
    arms_in_phase: float
    """Correlation of the directions of such bursts of both arms, from -1 (alternating) to 1."""
    legs_in_phase: float
    """The same of both legs."""
    swell: float
    """Standard deviation of the logarithm of the rate of all limbs that arousal makes."""
    swell_s: float
    """Time constant of arousal."""
    size_swell: float
    """The same as `swell` of the size of bursts."""
    limb_swell: float
    """Standard deviation of the logarithm of the rate of a limb by itself."""
    limb_swell_s: float
    """Its time constant."""
    slow: float
    """Standard deviation of slow changes of posture, a share."""
    slow_s: float
    """Their time constant."""
    fidget: float
    """Standard deviation of the continual small movements, a share."""
    fidget_hz: float
    """Their frequency."""
    tone: float
    """Activation of both muscles of all joints, beside everything else."""
    arms: float
    """Size of the bursts of arms, relative to those of legs."""
    trunk: float
    """The same of trunk and head."""
    distal: float
    """The same of wrists, fingers, ankles and toes, relative to their limb."""
    arms_up: float
    """Posture: share of the muscles that raise the arms."""
    arms_bent: float
    """Posture: share of the muscles that bend the elbows."""
    legs_bent: float
    """Posture: share of the muscles that bend the hips."""
    knees_bent: float
    """Posture: share of the muscles that bend the knees."""
    goals: float
    """Size of movements towards goals, from 0 to 1."""
    goals_hz: float
    """Such movements a second of a limb."""


def law_at(age_months: float) -> Law:
    """Return the numbers at an age, linear between the columns of the table, and constant outside them."""
    return Law(**{name: float(np.interp(age_months, AGES_MONTHS, column)) for name, column in COLUMNS.items()})


def _constant(value: float) -> tuple[float, ...]:
    return (value,) * len(AGES_MONTHS)


COLUMNS: Mapping[str, tuple[float, ...]] = {
    "rate_hz": _constant(1.2),
    "strength": _constant(0.5),
    "size_spread": _constant(0.7),
    "duration_s": _constant(0.3),
    "duration_spread": _constant(0.35),
    "coherence": _constant(0.6),
    "rebound": _constant(0.3),
    "together": _constant(0.2),
    "whole": _constant(0.1),
    "arms_in_phase": _constant(0.4),
    "legs_in_phase": _constant(0.1),
    "swell": _constant(0.8),
    "swell_s": _constant(4.0),
    "size_swell": _constant(0.3),
    "limb_swell": _constant(0.6),
    "limb_swell_s": _constant(2.0),
    "slow": _constant(0.15),
    "slow_s": _constant(1.5),
    "fidget": _constant(0.05),
    "fidget_hz": _constant(1.5),
    "tone": _constant(0.05),
    "arms": _constant(1.0),
    "trunk": _constant(0.3),
    "distal": _constant(0.4),
    "arms_up": _constant(0.0),
    "arms_bent": _constant(0.0),
    "legs_bent": _constant(0.0),
    "knees_bent": _constant(0.0),
    "goals": (0.0, 0.0, 0.0, 0.0, 0.3, 0.6, 1.0, 1.0, 1.0),
    "goals_hz": _constant(0.3),
}
assert set(COLUMNS) == {field.name for field in fields(Law)}
