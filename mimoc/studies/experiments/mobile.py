"""A ribbon from a foot to a mobile: whether infants who see it move kick more, and with which leg."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from itertools import islice, repeat

import numpy as np

from mimoc.base.quantities import Quantity
from mimoc.motion.labels import SIDES
from mimoc.movement.filming import RATE_HZ, SETTLING_S, Film, Filmed
from mimoc.movement.joints import joint_angles
from mimoc.movement.measures import correlation, kicks_of, leg_lengths, trunk_paths
from mimoc.render.plots.plot import Band, Line, Plot
from mimoc.runtime.sense import FloatArray
from mimoc.studies.comparison import band_of_seeds, interval
from mimoc.studies.experiment import Experiment, Results, Table, TrialResult, measures_table
from mimoc.studies.experiments.gain_learner import (
    PAGE_NUMBERS,
    WINDOW_S,
    GainLearner,
    Phases,
    direction_rows,
    rates_per_min,
)
from mimoc.studies.experiments.legs import (
    LIMBS,
    Mover,
    Setup,
    bundle_of,
    mobile_speed_m_s,
    open_infant,
    ribbon_m,
    tie_ribbon,
)
from mimoc.studies.notebook import PAGES, Notebook, table_rows

AGE_MONTHS = 3.0
PHASES_S: Mapping[str, float] = {"baseline": 180.0, "acquisition": 360.0, "extinction": 180.0}
QUICK_PHASES_S: Mapping[str, float] = {"baseline": 30.0, "acquisition": 60.0, "extinction": 30.0}
COMPARED_S = 180.0  # The end of a phase, by which it is judged.
BIN_S = 30.0  # Width of the bins of curves.
TYING_S = 10.0  # Time that the infant moves before the ribbon is tied: straight half of that time.
AROUSAL = 0.9
"""Of an infant that lies under a mobile: fitted, so that it kicks about 10 times a minute before, as published."""
PARTNER = 1000  # Added to the seed of the infant that sees what another one did.
ENOUGH = 1.5  # Ratio of the rate of kicks that is asked for.
CONDITIONS = ("contingent", "yoked")
LEGS = {"left": "tied leg", "right": "other leg"}
FREE = ("contingent_right", "yoked_left", "yoked_right")  # Legs that move nothing that is seen.
MINUTES = Quantity("minute", "Time", "min")
RATE_PER_MIN = Quantity("rate_per_min", "Kicks", "1/min")
GAIN = Quantity("gain", "Learnt gain of the drive")


@dataclass(frozen=True, slots=True)
class Session:
    """What an infant did under a mobile."""

    film: Filmed
    rewards_m_s: Sequence[float]  # Mean speed of the mobile that it was tied to in each window, seen or not.
    gains: FloatArray  # Gain of each limb that it had learnt after each window, shape (windows, 6).

    @property
    def kicks_s(self) -> dict[str, FloatArray]:
        """When each leg kicked, by side."""
        lengths = leg_lengths(trunk_paths(self.film.seen))
        peaks = ([kick.peak / RATE_HZ for kick in kicks_of(length, RATE_HZ)] for length in lengths)
        return {side: np.array(times_s) for side, times_s in zip(SIDES, peaks, strict=True)}


def pair(case: Phases, seed: int) -> TrialResult:
    """Let an infant learn under a mobile that its left leg moves, and another under a mobile that moves likewise."""
    contingent = session(case, seed, None)
    yoked = session(case, seed + PARTNER, contingent.rewards_m_s)
    values, traces = dict[str, float](), dict[str, tuple[float, ...]]()
    for name, infant in zip(CONDITIONS, (contingent, yoked), strict=True):
        values |= {f"{name}_{measure}": value for measure, value in _measures(case, infant).items()}
        for side in SIDES:
            traces[f"{name}_{side}"] = rates_per_min(infant.kicks_s[side], case.ends_s[-1], BIN_S)
        traces |= {f"{name}_{limb}": tuple(infant.gains[:, slot].tolist()) for slot, limb in enumerate(LIMBS)}
    return TrialResult(values=values, traces=traces)


def session(case: Phases, seed: int, others_m_s: Sequence[float] | None) -> Session:
    """Return what an infant does under a mobile that it sees during acquisition only.

    Its leg is tied to a mobile all the time, so that the ribbon pulls alike in all phases. What it sees moves in each
    window as fast as *others_m_s* say, or, without them, as its own.
    """
    seen_from, seen_to, windows = (round(end_s / WINDOW_S) for end_s in case.ends_s)
    with closing(open_infant(Setup(AGE_MONTHS, tied="left"))) as env:
        mover, learner = Mover(env, seed), GainLearner()
        env.set_arousal(AROUSAL)
        tie_ribbon(env, float(np.median([ribbon_m(env) for _ in mover.steps(TYING_S)])))
        film, rewards_m_s, gains = Film(), [], []
        for _ in mover.steps(SETTLING_S):
            film.watch(env)
        shown = repeat(None) if others_m_s is None else iter(others_m_s)
        for window, other_m_s in enumerate(islice(shown, windows)):
            mover.set_gains(learner.gains, rates=True)
            speeds_m_s = []
            for _ in mover.steps(WINDOW_S):
                film.watch(mover.env)
                speeds_m_s.append(mobile_speed_m_s(mover.env))
            reward_m_s = float(np.mean(speeds_m_s))
            rewards_m_s.append(reward_m_s)
            seen_m_s = reward_m_s if other_m_s is None else other_m_s
            learner.feel(seen_m_s if seen_from <= window < seen_to else 0.0, mover.take_movement())
            gains.append(learner.gains)
    return Session(film.develop(f"seed {seed}"), rewards_m_s, np.array(gains))


def _measures(case: Phases, infant: Session) -> dict[str, float]:
    """Return rates at the end of each phase, ratios to the baseline, gains learnt, and the coupling of the tied leg."""
    last_s, values = case.compared_s, dict[str, float]()
    learnt = slice(round((case.ends_s[1] - last_s) / WINDOW_S), round(case.ends_s[1] / WINDOW_S))
    for side, times_s in infant.kicks_s.items():
        counts = case.counts(times_s)
        values |= {f"{side}_{phase}": 60.0 * count / last_s for phase, count in zip(PHASES_S, counts, strict=True)}
        before = max(counts[0], 1)  # One kick at least: a ratio needs some.
        values |= {f"{side}_ratio": counts[1] / before, f"{side}_after": counts[2] / before}
        gains = infant.gains[learnt][:, [LIMBS.index(f"{side}_hip"), LIMBS.index(f"{side}_knee")]]
        values[f"{side}_gain"] = float(np.exp(np.log(gains).mean()))
    angles_deg = joint_angles(infant.film.space or infant.film.seen)
    for phase, end_s in zip(PHASES_S, case.ends_s, strict=True):
        part = slice(round((end_s - last_s) * RATE_HZ), round(end_s * RATE_HZ))
        values[f"hip_knee_{phase}"] = correlation(angles_deg["left_hip"][part], angles_deg["left_knee"][part])
    return values


def cases(notebook: Notebook) -> list[Phases]:
    """Return the only case."""
    return [Phases(tuple((QUICK_PHASES_S if notebook.quick else PHASES_S).values()), COMPARED_S)]


TIED, GAINED = "contingent_left_ratio", "contingent_left_gain"
ASKED = {  # In how many pairs the first measure is larger.
    "more than the yoked partner": (TIED, "yoked_left_ratio"),
    "the tied leg more than the other": (TIED, "contingent_right_ratio"),
    "a gain of the tied leg above the partner's": (GAINED, "yoked_left_gain"),
    "fewer kicks again in extinction": ("contingent_left_acquisition", "contingent_left_extinction"),
    "hip and knee of the tied leg looser": ("contingent_hip_knee_baseline", "contingent_hip_knee_acquisition"),
}


def _time_table(results: Results) -> Table:
    (pairs,) = results.by_case.values()
    return "condition,leg,seed,time_s,rate_per_min", (
        (condition, label, seed, slot * BIN_S, rate)
        for seed, result in zip(results.seeds, pairs, strict=True)
        for condition in CONDITIONS
        for side, label in LEGS.items()
        for slot, rate in enumerate(result.traces[f"{condition}_{side}"])
    )


def _numbers(results: Results) -> dict[str, object]:
    (case,) = results.by_case
    lengths_s = dict(zip(PHASES_S, case.lengths_s, strict=True))
    rows = []
    for condition in CONDITIONS:
        for side, label in LEGS.items():
            rates = [results.mean(case, f"{condition}_{side}_{phase}").text(1) for phase in PHASES_S]
            ratios = results.values(case, f"{condition}_{side}_ratio")
            enough = sum(ratio >= ENOUGH for ratio in ratios)
            ratio = f"{interval(ratios).text()}, median {np.median(ratios):.2f}"
            gain = results.mean(case, f"{condition}_{side}_gain").text()
            rows.append((condition, label, *rates, ratio, f"{enough} of {len(ratios)}", gain))
    return {
        "age": AGE_MONTHS,
        **{f"{name}_min": seconds / 60.0 for name, seconds in lengths_s.items()},
        "compared": case.compared_s / 60.0,
        "arousal": AROUSAL,
        **PAGE_NUMBERS,
        "limbs": ", ".join(name.replace("_", " ") for name in LIMBS),
        "table": table_rows(rows),
        "answer": _answer(results, case),
        "predictions": direction_rows(results, case, ASKED),
    }


def _answer(results: Results, case: Phases) -> str:
    contingent, yoked = (
        [ratio >= ENOUGH for ratio in results.values(case, f"{name}_left_ratio")] for name in CONDITIONS
    )
    asked = 8 / 12
    learnt = "do" if np.mean(contingent) >= asked else "do **not**"
    overall = dict[str, float]()
    for name in CONDITIONS:
        after, before = (np.mean(results.values(case, f"{name}_left_{phase}")) for phase in ("acquisition", "baseline"))
        overall[name] = float(after / max(before, 1e-9))
    counts = [f"{sum(group)} of {len(group)}" for group in (contingent, yoked)]
    free = [ratio >= ENOUGH for leg in FREE for ratio in results.values(case, f"{leg}_ratio")]
    return (
        f"Infants whose kicks move the mobile {learnt} kick {ENOUGH:g} times as often with the tied leg in two of 3 "
        f"seeds ({counts[0]}); of those who see another's, {counts[1]} do. Over all seeds, the rate of the tied leg "
        f"rises by a factor of {overall['contingent']:.2f} and {overall['yoked']:.2f}. Of all legs that move nothing "
        f"that is seen, {sum(free)} of {len(free)} do by chance: kicks come in bouts, and few are counted before."
    )


def _plots(results: Results) -> Iterator[Plot]:
    ((case, pairs),) = results.by_case.items()
    bins = len(pairs[0].traces["contingent_left"])
    minutes = (np.arange(bins, dtype=np.float64) + 0.5) * BIN_S / 60.0
    seen = [end_s / 60.0 for end_s in case.ends_s[:2]]
    for condition in CONDITIONS:
        curves = {label: np.array([r.traces[f"{condition}_{side}"] for r in pairs]) for side, label in LEGS.items()}
        top = 1.1 * max(float(curve.mean(axis=0).max()) for curve in curves.values()) + 5.0
        seen_bands = (band_of_seeds(minutes, curve, label) for label, curve in curves.items())
        bands = (Band(seen, [0.0] * 2, [top] * 2, "mobile seen", "usual"), *seen_bands)
        lines = tuple(Line(minutes, curve.mean(axis=0), label) for label, curve in curves.items())
        yield Plot(MINUTES, RATE_PER_MIN, lines, bands, title=condition.capitalize(), y_range=(0.0, top))
    windows = (np.arange(len(pairs[0].traces[f"contingent_{LIMBS[0]}"])) + 1) * WINDOW_S / 60.0
    means = {limb: np.mean([r.traces[f"contingent_{limb}"] for r in pairs], axis=0) for limb in LIMBS}
    lines = tuple(Line(windows, gains, limb.replace("_", " ")) for limb, gains in means.items())
    yield Plot(MINUTES, GAIN, lines, title="Learnt, contingent")


EXPERIMENT = Experiment(
    name="mobile",
    trial=pair,
    cases=cases,
    seeds=range(20),
    quick={"seeds": range(2)},
    files={
        "time.csv": _time_table,
        "mobile.csv": measures_table(),
        "mobile.png": _plots,
    },
    page=PAGES / "mobile.md",
    numbers=_numbers,
    libraries=("scipy",),
    infants=lambda law: [bundle_of(Setup(AGE_MONTHS))],
)
