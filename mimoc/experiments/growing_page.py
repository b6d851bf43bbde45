"""The report on learning while growing."""

from collections.abc import Mapping, Sequence
from math import comb
from statistics import fmean

from mimoc.experiments.growing_learner import GrowingLearner
from mimoc.experiments.notebook import markdown_table
from mimoc.runtime.growth_schedule import COURSES, STAGE_MONTHS
from mimoc.training import Episode

Groups = Mapping[str, Sequence[GrowingLearner]]
"""Trained infants by schedule of growth."""

ABOUT = """\
Children learn while they grow. Whether a simulated body should do so, too, is open. Studies disagree: some found that
it helps a controller to learn, some that it makes no difference, some that it harms, depending on task, body and order;
Naya-Varela, Faíña & Duro (2020, *Some experiments on the influence of problem hardness in morphological development
based learning of neural controllers*) found that it helps the more, the harder the task. The paper (López et al. 2025,
*MIMo grows!*) has infants of any age, but none that grows while it learns: there is no result to compare with.

The average child (`development: maturing`, no sensory delays, no noise) is held upright and learns with PPO to touch
a ball with its right hand (the task `reach`), by four schedules:

{schedules}

Each infant is trained for {steps:,} control steps of 10 ms, summed over all parallel environments, with each of {seeds}
seeds. Infants of the same seed begin with the same network. In the schedules in which the age changes, it has each of
{stages} ages, {stage:g} months apart, for equally many steps: these schedules have the same experience of ages in
different orders. At each checkpoint, and after training, **all** infants reach for the same balls with the body of
{oldest:g} months, without the noise by which PPO explores: {check_balls} balls at each checkpoint, {balls} after
training.

![Age, learning, tests at the oldest age, and the result of each infant](growing.png)

From left to right: the schedules; time to touch in the episodes of the training, whose body and ball change with age,
so that these curves are not comparable between schedules; time to touch at {oldest:g} months at each checkpoint, which
is (dotted: a random policy); and the result of each infant after training. Lines are means over the seeds, bands reach
from the lowest to the highest. A reach that fails counts with the full length of its episode.

`learning.csv` has the learning curves, `checks.csv` the reaches at each checkpoint, `reaches.csv` those after
training, and `final.csv` a row for each infant."""

RESULTS = """\
## Results

At {oldest:g} months, as the mean over seeds with minimum and maximum:

{table}

The last column is the mean over all checkpoints: the smaller, the sooner the infant could reach with this body.

{verdict}"""

FAIR = """\
## What this can show, and what it cannot

All infants have had equally many control steps, but not equally many with the body they are tested with: `adult` all of
them, each other schedule 1/{stages} of them, `grown` the last ones, `reversed` the first ones. To do as well as
`adult` is therefore no small thing for the others, and `reversed` is tested after it has been {youngest:g} months old,
not {oldest:g}: its result mixes what the order did with what was forgotten.

The body also changes within episodes. In `grown` and `reversed`, it becomes larger or smaller by {stage:g} months at a
time, while the ball stays where it hangs: the arm, its strength and the angles at which the hand meets the ball are
others than at the start of the episode, by about as little as from one stage to the next. `shuffled` jumps between
ages up to {span:g} months apart, in the midst of an episode, too: a ball hung for a larger child can then be out of a
smaller one's reach until the episode ends, which may cost `shuffled` episodes that the other schedules do not lose.
Each parallel environment changes its age {jumps} times in a training. Observations do not contain the age; a policy can
only infer it from what the infant senses.

Growing could pay in other ways that are not tested here: fewer falls, lighter training, skills for all ages. One
task, one algorithm with one set of hyperparameters, one range of ages and {seeds} seeds say nothing of others. Reaching
was chosen because an infant that is held upright can do it at each of these ages, as the ball is hung within the reach
of the arm of that age, so that no schedule begins with a task that cannot be solved. But a random policy touches
{random:.0%} of the balls as well, sooner or later: where a fixed body learns quickly, there is little for growth to
win."""

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
    random = fmean(each.success for each in untrained)
    return (
        ABOUT.format(schedules=schedules, **known),
        RESULTS.format(table=_table(groups, untrained), verdict=_verdict(groups), **known),
        FAIR.format(random=random, **known),
    )


def _table(groups: Groups, untrained: Sequence[Episode]) -> str:
    headings = ("schedule", "balls touched", "return", "time to touch [s]", "time to touch over all checkpoints [s]")
    rows = [
        (
            f"`{name}`",
            _mean_and_range([each.success_rate() for each in group]),
            _mean_and_range([each.episode_return() for each in group]),
            *(_mean_and_range([measure(each) for each in group]) for measure in MEASURES.values()),
        )
        for name, group in groups.items()
    ]
    random = [fmean(getattr(each, name) for each in untrained) for name in ("success", "total_reward", "duration_s")]
    return markdown_table(headings, [*rows, ("random policy", *(f"{value:.3f}" for value in random), "-")])


def _mean_and_range(values: Sequence[float]) -> str:
    return f"{fmean(values):.3f} ({min(values):.3f} to {max(values):.3f})"


def _verdict(groups: Groups) -> str:
    """Return as text how `grown` compares with each other schedule, and what follows."""
    others = [name for name in groups if name != "grown"]
    found = {other: {name: _compared(groups, other, name) for name in MEASURES} for other in others}
    lines = "\n".join(
        f"- `grown` against `{other}`, {name}: {outcome}, {_change(groups, other, name):+.0%};"
        for other, outcomes in found.items()
        for name, outcome in outcomes.items()
    )
    count = len(groups["grown"])
    chance = 2 / comb(2 * count, count)
    return (
        f"{BETTER.capitalize()} or {WORSE} is what has no overlap between the ranges of the {count} seeds of each; "
        f"everything else is {SAME}. If there were no difference at all, this would still happen in "
        f"{chance:.0%} of such comparisons.\n\n{lines.removesuffix(';')}.\n\n{_answer(found['adult'])} "
        f"{_order({name: found[name] for name in others if name != 'adult'})}"
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
    return [MEASURES[measure](each) for each in groups[schedule]]


def _answer(found: Mapping[str, str]) -> str:
    """Return the answer to the question of the title, from the comparison with `adult`."""
    helped, harmed = ([name for name, outcome in found.items() if outcome == which] for which in (BETTER, WORSE))
    if helped and harmed:
        return f"**Growing helped with {' and '.join(helped)}, and harmed {' and '.join(harmed)}.**"
    if helped:
        return f"**Growing helped here, with {' and '.join(helped)}.**"
    if harmed:
        return f"**Growing did not help here: {' and '.join(harmed)} got worse.**"
    return "**No effect of growing is shown here, for better or worse.**"


def _order(found: Mapping[str, Mapping[str, str]]) -> str:
    """Return whether the order of the ages mattered, from the comparisons with the same ages in other orders."""
    ahead = [name for name, outcomes in found.items() if set(outcomes.values()) == {BETTER}]
    if len(ahead) == len(found):
        return "The natural order of ages was better than every other by both measures."
    if ahead:
        return f"The natural order of ages was better by both measures than `{'`, `'.join(ahead)}` only."
    return "That the natural order of ages is better than another is not shown by both measures."
