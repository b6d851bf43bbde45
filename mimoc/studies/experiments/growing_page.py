"""The report on learning while growing."""

from collections.abc import Mapping, Sequence
from math import comb
from statistics import fmean

from mimoc.runtime.growth_schedule import COURSES, STAGE_MONTHS
from mimoc.studies.experiments.growing_learner import GrowingLearner
from mimoc.studies.experiments.learner import mean_and_range
from mimoc.studies.experiments.notebook import markdown_table, page_texts
from mimoc.training import Episode

Groups = Mapping[str, Sequence[GrowingLearner]]
"""Trained infants by schedule of growth."""

TEXTS = page_texts("growing")

MEASURES = {
    "time to touch after training": GrowingLearner.time_s,
    "time to touch over all checkpoints": GrowingLearner.time_over_checkpoints_s,
}
"""What is compared; less is better."""
BETTER, WORSE, SAME = "better", "worse", "not distinguishable"


def sections(
    groups: Groups, untrained: Sequence[Episode], ages_months: tuple[float, float], **numbers: int
) -> tuple[str, ...]:
    """Return the sections of the report: method, results, and what they can show.

    Args:
        groups: The infants by schedule; `grown` and `adult` are among them.
        untrained: Reaches of a random policy for the same balls.
        ages_months: The youngest and the oldest age.
        numbers: Numbers of the experiment, by their names in the text.
    """
    youngest, oldest = ages_months
    stages = round((oldest - youngest) / STAGE_MONTHS) + 1
    known = {**numbers, "youngest": youngest, "oldest": oldest, "stages": stages, "stage": STAGE_MONTHS}
    known |= {"span": oldest - youngest, "jumps": stages - 1}
    schedules = "\n".join(f"- `{name}`: {meaning};" for name, meaning in COURSES.items()).removesuffix(";") + "."
    random = fmean(reach.success for reach in untrained)
    return (
        TEXTS["about"].format(schedules=schedules, **known),
        TEXTS["results"].format(table=_table(groups, untrained), verdict=_verdict(groups), **known),
        TEXTS["fair"].format(random=random, **known),
    )


def _table(groups: Groups, untrained: Sequence[Episode]) -> str:
    headings = ("schedule", "balls touched", "return", "time to touch [s]", "time to touch over all checkpoints [s]")
    rows = [
        (
            f"`{name}`",
            mean_and_range([learner.success_rate() for learner in group]),
            mean_and_range([learner.episode_return() for learner in group]),
            *(mean_and_range([measure(learner) for learner in group]) for measure in MEASURES.values()),
        )
        for name, group in groups.items()
    ]
    random = [fmean(getattr(reach, name) for reach in untrained) for name in ("success", "total_reward", "duration_s")]
    return markdown_table(headings, [*rows, ("random policy", *(f"{value:.3f}" for value in random), "-")])


def _verdict(groups: Groups) -> str:
    """Return as text how `grown` compares with each other schedule, and what follows."""
    others = [name for name in groups if name != "grown"]
    comparisons = {other: {name: _compared(groups, other, name) for name in MEASURES} for other in others}
    lines = "\n".join(
        f"- `grown` against `{other}`, {name}: {outcome}, {_change(groups, other, name):+.0%};"
        for other, outcomes in comparisons.items()
        for name, outcome in outcomes.items()
    )
    count = len(groups["grown"])
    chance = 2 / comb(2 * count, count)
    return (
        f"{BETTER.capitalize()} or {WORSE} is what has no overlap between the ranges of the {count} seeds of each; "
        f"everything else is {SAME}. If there were no difference at all, this would still happen in "
        f"{chance:.0%} of such comparisons.\n\n{lines.removesuffix(';')}.\n\n{_answer(comparisons['adult'])} "
        f"{_order({name: comparisons[name] for name in others if name != 'adult'})}"
    )


def _compared(groups: Groups, other: str, measure: str) -> str:
    """Return how `grown` compares with another schedule."""
    grown, others = _values(groups, "grown", measure), _values(groups, other, measure)
    if max(grown) < min(others):
        return BETTER
    return WORSE if min(grown) > max(others) else SAME


def _change(groups: Groups, other: str, measure: str) -> float:
    """Return by which share of the other's mean the mean of `grown` is greater."""
    return fmean(_values(groups, "grown", measure)) / fmean(_values(groups, other, measure)) - 1


def _values(groups: Groups, schedule: str, measure: str) -> list[float]:
    return [MEASURES[measure](learner) for learner in groups[schedule]]


def _answer(comparisons: Mapping[str, str]) -> str:
    """Return the answer to the question of the title, from the comparison with `adult`."""
    helped, harmed = ([name for name, outcome in comparisons.items() if outcome == which] for which in (BETTER, WORSE))
    if helped and harmed:
        return f"**Growing helped with {' and '.join(helped)}, and harmed {' and '.join(harmed)}.**"
    if helped:
        return f"**Growing helped here, with {' and '.join(helped)}.**"
    if harmed:
        return f"**Growing did not help here: {' and '.join(harmed)} got worse.**"
    return "**No effect of growing is shown here, for better or worse.**"


def _order(comparisons: Mapping[str, Mapping[str, str]]) -> str:
    """Return whether the order of the ages mattered, from the comparisons with the same ages in other orders."""
    ahead = [name for name, outcomes in comparisons.items() if set(outcomes.values()) == {BETTER}]
    if len(ahead) == len(comparisons):
        return "The natural order of ages was better than every other by both measures."
    if ahead:
        return f"The natural order of ages was better by both measures than `{'`, `'.join(ahead)}` only."
    return "That the natural order of ages is better than another is not shown by both measures."
