"""Reaches with late senses: of infants of several ages, with the noise of their age, and what makes them ataxic."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from mimoc.base.quantities import AGE, Quantity
from mimoc.base.units import ms_to_s
from mimoc.compiler import building
from mimoc.compiler.presets import motor_share
from mimoc.motion.hand_movement import UNIT_M_S
from mimoc.policies.reach import GAIN_SETS
from mimoc.render.plots import Line, Plot
from mimoc.runtime.env import InfantEnv
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import Development
from mimoc.studies.experiment import Table, child
from mimoc.studies.experiments.sensed_reaching import GAINS, REACH_SHARE, TOUCHED_M, Reach, reach_once
from mimoc.studies.notebook import page_text, table_rows, yes

DELAYS_MS: Sequence[float] = (0, 50, 200)  # Delays of the senses, the paper's.
MOTOR_MS = 5.0  # Delay of commands, the paper's.
AGE_MONTHS, STEP_MS = 18.0, 10.0
OTHER_LAW: Mapping[Development, Development] = {"published": "maturing", "maturing": "published"}
SEED = 1  # Seed of the targets, which are in the same directions for all infants.


@dataclass(frozen=True, slots=True)
class Variant:
    """An infant that reaches, and how; everything but the delay."""

    name: str
    gains: str = "high"  # Key of the controller's gains.
    share: float = REACH_SHARE  # Distance of the targets, by the length of the arm.
    strength: float = 1.0  # Factor on the strength of the arms.
    step_ms: float = STEP_MS  # Time between commands.
    age_months: float = AGE_MONTHS
    other_law: bool = False  # Whether it has the other law of development.


VARIANTS: Sequence[Variant] = (
    Variant("high gains"),
    Variant("medium gains", gains="medium"),
    Variant("low gains", gains="low"),
    Variant("high gains, targets at 0.5 of the arm", share=0.5),
    Variant("high gains, targets at 0.95 of the arm", share=0.95),
    Variant("high gains, arms of a fifth of the strength", strength=0.2),
    Variant("high gains, commands every 5 ms", step_ms=5.0),
    Variant("high gains, commands every 50 ms", step_ms=50.0),
    Variant("high gains, 3 months old", age_months=3.0),
    Variant("high gains, 9 months old", age_months=9.0),
    Variant("high gains, the other law", other_law=True),
)
PLOTTED = ("high gains", "low gains")  # Variants whose first reach is plotted.
MEASURES: Mapping[str, Callable[[Reach], float]] = {  # Measures of a reach by the heading of their column.
    "duration_s": lambda reach: reach.duration_s,
    "mean_speed_m_s": lambda reach: float(reach.speed_m_s.mean()),
    "peak_speed_m_s": lambda reach: float(reach.speed_m_s.max()),
    "movement_units": lambda reach: reach.units,
    "path_ratio": lambda reach: reach.path_ratio,
    "spectral_arc_length": lambda reach: reach.arc_length,
    "log_dimensionless_jerk": lambda reach: reach.jerk,
}
ATAXIC = ("duration_s", "movement_units", "path_ratio", "peak_speed_m_s")  # Measures of these reaches.
Reaches = Mapping[tuple[Variant, float], Sequence[Reach]]  # By variant and delay.


def ataxic_infant(variant: Variant, development: Development, delay_ms: float) -> InfantSpec:
    """Return an infant that sits with its hip held and moves its right arm, without noise."""
    return child(
        "reaching",
        variant.age_months,
        development=OTHER_LAW[development] if variant.other_law else development,
        actuation={"regions": ["right_arm"], "locked": ["trunk", "neck"], "strength": {"arms": variant.strength}},
        control={"step_ms": variant.step_ms, "timestep_ms": 5.0},
        senses={"proprioception": {"include": ["velocity"]}},
        delays={"sensory_ms": float(delay_ms), "motor_ms": MOTOR_MS},
        scene={"kind": "flat", "pose": "sitting", "held": ["hip"]},
    )


def reach_with_variants(
    variants: Sequence[Variant], development: Development, count: int, most_s: float, counted: Callable[[Any], object]
) -> Reaches:
    """Let the infant of each variant reach with each delay for the same targets; *counted* is called for each."""
    reaches: dict[tuple[Variant, float], Sequence[Reach]] = {}
    for variant in variants:
        for delay_ms in DELAYS_MS:
            generator = np.random.default_rng(SEED)
            with closing(InfantEnv(building.build(ataxic_infant(variant, development, delay_ms)))) as env:
                how = {"gains": variant.gains, "share": variant.share}
                same = [reach_once(env, seed, generator, most_s, **how) for seed in range(count)]
            reaches[variant, delay_ms] = same
            counted(same)
    return reaches


def ataxia_table(reaches: Reaches) -> Table:
    """Return the table of these reaches."""
    rows = (
        (variant.name, delay_ms, index, float(reach.arrived), *(MEASURES[name](reach) for name in ATAXIC))
        for (variant, delay_ms), same in reaches.items()
        for index, reach in enumerate(same)
    )
    return ",".join(("variant", "delay_ms", "reach", "arrived", *ATAXIC)), rows


def ataxia_plots(reaches: Reaches) -> list[Plot]:
    """Return plots of the first reach of some variants."""
    names = [name for name in PLOTTED if any(variant.name == name for variant, _ in reaches)]
    return [_plot(reaches, name) for name in names]


def _plot(reaches: Reaches, name: str) -> Plot:
    lines = []
    for (variant, delay_ms), same in reaches.items():
        if variant.name == name:
            away_cm = 100 * same[0].away_m
            lines.append(Line(same[0].step_s * np.arange(len(away_cm)), away_cm, f"{delay_ms:g} ms"))
    x = Quantity("time_s", "Time since onset", "s")
    y = Quantity("away_cm", "Hand from target", "cm")
    return Plot(x, y, tuple(lines), title=f"One reach, {name}")


def ataxia_text(reaches: Reaches, most_s: float) -> str:
    """Return the part of the report on these reaches."""
    base = {delay_ms: same for (variant, delay_ms), same in reaches.items() if variant == VARIANTS[0]}
    shortest, *_, longest = (_medians(same) for same in base.values())
    variants = {variant.name: variant for variant, _ in reaches}
    return page_text(
        "ataxia",
        count=len(base[DELAYS_MS[0]]),
        age=AGE_MONTHS,
        most_s=most_s,
        share=REACH_SHARE,
        longest_ms=DELAYS_MS[-1],
        table=table_rows(
            (name, *(_cell(reaches[variant, delay_ms]) for delay_ms in DELAYS_MS)) for name, variant in variants.items()
        ),
        least_units=shortest["movement_units"],
        units=longest["movement_units"],
        ratio=longest["path_ratio"],
        motor_ms=MOTOR_MS,
        products=_products(DELAYS_MS[-1]),
        middle_ms=DELAYS_MS[1],
        middle_products=_products(DELAYS_MS[1]),
    )


def _products(delay_ms: float) -> str:
    late_s = ms_to_s(delay_ms + MOTOR_MS)
    hands = [(name, gains.hands) for name, gains in GAIN_SETS.items()]
    return ", ".join(f"{gain.strength / gain.viscosity_per_s * late_s:.2g} ({name})" for name, gain in hands[::-1])


def _cell(same: Sequence[Reach]) -> str:
    medians = _medians(same)
    arrived = np.mean([reach.arrived for reach in same])
    return (
        f"{arrived:.0%}, {medians['duration_s']:.2f} s, {medians['movement_units']:g} units, "
        f"{medians['path_ratio']:.2g} x"
    )


def _medians(same: Sequence[Reach]) -> dict[str, float]:
    return {name: float(np.median([MEASURES[name](reach) for reach in same])) for name in ATAXIC}


OWN = "physiological"  # The delays of the infant's age.
DELAYS: Mapping[str, Mapping[str, Any]] = {
    "none": {},
    OWN: {"preset": OWN},
    "100 ms": {"preset": OWN, "sensory_ms": 100.0},
    "200 ms": {"preset": OWN, "sensory_ms": 200.0},
}
"""By name, as in a spec; the longer ones are those of the senses, with the commands' own of the age."""
NOISE: Mapping[str, Any] = {"motor": "maturing", "proprioception_deg": 1.0}
JITTER_MS = 5.0  # Noise of all infants; jitter for those with delays. One degree and one physics step are guesses.


@dataclass(frozen=True, slots=True)
class Group:
    """The reaches of an infant of an age, with a delay."""

    age_months: float
    delay: str  # Key of `DELAYS`.
    sensory_ms: float  # Delay of proprioception of the arm.
    reaches: Sequence[Reach]

    def median(self, measure: Callable[[Reach], float]) -> float:
        """Return the median of a measure over all reaches, those that did not arrive included."""
        return float(np.nanmedian([measure(reach) for reach in self.reaches]))

    @property
    def arrived(self) -> float:
        """Fraction of the reaches that arrived."""
        return float(np.mean([reach.arrived for reach in self.reaches]))


def infant_of_age(age_months: float, delay: str) -> InfantSpec:
    """Return an infant that sits with its hip held, moves its right arm and has the noise of its age."""
    return child(
        "reaching",
        age_months,
        actuation={"regions": ["right_arm"], "locked": ["trunk", "neck"]},
        senses={"proprioception": {"include": ["velocity"]}},
        delays=dict(DELAYS[delay]),
        noise={**NOISE, **({"delay_jitter_ms": JITTER_MS} if DELAYS[delay] else {})},
        scene={"kind": "flat", "pose": "sitting", "held": ["hip"]},
    )


def reach_at_ages(months: Sequence[float], count: int, most_s: float, counted: Callable[[Group], Group]) -> list[Group]:
    """Let infants of some ages reach with each delay for the same targets; *counted* is called for each."""
    groups = []
    for age_months in months:
        for delay in DELAYS:
            generator = np.random.default_rng(SEED)
            with closing(InfantEnv(building.build(infant_of_age(age_months, delay)))) as env:
                reaches = [reach_once(env, seed, generator, most_s) for seed in range(count)]
                sensory_ms = env.manifest.delays.proprioception.ms
            groups.append(counted(Group(age_months, delay, sensory_ms, reaches)))
    return groups


def infants_table(groups: Sequence[Group]) -> Table:
    """Return the table of these reaches."""
    rows = (
        (
            group.age_months,
            group.delay,
            index,
            float(reach.arrived),
            reach.distance_m,
            *(measure(reach) for measure in MEASURES.values()),
        )
        for group in groups
        for index, reach in enumerate(group.reaches)
    )
    heading = ",".join(("age_months", "delay", "reach", "arrived", "distance_m", *MEASURES))
    return heading, rows


def infants_plots(groups: Sequence[Group]) -> list[Plot]:
    """Return plots of one reach, and of movement units and straightness by age."""
    onset = Quantity("time_s", "Time since onset", "s")
    speed = Quantity("speed_m_s", "Speed of the hand", "m/s")
    units = Quantity("movement_units", "Movement units")
    ratio = Quantity("path_ratio", "Path length / distance")
    return [
        Plot(onset, speed, tuple(_speeds(groups)), title="One reach"),
        Plot(AGE, units, tuple(_by_age(groups, "movement_units")), title="Movement units"),
        Plot(AGE, ratio, tuple(_by_age(groups, "path_ratio")), title="Straightness"),
    ]


def by_delay(groups: Sequence[Group]) -> dict[str, list[Group]]:
    """Return the groups of each delay, by age."""
    return {delay: [group for group in groups if group.delay == delay] for delay in DELAYS}


def _speeds(groups: Sequence[Group]) -> Iterator[Line]:
    for group in groups:
        if group.age_months == groups[0].age_months:
            durations_s = [reach.duration_s for reach in group.reaches]
            reach = group.reaches[int(np.argsort(durations_s)[len(durations_s) // 2])]
            yield Line(reach.step_s * np.arange(len(reach.speed_m_s)), reach.speed_m_s, group.delay)


def _by_age(groups: Sequence[Group], measure: str) -> Iterator[Line]:
    for delay, same in by_delay(groups).items():
        medians = [group.median(MEASURES[measure]) for group in same]
        yield Line([group.age_months for group in same], medians, delay, "marked")


MIN_S = 0.4  # What reaches of infants last at least.
SMOOTHER = {"movement_units": -1, "path_ratio": -1, "spectral_arc_length": 1, "log_dimensionless_jerk": 1}
"""Measures of smoothness, and whether smoother movements have more (1) or less (-1) of them."""


def infants_text(groups: Sequence[Group], most_s: float) -> str:
    """Return the part of the report on infants, the youngest first, by delays in the order of `DELAYS`."""
    of_age = by_delay(groups)[OWN]
    ages = [group.age_months for group in of_age]
    *younger, oldest = (f"{age:g}" for age in ages)
    hands, measures = GAIN_SETS[GAINS].hands, MEASURES.values()
    return page_text(
        "infant_reaches",
        count=len(groups[0].reaches),
        ages=f"{', '.join(younger)} and {oldest}" if younger else oldest,
        own=_range([group.sensory_ms for group in of_age]),
        motor=_range([round(motor_share(age), 2) for age in ages]),
        deg=NOISE["proprioception_deg"],
        jitter=JITTER_MS,
        hands=hands,
        cap_cm=100 * hands.cap,
        most=hands.strength * hands.cap / hands.viscosity_per_s,
        unit_cm=100 * UNIT_M_S,
        share=REACH_SHARE,
        touched_cm=100 * TOUCHED_M,
        most_s=most_s,
        youngest=ages[0],
        oldest=ages[-1],
        table=table_rows(
            (f"{it.age_months:g}", it.delay, f"{it.arrived:.0%}", *(f"{it.median(one):.3g}" for one in measures))
            for it in groups
        ),
        smoothness="\n".join(_smoothness(name, groups) for name in SMOOTHER),
        **_of_own_delays(of_age),
    )


def _of_own_delays(of_age: Sequence[Group]) -> dict[str, object]:
    """Return how long reaches last with the delays of each age, and how much smoother the oldest infant's are."""
    medians_s = [group.median(MEASURES["duration_s"]) for group in of_age]
    youngest, oldest = ([reach.arc_length for reach in group.reaches] for group in (of_age[0], of_age[-1]))
    gains = np.subtract(oldest, youngest)
    return {
        "lasting_s": _range([round(median_s, 2) for median_s in medians_s]),
        "shortest_s": min(reach.duration_s for group in of_age for reach in group.reaches),
        "units": _range([group.median(MEASURES["movement_units"]) for group in of_age]),
        "least_s": MIN_S,
        "long_enough": yes(min(medians_s) >= MIN_S),
        "gain": gains.mean(),
        "error": gains.std() / np.sqrt(len(gains)),
    }


def _smoothness(name: str, groups: Sequence[Group]) -> str:
    smooth = {(group.age_months, group.delay): SMOOTHER[name] * group.median(MEASURES[name]) for group in groups}
    ages = sorted({age_months for age_months, _ in smooth})
    pairs = [(smooth[age, less], smooth[age, more]) for age in ages for less, more in pairwise(DELAYS)]
    falls = sum(more <= less for less, more in pairs)
    by_age = ", ".join(f"{SMOOTHER[name] * smooth[age, OWN]:.3g}" for age in ages)
    rises = yes(smooth[ages[-1], OWN] > smooth[ages[0], OWN])
    return (
        f"- By {name.replace('_', ' ')}, movements are less smooth with the longer delay in {falls} of {len(pairs)} "
        f"pairs of successive delays; with the delays of their age, the oldest infant's are smoother than the "
        f"youngest's ({by_age}): {rises}."
    )


def _range(values: Sequence[float]) -> str:
    low, high = min(values), max(values)
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"
