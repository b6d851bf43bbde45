"""The section of the report on delays that is about reaches of infants."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from mimoc.noise.presets import motor_share
from mimoc.studies.experiments.infant_reaches import DELAYS, JITTER_MS, MEASURES, NOISE, OWN, Group, by_delay
from mimoc.studies.experiments.notebook import markdown_table, page_texts
from mimoc.studies.experiments.sensed_reaching import GAINS, REACH_SHARE, TOUCHED_M
from mimoc.studies.experiments.smoothness import UNIT_M_S

LEAST_S = 0.4
"""What reaches of infants last at least."""

TEXTS = page_texts("infant_reaches")

FIGURES = (
    ("von Hofsten 1979, 1991", "3 to 7 movement units at the onset of reaching, 1 or 2 at 7 to 8 months", "read"),
    ("Fetters & Todd 1987", "movement units of about 0.2 s at 5 to 9 months", "read"),
    ("Konczak & Dichgans 1997", "75 % of reaches have a single peak of speed only at 24 months", "read"),
    ("Berthier & Keen 2006", "speed falls slowly with age, jerk falls fast", "read"),
    ("Thelen et al. 1996", "infants who move fast reach less straight", "read"),
    ("several", "0.6 to 1.5 s; mean speed 0.15 to 0.4 m/s, peak 0.3 to 0.8 m/s", "from memory"),
)
"""What is known of reaches of infants: the source, what it says, and whether it was read or is known from memory."""
SMOOTHER = {"movement_units": -1, "path_ratio": -1, "spectral_arc_length": 1, "log_dimensionless_jerk": 1}
"""Measures of smoothness, and whether smoother movements have more (1) or less (-1) of them."""


def infant_sections(groups: Sequence[Group], most_s: float) -> tuple[str, str]:
    """Return the sections of the report: method with measurements, and comparison.

    Args:
        groups: The reaches by age and delay, the youngest first, in the order of `DELAYS`.
        most_s: Simulated time after which a reach was given up.
    """
    ages = list(dict.fromkeys(group.age_months for group in groups))
    about = TEXTS["about"].format(
        count=len(groups[0].reaches),
        ages=_listed([f"{age:g}" for age in ages]),
        own=_range([group.sensory_ms for group in by_delay(groups)[OWN]]),
        motor=_range([round(motor_share(age), 2) for age in ages]),
        deg=NOISE["proprioception_deg"],
        jitter=JITTER_MS,
        strength=GAINS.hands.strength,
        cap_cm=100 * GAINS.hands.cap,
        viscosity=GAINS.hands.viscosity_per_s,
        most=GAINS.hands.strength * GAINS.hands.cap / GAINS.hands.viscosity_per_s,
        unit_cm=100 * UNIT_M_S,
        share=REACH_SHARE,
        touched_cm=100 * TOUCHED_M,
        most_s=most_s,
        youngest=ages[0],
        table=_measured(groups),
    )
    figures = markdown_table(("source", "reaches of real infants", "certainty"), FIGURES)
    return about, TEXTS["real"].format(table=figures, verdict=_verdict(groups))


def _measured(groups: Sequence[Group]) -> str:
    headings = (
        *("age [months]", "delay", "arrived", "duration [s]", "mean speed [m/s]", "peak speed [m/s]"),
        *("movement units", "path length / distance", "spectral arc length", "log dimensionless jerk"),
    )
    rows = [
        (
            f"{group.age_months:g}",
            group.delay,
            f"{group.arrived:.0%}",
            *(f"{group.median(measure):.3g}" for measure in MEASURES.values()),
        )
        for group in groups
    ]
    return markdown_table(headings, rows)


def _verdict(groups: Sequence[Group]) -> str:
    """Return as text what holds of the measurements."""
    of_age = by_delay(groups)[OWN]
    lines = [_durations(of_age), *(_smoothness(name, groups) for name in SMOOTHER), _gain_with_age(of_age)]
    return "\n".join(f"- {line}" for line in lines)


def _durations(of_age: Sequence[Group]) -> str:
    """Return what holds of the durations with the delays of each age."""
    medians_s = [group.median(MEASURES["duration_s"]) for group in of_age]
    units = [group.median(MEASURES["movement_units"]) for group in of_age]
    shortest_s = min(reach.duration_s for group in of_age for reach in group.reaches)
    return (
        f"With the delays of their age, reaches last {_range([round(s, 2) for s in medians_s])} s (medians; the "
        f"shortest of all {shortest_s:.2f} s), with {_range(units)} movement units; at least {LEAST_S:g} s at every "
        f"age: {_yes(min(medians_s) >= LEAST_S)}."
    )


def _smoothness(name: str, groups: Sequence[Group]) -> str:
    """Return how a measure of smoothness changes with delay, and with age at the delays of each age."""
    smooth = {(group.age_months, group.delay): SMOOTHER[name] * group.median(MEASURES[name]) for group in groups}
    ages = sorted({age_months for age_months, _ in smooth})
    pairs = [(smooth[age, less], smooth[age, more]) for age in ages for less, more in pairwise(DELAYS)]
    falls = sum(more <= less for less, more in pairs)
    by_age = ", ".join(f"{SMOOTHER[name] * smooth[age, OWN]:.3g}" for age in ages)
    rises = _yes(smooth[ages[-1], OWN] > smooth[ages[0], OWN])
    return (
        f"By {name.replace('_', ' ')}, movements are less smooth with the longer delay in {falls} of {len(pairs)} "
        f"pairs of successive delays; with the delays of their age, the oldest infant's are smoother than the "
        f"youngest's ({by_age}): {rises}."
    )


def _gain_with_age(of_age: Sequence[Group]) -> str:
    """Return how much smoother the oldest infant reaches than the youngest, for the same targets, and how certainly."""
    youngest, oldest = ([reach.arc_length for reach in group.reaches] for group in (of_age[0], of_age[-1]))
    gains = np.subtract(oldest, youngest)
    error = gains.std() / np.sqrt(len(gains))
    return (
        f"From {of_age[0].age_months:g} to {of_age[-1].age_months:g} months, for the same targets, the spectral arc "
        f"length rises by {gains.mean():.2f} on average, with a standard error of {error:.2f}: body, delays and noise "
        "of the age account for a small part of what real infants gain in these months."
    )


def _listed(words: Sequence[str]) -> str:
    *first, last = words
    return f"{', '.join(first)} and {last}" if first else last


def _range(values: Sequence[float]) -> str:
    low, high = min(values), max(values)
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"


def _yes(is_so: bool) -> str:
    return "yes" if is_so else "no"
