"""Does growing help? Reaching, learnt while the infant grows, does not, gets younger, or changes age at random."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import replace
from math import comb
from pathlib import Path
from statistics import fmean

import numpy as np
import numpy.typing as npt

from mimoc.bundle.files import check_unlinked
from mimoc.bundle.io import Bundle
from mimoc.compiler import pipeline
from mimoc.quantities import Quantity
from mimoc.quantities.child import AGE
from mimoc.quantities.outcome import TRAINED
from mimoc.render.plots.plot import Band, Dots, Line, Plot
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.growth_schedule import COURSES, STAGE_MONTHS, GrowthSchedule, growth_schedule
from mimoc.schema.infant import InfantSpec
from mimoc.studies.experiments.learner import GrowingLearner, binned_times_s, by_schedule, mean_and_range, times_s
from mimoc.studies.experiments.notebook import Cell, Notebook, markdown_table, page_texts
from mimoc.training import Episode, evaluate, load_policy, train
from mimoc.training.run_folder import CHECKPOINTS

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


AGES_MONTHS = (6.0, 12.0)
"""The youngest and the oldest age of the infants that learn; all are tested at the oldest."""
EPISODE_STEPS = 1000
"""Control steps after which a reach is given up (MIMo)."""
STEPS, QUICK_STEPS = 245_760, 12_288
"""Control steps of each training run; docs/learning has reaching learnt in 200,000."""
CHECKPOINT_EVERY, QUICK_CHECKPOINT_EVERY = 20_480, 6_144
"""Control steps between checkpoints, whose policies are tested too."""
SEEDS, QUICK_SEEDS = (1, 2, 3), (1, 2)
BALLS, QUICK_BALLS = 100, 5
"""Number of balls for which each infant reaches after training; they are the same for all."""
CHECK_BALLS, QUICK_CHECK_BALLS = 20, 2
"""Number of these balls for which it reaches at each earlier checkpoint."""
FIRST_BALL = 1000
"""Seed of the first ball, which is not the seed of any training run."""


def run(notebook: Notebook) -> Path:
    """Train infants by each schedule (or resume interrupted runs), compare them, and return the path of the report."""
    steps, seeds = (QUICK_STEPS, QUICK_SEEDS) if notebook.quick else (STEPS, SEEDS)
    balls, check_balls = (QUICK_BALLS, QUICK_CHECK_BALLS) if notebook.quick else (BALLS, CHECK_BALLS)
    bundle, total = reaching(), steps * len(seeds) * len(COURSES)
    learners = list(_learners(notebook, bundle, steps, seeds, lambda done: notebook.progress(done, total)))
    with closing(InfantEnv(bundle)) as env:
        untrained = evaluate(env, "random", balls, seed=FIRST_BALL)
    _write_tables(notebook, learners, steps)
    notebook.write_plots("growing.png", _plots(learners, untrained, steps))
    numbers = {"steps": steps, "seeds": len(seeds), "balls": balls, "check_balls": check_balls}
    return notebook.write_page(
        "Does growing help?",
        sections(by_schedule(learners), untrained, AGES_MONTHS, **numbers),
        seeds=f"Seeds: {', '.join(map(str, seeds))} for training, {FIRST_BALL} and up for the balls.",
        libraries=["gymnasium", "stable-baselines3", "torch", "matplotlib"],
    )


def reaching() -> Bundle:
    """Return the average child of the oldest age, of the law `maturing`, with the task `reach`."""
    spec = {
        "mimoc": 1,
        "name": "growing",
        "age_months": AGES_MONTHS[1],
        "development": "maturing",
        "senses": {"proprioception": {"include": ["velocity", "limits", "actuation"]}, "vestibular": {}},
        "task": {"kind": "reach", "steps": EPISODE_STEPS},
    }
    return pipeline.build(InfantSpec.model_validate(spec))


def schedule_of(course: str, seed: int, steps: int) -> GrowthSchedule:
    """Return the ages of one training by the control steps done, summed over all environments."""
    return growth_schedule(course, AGES_MONTHS, steps, seed=seed)


def _learners(
    notebook: Notebook, bundle: Bundle, steps: int, seeds: Sequence[int], progress: Callable[[int], None]
) -> Iterator[GrowingLearner]:
    """Yield each trained infant; each training run has a folder of its own, in which it can be resumed.

    Progress is called with the number of steps done.
    """
    wanted = [(course, seed) for seed in seeds for course in COURSES]
    for number, (course, seed) in enumerate(wanted):
        place = notebook.folder / f"{course}_seed_{seed}{'_quick' * notebook.quick}"
        folder = check_unlinked(place, below=notebook.folder)

        def report(done: int, total: int, before: int = number * steps) -> None:
            progress(before + min(done, steps))

        training = train(
            bundle,
            folder,
            steps=steps,
            seed=seed,
            checkpoint_every=QUICK_CHECKPOINT_EVERY if notebook.quick else CHECKPOINT_EVERY,
            progress=report,
            grow=":".join(f"{age:g}" for age in AGES_MONTHS),
            schedule=course,
            grow_steps=steps,
        )
        reaches, checks = _tested(notebook, bundle, folder)
        progress((number + 1) * steps)
        yield GrowingLearner(course, seed, training, reaches, checks)


def _tested(notebook: Notebook, bundle: Bundle, folder: Path) -> tuple[list[Episode], Mapping[int, list[Episode]]]:
    """Return the reaches at the oldest age: after training, and for fewer balls at each checkpoint, by its steps."""
    balls, check_balls = (QUICK_BALLS, QUICK_CHECK_BALLS) if notebook.quick else (BALLS, CHECK_BALLS)
    *earlier, last = sorted((folder / CHECKPOINTS).glob("*.zip"))
    with closing(InfantEnv(bundle)) as env:
        checks = {int(path.stem): evaluate(env, load_policy(path), check_balls, seed=FIRST_BALL) for path in earlier}
        reaches = evaluate(env, load_policy(last), balls, seed=FIRST_BALL)
    return reaches, {**checks, int(last.stem): reaches[:check_balls]}


def _write_tables(notebook: Notebook, learners: Sequence[GrowingLearner], steps: int) -> None:
    notebook.write_table(
        "learning.csv",
        ("schedule", "seed", "steps", "age_months", "episodes", "success_rate", "time_s", "episode_return"),
        (row for item in learners for row in _learning_rows(item, schedule_of(item.schedule, item.seed, steps))),
    )
    notebook.write_table(
        "checks.csv",
        ("schedule", "seed", "steps", "ball", "success", "time_s", "episode_return"),
        (
            (item.schedule, item.seed, done, *_outcome(reach))
            for item in learners
            for done, reaches in item.checks.items()
            for reach in reaches
        ),
    )
    notebook.write_table(
        "reaches.csv",
        ("schedule", "seed", "ball", "success", "time_s", "episode_return"),
        ((item.schedule, item.seed, *_outcome(reach)) for item in learners for reach in item.reaches),
    )
    notebook.write_table(
        "final.csv",
        ("schedule", "seed", "balls", "success_rate", "time_s", "time_over_checkpoints_s", "episode_return"),
        (
            (
                *(item.schedule, item.seed, len(item.reaches), item.success_rate(), item.time_s()),
                *(item.time_over_checkpoints_s(), item.episode_return()),
            )
            for item in learners
        ),
    )


def _learning_rows(learner: GrowingLearner, schedule: GrowthSchedule) -> Iterator[tuple[Cell, ...]]:
    """Yield the rows of a learning curve, each with the age at its last step."""
    curve = learner.training.curve
    for row, time_s in zip(curve.rows, times_s(curve), strict=True):
        measured = (row.episodes, row.success_rate, float(time_s), row.episode_return)
        yield learner.schedule, learner.seed, row.steps, schedule(row.steps - 1), *measured


def _outcome(reach: Episode) -> tuple[Cell, ...]:
    return reach.seed, float(reach.success), reach.duration_s, reach.total_reward


def _plots(learners: Sequence[GrowingLearner], untrained: Sequence[Episode], steps: int) -> list[Plot]:
    groups = by_schedule(learners)
    return [
        _age_plot([group[0] for group in groups.values()], steps),
        _learning_plot(groups),
        _check_plot(groups, float(np.mean([reach.duration_s for reach in untrained]))),
        _final_plot(groups),
    ]


THOUSANDS = replace(TRAINED, unit="thousands")
TIME_TO_TOUCH = Quantity("time_s", "Time to touch", "s")


def _age_plot(learners: Sequence[GrowingLearner], steps: int) -> Plot:
    done = np.arange(0, steps, max(1, steps // 500))
    lines = tuple(
        Line(done / 1000, [schedule_of(item.schedule, item.seed, steps)(int(step)) for step in done], item.schedule)
        for item in learners
    )
    return Plot(THOUSANDS, AGE, lines, title=f"Schedules (seed {learners[0].seed})")


def _learning_plot(groups: Mapping[str, Sequence[GrowingLearner]]) -> Plot:
    parts = []
    for schedule, group in groups.items():
        steps, found_s = zip(*(binned_times_s(item.training.curve) for item in group), strict=True)
        parts.append(_with_band(schedule, steps[0], found_s))
    return _time_plot(parts, "Learning, at the age of the moment")


def _check_plot(groups: Mapping[str, Sequence[GrowingLearner]], untrained_s: float) -> Plot:
    parts = [
        _with_band(schedule, list(group[0].checks), [list(item.check_times_s().values()) for item in group])
        for schedule, group in groups.items()
    ]
    return _time_plot(parts, f"Tested at {AGES_MONTHS[1]:g} months", untrained_s)


def _time_plot(parts: Sequence[tuple[Line, Band]], title: str, level: float | None = None) -> Plot:
    lines, bands = zip(*parts, strict=True)
    return Plot(THOUSANDS, TIME_TO_TOUCH, lines, bands, title=title, level=level)


def _with_band(label: str, steps: npt.ArrayLike, values: npt.ArrayLike) -> tuple[Line, Band]:
    """Return the mean over seeds, with a band from the least to the greatest."""
    times, thousands = np.asarray(values), np.asarray(steps) / 1000
    return Line(thousands, times.mean(axis=0), label), Band(thousands, times.min(axis=0), times.max(axis=0), label)


def _final_plot(groups: Mapping[str, Sequence[GrowingLearner]]) -> Plot:
    dots = tuple(
        Dots([item.time_s() for item in group], [100 * item.success_rate() for item in group], schedule)
        for schedule, group in groups.items()
    )
    title = f"After training, at {AGES_MONTHS[1]:g} months"
    return Plot(TIME_TO_TOUCH, Quantity("touched", "Balls touched", "%"), dots=dots, title=title)
