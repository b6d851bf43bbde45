"""How eyes move, by age: saccades, their steps and latencies, pursuit, reflexes, vergence, and the share of the head.

Each table is by months of corrected age, interpolated linearly, constant before and after. Which of its numbers were
measured, derived or guessed stands beside it; `docs/behaviours.md` says which of what comes out was put in.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mimoc.base.units import ms_to_s
from mimoc.bundle.manifest import Manifest
from mimoc.compiler.presets import MIN_MS, SACCADE_MS, VARIATION
from mimoc.policies.behaviours.behaviour import SIGHT, Reaction

Table = Mapping[float, float]  # A number by months.

PEAK_DEG_S: Table = {0: 0, 5: 213, 15: 352, 30: 455, 60: 520}
"""Peak speed of a saccade by its size in degrees, the main sequence of adults, which infants of 14 to 151 days have on
textures (Hainline et al. 1984); beyond 30 degrees a guess. By size, not by months."""
FIRST_STEP: Table = {0: 0.3, 1: 0.34, 2: 0.5, 3: 0.8, 4: 0.9, 12: 0.93}
"""Size of the first saccade to a target, as a share of its distance. At one and two months several steps of the same
size follow (Aslin & Salapatek 1975, who give no table: a guess); 0.9 and more are adults' (from memory)."""
LEAST_STEP_DEG = 4.0  # Nearer than this, one saccade is enough (a guess).
TURN_RATIO = 1.42
"""Latency of a saccade to a target that was followed and reappears elsewhere, by that to a new one: 595 ms at 4 and
442 ms at 8 months (Gredebäck et al. 2006) by 420 and 310; 1.39 to 1.46 at other ages."""
PAUSE_SHARE = 0.5  # Mean pause between the steps of one look, as a share of the latency to a new target (a guess).
LEAST_PAUSE_S = 0.1  # No pause between saccades is shorter (a guess; in adults, some .1 s).
ON_TARGET_DEG = 1.0  # Error below which no saccade corrects the gaze (a guess; adults' fixations scatter by some .5).
PURSUIT_GAIN: Table = {0: 0.3, 2.1: 0.5, 3: 0.7, 5: 0.9, 12: 0.95}
"""Speed of smooth pursuit by that of a slow target: .5 at 7 to 11 weeks (Shea & Aslin 1990), .9 at 5 months (von
Hofsten & Rosander 1997); others are guesses."""
PURSUIT_LIMIT_DEG_S: Table = {0: 0.7, 1: 1.0, 2.1: 1.45, 3: 6.0, 5: 30.0, 12: 60.0}
"""Fastest smooth pursuit: at 7 to 11 weeks, eyes are as slow after 6 and 12 as after 3 degrees a second (gains .25 and
.11, Shea & Aslin 1990); others are guesses."""
FORESIGHT: Table = {0: 0.0, 1: 0.0, 3: 0.5, 6: 1.0}
"""Share of the delay of sight that is foreseen of a target that moves evenly: gaze lags by 170 ms at 1, by 70 at 3
months (von Hofsten & Rosander 1996), and not at 6 (derived)."""
VESTIBULAR_GAIN: Table = {0: 1.0, 1: 1.03, 4: 1.03, 12: 1.0}
"""Speed at which eyes turn against a turn of the head: 1.03 at 1 to 4 months in the dark (Finocchio et al. 1991)."""
OPTOKINETIC_GAIN: Table = {0: 2.0, 3: 3.0, 12: 4.0}
"""Open-loop gain G of optokinetic stabilisation, which leaves 1 / (1 + G) of a slip of the whole field (a guess: gain
hardly changes from 1 to 3 months, von Hofsten & Rosander 1996)."""
OPTOKINETIC_S = 1.0  # Its time constant (a guess; stable with the delay of newborns' sight).
VERGENCE: Table = {0: 0.3, 1: 0.6, 2: 0.9, 4: 1.0}
"""How far the eyes turn to one point: near adults' from 8 to 9 weeks (Horwood & Riddell 2013), the rest a guess."""
VERGENCE_S = 0.25  # Time constant of changes of vergence (a guess; adults' take some .2 s).
HEAD_SHARE: Table = {0: 0.0, 2: 0.0, 3: 0.7}
"""Share that the head takes of a turn beyond the free range of the eyes: eyes alone turn at 2 months, at 3 the head
shares as in adults (Regal, Ashmead & Salapatek 1983); the size is a guess."""
EYES_ALONE_DEG = 12.0  # Turns that eyes make without the head at any age (adults' 15 to 20, from memory; a guess).
EYES_REACH_DEG = 35.0  # Beyond this, the head turns at any age (a guess).
HEAD_LATE_S: Table = {0: 0.5, 3: 0.3, 6: 0.2, 12: 0.1}
"""How long after the eyes the head sets out: "always late" (von Hofsten & Rosander 1997); a guess."""
FIXATION_S: Table = {0: 2.0, 1: 1.6, 2: 1.2, 3: 0.9, 6: 0.6, 12: 0.5, 24: 0.4}
"""Median duration of fixations while an infant looks around: a guess, long at 1 to 2 months, when gaze is sticky."""
FIXATION_SPREAD = 0.5  # Standard deviation of the logarithm of these (a guess).


def at_age(table: Table, months: float) -> float:
    """Return a number at an age."""
    return float(np.interp(months, list(table), list(table.values())))


def peak_rad_s(size_rad: float) -> float:
    """Return the peak speed of a saccade of some size, by the main sequence."""
    return math.radians(at_age(PEAK_DEG_S, math.degrees(size_rad)))


@dataclass(frozen=True, slots=True)
class Oculomotor:
    """How the eyes of one infant move."""

    first_step: float
    pause_s: float  # Mean pause between the saccades of one look.
    variation: float  # Standard deviation of latencies and pauses, as a share of their mean.
    pursuit_gain: float
    pursuit_limit_rad_s: float
    foresight: float
    vestibular_gain: float
    optokinetic_gain: float
    vergence: float
    head_share: float
    head_late_s: float
    fixation_s: float

    @classmethod
    def of(cls, manifest: Manifest) -> "Oculomotor":
        """Return what is usual at the corrected age of an infant; a vergence below 1 in its spec wins."""
        months = manifest.child.corrected_age_months
        vision = manifest.senses.vision
        is_given = vision is not None and vision.vergence < 1.0
        return cls(
            first_step=at_age(FIRST_STEP, months),
            pause_s=max(LEAST_PAUSE_S, PAUSE_SHARE * ms_to_s(at_age(SACCADE_MS, months))),
            variation=at_age(VARIATION, months),
            pursuit_gain=at_age(PURSUIT_GAIN, months),
            pursuit_limit_rad_s=math.radians(at_age(PURSUIT_LIMIT_DEG_S, months)),
            foresight=at_age(FORESIGHT, months),
            vestibular_gain=at_age(VESTIBULAR_GAIN, months),
            optokinetic_gain=at_age(OPTOKINETIC_GAIN, months),
            vergence=vision.vergence if vision is not None and is_given else at_age(VERGENCE, months),
            head_share=at_age(HEAD_SHARE, months),
            head_late_s=at_age(HEAD_LATE_S, months),
            fixation_s=at_age(FIXATION_S, months),
        )

    def step_rad(self, away_rad: float) -> float:
        """Return the size of the first saccade to something at some angle from the line of sight."""
        return max(self.first_step * away_rad, min(away_rad, math.radians(LEAST_STEP_DEG)))

    def pursuit_rad_s(self, target_rad_s: float) -> float:
        """Return the speed of smooth pursuit of a target with some speed."""
        return min(self.pursuit_gain * target_rad_s, self.pursuit_limit_rad_s)

    def pause_of(self, normal: float) -> float:
        """Return a log-normal pause between two saccades, from a number of the standard normal distribution."""
        spread = math.sqrt(math.log1p(self.variation**2))
        return max(LEAST_PAUSE_S, self.pause_s * math.exp(spread * normal - spread**2 / 2))

    def fixation_of(self, normal: float) -> float:
        """Return a log-normal duration of a fixation, from a number of the standard normal distribution."""
        return self.fixation_s * math.exp(FIXATION_SPREAD * normal)


def look_reaction(manifest: Manifest, is_told: bool) -> Reaction[int]:
    """Return the reaction of an infant's gaze to new things.

    The mean of a decision and its variation are those of `delays.processing`, or else what the table of the age leaves
    beside conduction in and out. One that is told the truth sees without conduction, and decides at once unless it has
    `delays.processing`.
    """
    delays = dict(manifest.delays)
    conduction_s = 0.0 if is_told else ms_to_s(delays[SIGHT].ms)
    if (processing := manifest.delays.processing) is not None:
        return Reaction(conduction_s, ms_to_s(processing.look_ms), processing.look_variation)
    if is_told:
        return Reaction(0.0, 0.0, 0.0)
    months = manifest.child.corrected_age_months
    whole_ms = at_age(SACCADE_MS, months)
    decision_ms = max(MIN_MS, whole_ms - delays[SIGHT].ms - delays["motor"].ms)
    return Reaction(conduction_s, ms_to_s(decision_ms), at_age(VARIATION, months) * whole_ms / decision_ms)


def after_a_turn(reaction: Reaction[int], manifest: Manifest) -> Reaction[int]:
    """Return the reaction to something that was followed and turns up elsewhere; see `TURN_RATIO`."""
    if reaction.mean_s == 0.0:
        return Reaction(reaction.conduction_s, 0.0, 0.0)
    whole_s = reaction.conduction_s + reaction.mean_s + ms_to_s(dict(manifest.delays)["motor"].ms)
    mean_s = reaction.mean_s + (TURN_RATIO - 1.0) * whole_s
    spread = reaction.variation * reaction.mean_s / whole_s
    return Reaction(reaction.conduction_s, mean_s, spread * TURN_RATIO * whole_s / mean_s)
