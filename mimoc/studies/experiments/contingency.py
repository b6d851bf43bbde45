"""A caregiver who smiles at kicks: whether infants whose kicks are answered kick more, and less before a still face."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from typing import Any

import numpy as np

from mimoc.base.quantities import Quantity
from mimoc.bundle.io import Bundle
from mimoc.compiler import pipeline
from mimoc.render.plots.plot import Band, Line, Plot
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.sense import FloatArray
from mimoc.studies.comparison import band_of_seeds
from mimoc.studies.experiment import Experiment, Results, Table, TrialResult, child, measures_table
from mimoc.studies.experiments.gain_learner import (
    PAGE_NUMBERS,
    WINDOW_S,
    GainLearner,
    Phases,
    differences,
    direction_rows,
    rates_per_min,
)
from mimoc.studies.experiments.legs import LIMBS, Mover
from mimoc.studies.notebook import PAGES, Notebook, table_rows

AGE_MONTHS = 3.0
PHASES_S: Mapping[str, float] = {"baseline": 60.0, "interaction": 180.0, "still_face": 60.0, "reunion": 60.0}
QUICK_PHASES_S: Mapping[str, float] = {"baseline": 20.0, "interaction": 40.0, "still_face": 20.0, "reunion": 20.0}
COMPARED_S = 60.0  # The end of a phase, by which it is judged.
BIN_S = 20.0  # Width of the bins of curves.
AROUSAL = 0.9  # That of the infant under a mobile, of the experiment `mobile`.
DELAY_MS, PAUSE_MS = 400.0, 1500.0
"""From a kick to the answer, and from then to the next: as long as a smile lasts; assumptions."""
PARTNER = 1000  # Added to the seed of the infant that is answered as another one was.
ATTENTION = 0.001
"""Reward of a face that looks and does not smile, so that less than a smile is learnt from, too; a guess."""
CONDITIONS = ("contingent", "yoked")
LEGS = [index for index, limb in enumerate(LIMBS) if not limb.endswith("arm")]
MINUTES = Quantity("minute", "Time", "min")
RATE_PER_MIN = Quantity("rate_per_min", "Kicks", "1/min")
GAIN = Quantity("gain", "Learnt gain of the drive")


@dataclass(frozen=True, slots=True)
class Session:
    """What an infant did by a caregiver."""

    kicks_s: FloatArray  # When its legs kicked.
    answers_s: tuple[float, ...]  # When it was answered.
    gains: FloatArray  # Gain of each limb that it had learnt after each window, shape (windows, 6).


def bundle_of(case: Phases, yoked_s: Sequence[float]) -> Bundle:
    """Return an infant on its back with a caregiver, who answers kicks, or at some times whatever it does."""
    phases = ("still_face", "interact", "still_face", "interact")
    script = [{"at_s": at_s, "do": do} for at_s, do in zip((0.0, *case.ends_s), phases, strict=False)]
    answers: dict[str, Any] = {"to": "kick", "by": ["smile", "speak"], "delay_ms": DELAY_MS, "pause_ms": PAUSE_MS}
    if yoked_s:
        answers["yoked_s"] = list(yoked_s)
    scene = {"kind": "flat", "pose": "supine", "caregiver": {"script": script, "answers": answers}}
    return pipeline.build(child("contingency", AGE_MONTHS, actuation={"model": "muscle"}, scene=scene))


def pair(case: Phases, seed: int) -> TrialResult:
    """Let an infant be answered when it kicks, and another when the first one was."""
    contingent = session(case, seed, ())
    yoked = session(case, seed + PARTNER, contingent.answers_s or (case.ends_s[0],))
    values, traces = dict[str, float](), dict[str, tuple[float, ...]]()
    for name, infant in zip(CONDITIONS, (contingent, yoked), strict=True):
        values |= {f"{name}_{measure}": value for measure, value in _measures(case, infant).items()}
        traces[f"{name}_rate"] = rates_per_min(infant.kicks_s, case.ends_s[-1], BIN_S)
        gains = np.exp(np.log(infant.gains[:, LEGS]).mean(axis=1))
        traces[f"{name}_gain"] = tuple(gains.tolist())
    return TrialResult(values=values, traces=traces)


def session(case: Phases, seed: int, yoked_s: Sequence[float]) -> Session:
    """Return what an infant does by a caregiver, who answers its kicks, or at some times whatever it does."""
    with closing(InfantEnv(bundle_of(case, yoked_s))) as env:
        mover, learner, gains = Mover(env, seed), GainLearner(), list[FloatArray]()
        env.set_arousal(AROUSAL)
        for window in range(round(case.ends_s[-1] / WINDOW_S)):
            mover.set_gains(learner.gains, rates=True)
            smiling = [env.caregiver.expression == "happy" for _ in mover.steps(WINDOW_S)]
            phase = int(np.searchsorted(case.ends_s, (window + 1) * WINDOW_S))
            is_attentive = tuple(PHASES_S)[phase] in ("interaction", "reunion")
            learner.feel(ATTENTION + float(np.mean(smiling)) if is_attentive else 0.0, mover.take_movement())
            gains.append(learner.gains)
        timestep_s = env.model.opt.timestep
        kicks_s = np.array(env.caregiver.noticed) * timestep_s
        answers_s = tuple(round(step * timestep_s, 3) for step in env.caregiver.answered)
    return Session(kicks_s, answers_s, np.array(gains))


def _measures(case: Phases, infant: Session) -> dict[str, float]:
    """Return rates at the end of each phase, and the gain of the legs at the end of the interaction."""
    counts = zip(PHASES_S, case.counts(infant.kicks_s), strict=True)
    values = {phase: 60.0 * count / case.compared_s for phase, count in counts}
    gains = infant.gains[round(case.ends_s[1] / WINDOW_S) - 1]
    arms = [index for index in range(len(LIMBS)) if index not in LEGS]
    for name, limbs in (("leg_gain", LEGS), ("arm_gain", arms)):
        values[name] = float(np.exp(np.log(gains[limbs]).mean()))
    return {**values, "answers": float(len(infant.answers_s))}


def cases(notebook: Notebook) -> list[Phases]:
    """Return the only case."""
    return [Phases(tuple((QUICK_PHASES_S if notebook.quick else PHASES_S).values()), COMPARED_S)]


MORE, BEYOND = "kicks rise from baseline to interaction", "more kicks than of the yoked partner"
LARGER = "a larger gain of the legs than the partner's"
ASKED = {  # In how many pairs the first measure is larger.
    MORE: ("contingent_interaction", "contingent_baseline"),
    BEYOND: ("contingent_interaction", "yoked_interaction"),
    LARGER: ("contingent_leg_gain", "yoked_leg_gain"),
    "a larger gain of the legs than of the arms": ("contingent_leg_gain", "contingent_arm_gain"),
    "fewer kicks before the still face": ("contingent_interaction", "contingent_still_face"),
    "more kicks again in the reunion": ("contingent_reunion", "contingent_still_face"),
}
DIGITS = {**dict.fromkeys(PHASES_S, 1), "leg_gain": 2, "arm_gain": 2, "answers": 2}  # Of means, by measure.


def _time_table(results: Results) -> Table:
    (pairs,) = results.by_case.values()
    return "condition,seed,time_s,rate_per_min", (
        (condition, seed, slot * BIN_S, rate)
        for seed, result in zip(results.seeds, pairs, strict=True)
        for condition in CONDITIONS
        for slot, rate in enumerate(result.traces[f"{condition}_rate"])
    )


def _numbers(results: Results) -> dict[str, object]:
    (case,) = results.by_case
    return {
        "age": AGE_MONTHS,
        **{f"{name}_s": seconds for name, seconds in zip(PHASES_S, case.lengths_s, strict=True)},
        "compared": case.compared_s,
        "delay": DELAY_MS,
        "pause": PAUSE_MS,
        "attention": ATTENTION,
        "arousal": AROUSAL,
        **PAGE_NUMBERS,
        "table": table_rows(
            (name, *(results.mean(case, f"{name}_{column}").text(count) for column, count in DIGITS.items()))
            for name in CONDITIONS
        ),
        "answer": _answer(results, case),
        "predictions": direction_rows(results, case, ASKED),
    }


def _answer(results: Results, case: Phases) -> str:
    counts = {name: sum(one > 0 for one in differences(results, case, *ASKED[name])) for name in (MORE, BEYOND, LARGER)}
    risen, more, larger = counts.values()
    gains = [np.mean(results.values(case, f"{name}_leg_gain")) for name in CONDITIONS]
    pairs = len(results.seeds)
    return (
        f"Infants whose kicks are answered learn to drive their legs by a factor of {gains[0]:.2f}, those that are "
        f"answered likewise whatever they do by {gains[1]:.2f}; the gain of the former is larger in {larger} of "
        f"{pairs} pairs. Kicks are counted within a minute, and come in bouts: {risen} of {pairs} kick "
        f"more in the interaction than before, and {more} more than their partners."
    )


def _plots(results: Results) -> Iterator[Plot]:
    ((case, pairs),) = results.by_case.items()
    ends_min = [end_s / 60.0 for end_s in case.ends_s]
    for name, quantity, width_s in (("rate", RATE_PER_MIN, BIN_S), ("gain", GAIN, WINDOW_S)):
        curves = {condition: np.array([r.traces[f"{condition}_{name}"] for r in pairs]) for condition in CONDITIONS}
        minutes = (np.arange(curves["contingent"].shape[1], dtype=np.float64) + 0.5) * width_s / 60.0
        top = 1.15 * max(float(curve.mean(axis=0).max()) for curve in curves.values()) + 0.1
        bands = [
            Band(ends_min[first : first + 2], [0.0] * 2, [top] * 2, label, "usual")
            for first, label in ((0, "interaction"), (2, "reunion"))
        ]
        bands += [band_of_seeds(minutes, curve, condition) for condition, curve in curves.items()]
        lines = tuple(Line(minutes, curve.mean(axis=0), condition) for condition, curve in curves.items())
        yield Plot(MINUTES, quantity, lines, tuple(bands), y_range=(0.0, top))


EXPERIMENT = Experiment(
    name="contingency",
    trial=pair,
    cases=cases,
    seeds=range(6),
    quick={"seeds": range(2)},
    files={
        "time.csv": _time_table,
        "contingency.csv": measures_table(),
        "contingency.png": _plots,
    },
    page=PAGES / "contingency.md",
    numbers=_numbers,
    libraries=("scipy",),
    infants=lambda law: [bundle_of(Phases(tuple(QUICK_PHASES_S.values()), COMPARED_S), ())],
)
