"""Infants that do more of what makes the world move: of a mobile tied to a foot, or a caregiver who smiles at kicks."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from itertools import islice, repeat
from typing import Any

import numpy as np

from mimoc.base.quantities import Quantity
from mimoc.bundle.io import Bundle
from mimoc.compiler import building
from mimoc.motion.labels import SIDES
from mimoc.movement.filming import RATE_HZ, SETTLING_S, Film, Filmed
from mimoc.movement.measured import joint_angles
from mimoc.movement.measures import correlation, kicks_of, leg_lengths, trunk_paths
from mimoc.render.plots import Band, Line, Plot
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.sense import FloatArray
from mimoc.studies.comparison import band_of_seeds, interval, sign_test
from mimoc.studies.experiment import Experiment, Results, Table, TrialResult, child, measures_table
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
from mimoc.studies.notebook import PAGES, table_rows

WINDOW_S = 2.0  # Time over which reward and movement are averaged; a guess.
EXPECTED = len(LIMBS) ** -0.5
"""Standard deviation of what one limb may predict, before any experience: that all of them together predict all."""
FORGETTING_S = 300.0  # Time constant in which experience loses its worth; fitted.
EFFORT = 10.0  # Logarithm of the gain of a limb that predicts reward fully; fitted.
MAX_SD = 3.0  # Standard deviations beyond which nothing counts more.
EXPECTING_S = 60.0  # Time constant of the means and variances that are expected; a guess.
LARGEST = float(np.log(4.0))  # Largest logarithm of a gain; a guess.
SMALLEST_REWARD = 1e-4  # Reward below which nothing is seen to move, [m/s].


class Expected:
    """Running mean and variance of some numbers: the plain ones at first, later those of the last minute."""

    def __init__(self, size: int):
        self._mean = np.zeros(size)
        self._variance = np.zeros(size)
        self._count = 0

    def standardised(self, values: FloatArray) -> FloatArray:
        """Return how many standard deviations values are above what was expected, shape (n,), and expect them more."""
        self._count += 1
        share = max(WINDOW_S / EXPECTING_S, 1.0 / self._count)
        surprise = values - self._mean
        deviation = np.sqrt(self._variance)
        self._mean = self._mean + share * surprise
        self._variance = (1.0 - share) * (self._variance + share * surprise**2)
        return np.divide(surprise, deviation, out=np.zeros(len(values)), where=deviation > 0.0)


class GainLearner:
    """Learns how much each limb moves the world, and drives those that do with a gain.

    After each window, with z the standardised movement of each limb and R the standardised reward, it estimates the
    strengths b of R = b · z + noise by a Kalman filter (Dayan & Kakade 2001, *NIPS* 13: 451, whose b and their
    covariance P do what the associations of Rescorla & Wagner 1972 do, and know how sure they are). Between windows the
    world may change, k = exp(-window / forgetting):

        b <- k b,  P <- k² P + (1 - k²) I / 6;  g = P z / (z · P z + 1),  b <- b + g (R - b · z),  P <- P - g z · P

    The gain of a limb is exp(effort b |b|): b² is the share of the reward's variance that it alone explains. Limbs
    compete: one that only moves together with another that moves the world predicts nothing more. Where reward does not
    depend on what the infant does, b stays near 0, and its square nearer. Its own movement varies enough: no noise is
    added to explore.
    """

    def __init__(self):
        self.strengths = np.zeros(len(LIMBS))
        """How much the movement of each limb predicts reward, in standard deviations, shape (6,)."""
        self._covariance = EXPECTED**2 * np.eye(len(LIMBS))
        self._reward, self._movement = Expected(1), Expected(len(LIMBS))

    @property
    def gains(self) -> FloatArray:
        """The gain of each limb, shape (6,)."""
        return np.exp(np.clip(EFFORT * self.strengths * np.abs(self.strengths), -LARGEST, LARGEST))

    def feel(self, reward: float, movement: FloatArray) -> None:
        """Learn from a window that has just ended, in which what it sees moved by *reward*, [m/s].

        Of next to no reward nothing is learnt; the movement of each limb, shape (6,), can have any unit.
        """
        keep = np.exp(-WINDOW_S / FORGETTING_S)
        self.strengths = keep * self.strengths
        self._covariance = keep**2 * self._covariance + (1.0 - keep**2) * EXPECTED**2 * np.eye(len(LIMBS))
        moved = np.clip(self._movement.standardised(movement), -MAX_SD, MAX_SD)
        if reward < SMALLEST_REWARD:
            return
        surprise = np.clip(self._reward.standardised(np.array([reward])), -MAX_SD, MAX_SD)
        shared = self._covariance @ moved
        share = shared / (moved @ shared + 1.0)
        self.strengths = self.strengths + share * (surprise - self.strengths @ moved)
        self._covariance = self._covariance - np.outer(share, shared)


# Pairs of infants: what moves for the second one is what moved for the first one, whatever it does itself.

AGE_MONTHS = 3.0
AROUSAL = 0.9
"""Arousal of an infant that lies under a mobile: fitted, so that it kicks about 10 times a minute before, as
published."""
PARTNER = 1000  # Added to the seed of the second infant.
CONDITIONS = ("contingent", "yoked")
MINUTES = Quantity("minute", "Time", "min")
RATE_PER_MIN = Quantity("rate_per_min", "Kicks", "1/min")
GAIN = Quantity("gain", "Learnt gain of the drive")
PAGE_NUMBERS = {
    "age": AGE_MONTHS,
    "arousal": AROUSAL,
    "window": WINDOW_S,
    "largest": np.exp(LARGEST),
    "effort": EFFORT,
    "forgetting": FORGETTING_S,
}


@dataclass(frozen=True, slots=True)
class Phases:
    """The phases of a session."""

    lengths_s: tuple[float, ...]
    longest_s: float  # Most of the end of a phase by which it is judged.

    @property
    def ends_s(self) -> tuple[float, ...]:
        """When each phase ends."""
        return tuple(np.cumsum(self.lengths_s).tolist())

    @property
    def compared_s(self) -> float:
        """How much of the end of each phase is compared."""
        return min(self.longest_s, *self.lengths_s)

    def counts(self, times_s: FloatArray) -> list[int]:
        """Return how many of some times, shape (n,), are within the end of each phase that is compared."""
        return [int(((times_s >= end_s - self.compared_s) & (times_s < end_s)).sum()) for end_s in self.ends_s]


@dataclass(frozen=True, slots=True)
class Session:
    """What came of one infant of a pair, and what decides what its partner sees."""

    values: Mapping[str, float]
    traces: Mapping[str, tuple[float, ...]]
    handed_on: Sequence[float]


def paired(contingent: Session, yoked: Session) -> TrialResult:
    """Return the measures and curves of both infants of a pair, each with its condition in its name."""
    sessions = dict(zip(CONDITIONS, (contingent, yoked), strict=True))
    return TrialResult(
        values={f"{name}_{key}": value for name, one in sessions.items() for key, value in one.values.items()},
        traces={f"{name}_{key}": curve for name, one in sessions.items() for key, curve in one.traces.items()},
    )


def rates_per_min(times_s: FloatArray, seconds: float, bin_s: float) -> tuple[float, ...]:
    """Return how many of some times, shape (n,), there are a minute in each bin of a session."""
    counts, _ = np.histogram(times_s, np.arange(round(seconds / bin_s) + 1) * bin_s)
    return tuple((60.0 * counts / bin_s).tolist())


def mean_gain(gains: FloatArray) -> float:
    """Return the geometric mean of gains of any shape."""
    return float(np.exp(np.log(gains).mean()))


def differences(results: Results, larger: str, smaller: str) -> list[float]:
    """Return by how much one measure exceeds another in each pair."""
    (case,) = results.by_case
    return [a - b for a, b in zip(results.values(case, larger), results.values(case, smaller), strict=True)]


def direction_rows(results: Results, asked: Mapping[str, tuple[str, str]]) -> str:
    """Return rows of a table on measures that are predicted to exceed others: difference, number of pairs, and p."""
    rows = list[tuple[str, ...]]()
    for name, measures in asked.items():
        values = differences(results, *measures)
        holds = f"{sum(value > 0 for value in values)} of {len(values)}"
        rows.append((name, interval(values).text(), holds, f"{sign_test(values):.2g}"))
    return table_rows(rows)


def rates_table(heading: str, traces: Mapping[tuple[str, ...], str], bin_s: float) -> Callable[[Results], Table]:
    """Return the function for a table of kicks over time, given the curves by their cells below the heading."""

    def table(results: Results) -> Table:
        (pairs,) = results.by_case.values()
        return f"{heading},seed,time_s,rate_per_min", (
            (*cells, seed, slot * bin_s, rate)
            for seed, result in zip(results.seeds, pairs, strict=True)
            for cells, trace in traces.items()
            for slot, rate in enumerate(result.traces[trace])
        )

    return table


def curves_plot(
    quantity: Quantity,
    curves: Mapping[str, FloatArray],
    width_s: float,
    shown_s: Mapping[str, tuple[float, float]],
    room: tuple[float, float],
    title: str = "",
) -> Plot:
    """Return means over seeds of curves by bins, shape (seeds, bins) each, and the spans in which something is seen.

    There is *room* above them: a factor, and what is added.
    """
    minutes = (np.arange(next(iter(curves.values())).shape[1], dtype=np.float64) + 0.5) * width_s / 60.0
    top = room[0] * max(float(curve.mean(axis=0).max()) for curve in curves.values()) + room[1]
    spans = [
        Band([end_s / 60.0 for end_s in span_s], [0.0] * 2, [top] * 2, label, "usual")
        for label, span_s in shown_s.items()
    ]
    bands = (*spans, *(band_of_seeds(minutes, curve, label) for label, curve in curves.items()))
    lines = tuple(Line(minutes, curve.mean(axis=0), label) for label, curve in curves.items())
    return Plot(MINUTES, quantity, lines, bands, title=title, y_range=(0.0, top))


# A ribbon from a foot to a mobile: whether infants who see it move kick more, and with which leg.

TIED_PHASES = ("baseline", "acquisition", "extinction")
TIED_BIN_S = 30.0  # Width of the bins of curves.
TYING_S = 10.0  # Time that the infant moves before the ribbon is tied: straight half of that time.
ENOUGH = 1.5  # Ratio of the rate of kicks that is asked for.
LEGS = {"left": "tied leg", "right": "other leg"}
FREE = ("contingent_right", "yoked_left", "yoked_right")  # Legs that move nothing that is seen.
TIED, GAINED = "contingent_left_ratio", "contingent_left_gain"
TIED_ASKED = {  # In how many pairs the first measure is larger.
    "more than the yoked partner": (TIED, "yoked_left_ratio"),
    "the tied leg more than the other": (TIED, "contingent_right_ratio"),
    "a gain of the tied leg above the partner's": (GAINED, "yoked_left_gain"),
    "fewer kicks again in extinction": ("contingent_left_acquisition", "contingent_left_extinction"),
    "hip and knee of the tied leg looser": ("contingent_hip_knee_baseline", "contingent_hip_knee_acquisition"),
}


def tie_pair(case: Phases, seed: int) -> TrialResult:
    """Let an infant learn under a mobile that its left leg moves, and another under a mobile that moves likewise."""
    contingent = tied_session(case, seed, None)
    return paired(contingent, tied_session(case, seed + PARTNER, contingent.handed_on))


def tied_session(case: Phases, seed: int, others_m_s: Sequence[float] | None) -> Session:
    """Return what an infant does under a mobile that it sees during acquisition only; it hands on its mean speeds.

    Its leg is tied to a mobile all the time, so that the ribbon pulls alike in all phases. What it sees moves in each
    window as fast as *others_m_s* say, or, without them, as its own.
    """
    seen_from, seen_to, windows = (round(end_s / WINDOW_S) for end_s in case.ends_s)
    with closing(open_infant(Setup(AGE_MONTHS, tied="left"))) as env:
        mover, learner = Mover(env, seed), GainLearner()
        env.set_arousal(AROUSAL)
        tie_ribbon(env, float(np.median([ribbon_m(env) for _ in mover.steps(TYING_S)])))
        film = Film()
        rewards_m_s = list[float]()
        gains = list[FloatArray]()
        for _ in mover.steps(SETTLING_S):
            film.watch(env)
        shown = repeat(None) if others_m_s is None else iter(others_m_s)
        for window, other_m_s in enumerate(islice(shown, windows)):
            mover.set_gains(learner.gains, rates=True)
            speeds_m_s = []
            for _ in mover.steps(WINDOW_S):
                film.watch(mover.env)
                speeds_m_s.append(mobile_speed_m_s(mover.env))
            rewards_m_s.append(float(np.mean(speeds_m_s)))
            seen_m_s = rewards_m_s[-1] if other_m_s is None else other_m_s
            learner.feel(seen_m_s if seen_from <= window < seen_to else 0.0, mover.take_movement())
            gains.append(learner.gains)
    return _of_legs(case, film.to_recording(f"seed {seed}"), np.array(gains), rewards_m_s)


def _of_legs(case: Phases, film: Filmed, gains: FloatArray, rewards_m_s: Sequence[float]) -> Session:
    """Measure rates at the end of each phase, ratios to the baseline, gains learnt, and the coupling of the tied leg.

    Gains of each limb are those after each window, shape (windows, 6).
    """
    last_s = case.compared_s
    values = dict[str, float]()
    traces = dict[str, tuple[float, ...]]()
    learnt = slice(round((case.ends_s[1] - last_s) / WINDOW_S), round(case.ends_s[1] / WINDOW_S))
    for side, length in zip(SIDES, leg_lengths(trunk_paths(film.seen)), strict=True):
        times_s = np.array([kick.peak / RATE_HZ for kick in kicks_of(length, RATE_HZ)])
        counts = case.counts(times_s)
        values |= {f"{side}_{phase}": 60.0 * count / last_s for phase, count in zip(TIED_PHASES, counts, strict=True)}
        before = max(counts[0], 1)  # One kick at least: a ratio needs some.
        values |= {f"{side}_ratio": counts[1] / before, f"{side}_after": counts[2] / before}
        values[f"{side}_gain"] = mean_gain(
            gains[learnt][:, [LIMBS.index(f"{side}_{part}") for part in ("hip", "knee")]]
        )
        traces[side] = rates_per_min(times_s, case.ends_s[-1], TIED_BIN_S)
    angles_deg = joint_angles(film.space or film.seen)
    for phase, end_s in zip(TIED_PHASES, case.ends_s, strict=True):
        part = slice(round((end_s - last_s) * RATE_HZ), round(end_s * RATE_HZ))
        values[f"hip_knee_{phase}"] = correlation(angles_deg["left_hip"][part], angles_deg["left_knee"][part])
    traces |= {limb: tuple(gains[:, slot].tolist()) for slot, limb in enumerate(LIMBS)}
    return Session(values, traces, rewards_m_s)


def _tied_numbers(results: Results) -> dict[str, object]:
    (case,) = results.by_case
    rows = []
    for condition in CONDITIONS:
        for side, label in LEGS.items():
            rates = [results.mean(case, f"{condition}_{side}_{phase}").text(1) for phase in TIED_PHASES]
            ratios = results.values(case, f"{condition}_{side}_ratio")
            enough = sum(ratio >= ENOUGH for ratio in ratios)
            ratio = f"{interval(ratios).text()}, median {np.median(ratios):.2f}"
            gain = results.mean(case, f"{condition}_{side}_gain").text()
            rows.append((condition, label, *rates, ratio, f"{enough} of {len(ratios)}", gain))
    return {
        **PAGE_NUMBERS,
        **{f"{name}_min": seconds / 60.0 for name, seconds in zip(TIED_PHASES, case.lengths_s, strict=True)},
        "compared": case.compared_s / 60.0,
        "limbs": ", ".join(name.replace("_", " ") for name in LIMBS),
        "table": table_rows(rows),
        "answer": _tied_answer(results, case),
        "predictions": direction_rows(results, TIED_ASKED),
    }


def _tied_answer(results: Results, case: Phases) -> str:
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


def _tied_plots(results: Results) -> Iterator[Plot]:
    ((case, pairs),) = results.by_case.items()
    seen_s = {"mobile seen": case.ends_s[:2]}
    for condition in CONDITIONS:
        curves = {label: np.array([r.traces[f"{condition}_{side}"] for r in pairs]) for side, label in LEGS.items()}
        yield curves_plot(RATE_PER_MIN, curves, TIED_BIN_S, seen_s, (1.1, 5.0), condition.capitalize())
    means = {limb: np.mean([r.traces[f"contingent_{limb}"] for r in pairs], axis=0) for limb in LIMBS}
    minutes = (np.arange(len(means[LIMBS[0]])) + 1) * WINDOW_S / 60.0
    lines = tuple(Line(minutes, gains, limb.replace("_", " ")) for limb, gains in means.items())
    yield Plot(MINUTES, GAIN, lines, title="Learnt, contingent")


MOBILE = Experiment(
    name="mobile",
    trial=tie_pair,
    cases=[Phases((180.0, 360.0, 180.0), 180.0)],
    seeds=range(20),
    quick={"seeds": range(2), "cases": [Phases((30.0, 60.0, 30.0), 180.0)]},
    files={
        "time.csv": rates_table(
            "condition,leg",
            {(name, label): f"{name}_{side}" for name in CONDITIONS for side, label in LEGS.items()},
            TIED_BIN_S,
        ),
        "mobile.csv": measures_table(),
        "mobile.png": _tied_plots,
    },
    page=PAGES / "mobile.md",
    numbers=_tied_numbers,
    libraries=("scipy",),
    infants=lambda law: [bundle_of(Setup(AGE_MONTHS))],
)


# A caregiver who smiles at kicks: whether infants whose kicks are answered kick more, and less before a still face.

PHASES = ("baseline", "interaction", "still_face", "reunion")
QUICK_CASE = Phases((20.0, 40.0, 20.0, 20.0), 60.0)
BIN_S = 20.0  # Width of the bins of curves.
DELAY_MS, PAUSE_MS = 400.0, 1500.0
"""Time from a kick to the answer, and from then to the next: as long as a smile lasts; assumptions."""
ATTENTION = 0.001
"""Reward of a face that looks and does not smile, so that less than a smile is learnt from, too; a guess."""
LEG_LIMBS = [index for index, limb in enumerate(LIMBS) if not limb.endswith("arm")]
ARM_LIMBS = [index for index, limb in enumerate(LIMBS) if limb.endswith("arm")]
MORE = "kicks rise from baseline to interaction"
BEYOND = "more kicks than of the yoked partner"
LARGER = "a larger gain of the legs than the partner's"
ASKED = {  # In how many pairs the first measure is larger.
    MORE: ("contingent_interaction", "contingent_baseline"),
    BEYOND: ("contingent_interaction", "yoked_interaction"),
    LARGER: ("contingent_leg_gain", "yoked_leg_gain"),
    "a larger gain of the legs than of the arms": ("contingent_leg_gain", "contingent_arm_gain"),
    "fewer kicks before the still face": ("contingent_interaction", "contingent_still_face"),
    "more kicks again in the reunion": ("contingent_reunion", "contingent_still_face"),
}
DIGITS = {**dict.fromkeys(PHASES, 1), "leg_gain": 2, "arm_gain": 2, "answers": 2}  # Decimals of means, by measure.


def answered_infant(case: Phases, yoked_s: Sequence[float]) -> Bundle:
    """Return an infant on its back with a caregiver, who answers kicks, or at some times whatever it does."""
    phases = ("still_face", "interact", "still_face", "interact")
    script = [{"at_s": at_s, "do": do} for at_s, do in zip((0.0, *case.ends_s), phases, strict=False)]
    answers: dict[str, Any] = {"to": "kick", "by": ["smile", "speak"], "delay_ms": DELAY_MS, "pause_ms": PAUSE_MS}
    if yoked_s:
        answers["yoked_s"] = list(yoked_s)
    scene = {"kind": "flat", "pose": "supine", "caregiver": {"script": script, "answers": answers}}
    return building.build(child("contingency", AGE_MONTHS, actuation={"model": "muscle"}, scene=scene))


def answer_pair(case: Phases, seed: int) -> TrialResult:
    """Let an infant be answered when it kicks, and another when the first one was."""
    contingent = answered_session(case, seed, ())
    return paired(contingent, answered_session(case, seed + PARTNER, contingent.handed_on or (case.ends_s[0],)))


def answered_session(case: Phases, seed: int, yoked_s: Sequence[float]) -> Session:
    """Return what an infant does by a caregiver, who answers kicks, or at some times; it hands on when that was.

    Rates of kicks are those at the end of each phase, gains those at the end of the interaction.
    """
    with closing(InfantEnv(answered_infant(case, yoked_s))) as env:
        mover = Mover(env, seed)
        learner = GainLearner()
        after = list[FloatArray]()
        env.set_arousal(AROUSAL)
        for window in range(round(case.ends_s[-1] / WINDOW_S)):
            mover.set_gains(learner.gains, rates=True)
            smiling = [env.caregiver.expression == "happy" for _ in mover.steps(WINDOW_S)]
            phase = PHASES[int(np.searchsorted(case.ends_s, (window + 1) * WINDOW_S))]
            is_attentive = phase in ("interaction", "reunion")
            learner.feel(ATTENTION + float(np.mean(smiling)) if is_attentive else 0.0, mover.take_movement())
            after.append(learner.gains)
        timestep_s = env.model.opt.timestep
        kicks_s = np.array(env.caregiver.noticed) * timestep_s
        answers_s = [round(step * timestep_s, 3) for step in env.caregiver.answered]
    gains = np.array(after)
    learnt = gains[round(case.ends_s[1] / WINDOW_S) - 1]
    rates = {name: 60.0 * count / case.compared_s for name, count in zip(PHASES, case.counts(kicks_s), strict=True)}
    of_parts = {"leg_gain": mean_gain(learnt[LEG_LIMBS]), "arm_gain": mean_gain(learnt[ARM_LIMBS])}
    of_legs = np.exp(np.log(gains[:, LEG_LIMBS]).mean(axis=1))
    traces = {"rate": rates_per_min(kicks_s, case.ends_s[-1], BIN_S), "gain": tuple(of_legs.tolist())}
    return Session({**rates, **of_parts, "answers": float(len(answers_s))}, traces, answers_s)


def _numbers(results: Results) -> dict[str, object]:
    (case,) = results.by_case
    counts = {name: sum(one > 0 for one in differences(results, *ASKED[name])) for name in (MORE, BEYOND, LARGER)}
    risen, more, larger = counts.values()
    gains = [np.mean(results.values(case, f"{name}_leg_gain")) for name in CONDITIONS]
    pairs = len(results.seeds)
    return {
        **PAGE_NUMBERS,
        **{f"{name}_s": seconds for name, seconds in zip(PHASES, case.lengths_s, strict=True)},
        "compared": case.compared_s,
        "delay": DELAY_MS,
        "pause": PAUSE_MS,
        "attention": ATTENTION,
        "table": table_rows(
            (name, *(results.mean(case, f"{name}_{column}").text(count) for column, count in DIGITS.items()))
            for name in CONDITIONS
        ),
        "answer": (
            f"Infants whose kicks are answered learn to drive their legs by a factor of {gains[0]:.2f}, those that are "
            f"answered likewise whatever they do by {gains[1]:.2f}; the gain of the former is larger in {larger} of "
            f"{pairs} pairs. Kicks are counted within a minute, and come in bouts: {risen} of {pairs} kick "
            f"more in the interaction than before, and {more} more than their partners."
        ),
        "predictions": direction_rows(results, ASKED),
    }


def _plots(results: Results) -> Iterator[Plot]:
    ((case, pairs),) = results.by_case.items()
    met_s = {"interaction": case.ends_s[:2], "reunion": case.ends_s[2:4]}
    for name, quantity, width_s in (("rate", RATE_PER_MIN, BIN_S), ("gain", GAIN, WINDOW_S)):
        curves = {condition: np.array([r.traces[f"{condition}_{name}"] for r in pairs]) for condition in CONDITIONS}
        yield curves_plot(quantity, curves, width_s, met_s, (1.15, 0.1))


CONTINGENCY = Experiment(
    name="contingency",
    trial=answer_pair,
    cases=[Phases((60.0, 180.0, 60.0, 60.0), 60.0)],
    seeds=range(6),
    quick={"seeds": range(2), "cases": [QUICK_CASE]},
    files={
        "time.csv": rates_table("condition", {(name,): f"{name}_rate" for name in CONDITIONS}, BIN_S),
        "contingency.csv": measures_table(),
        "contingency.png": _plots,
    },
    page=PAGES / "contingency.md",
    numbers=_numbers,
    libraries=("scipy",),
    infants=lambda law: [answered_infant(QUICK_CASE, ())],
)
