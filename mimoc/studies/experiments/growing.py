"""Does growing help? Reaching, learnt while the infant grows, does not, gets younger, or changes age at random."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from math import comb
from pathlib import Path
from statistics import fmean

import numpy as np

from mimoc.base.quantities import AGE, Quantity
from mimoc.bundle.io import Bundle
from mimoc.compiler import building
from mimoc.render.plots import Dots, Line, Plot
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.growth_wrapper import COURSES, STAGE_MONTHS, GrowthSchedule, growth_schedule
from mimoc.runtime.quantities import EpisodeResult
from mimoc.studies.experiment import Experiment, Table, child
from mimoc.studies.experiments import learner as learning
from mimoc.studies.experiments.learner import FIRST_BALL, LIBRARIES, THOUSANDS, Learner, by_group, mean_and_range
from mimoc.studies.notebook import PAGES, Cell, Notebook, table_rows
from mimoc.training import evaluate, load_policy
from mimoc.training.run_folder import CHECKPOINTS

AGES_MONTHS = (6.0, 12.0)  # The youngest and the oldest age of the infants that learn; all are tested at the oldest.
EPISODE_STEPS = 1000  # Control steps after which a reach is given up (MIMo).
STEPS, QUICK_STEPS = 245_760, 12_288
"""Control steps of each training run; docs/learning has reaching learnt in 200,000."""
CHECKPOINT_EVERY, QUICK_CHECKPOINT_EVERY = 20_480, 6_144
"""Control steps between checkpoints, whose policies are tested too."""
SEEDS, QUICK_SEEDS = (1, 2, 3), (1, 2)
BALLS, QUICK_BALLS = 100, 5  # Number of balls for which each infant reaches after training; they are the same for all.
CHECK_BALLS, QUICK_CHECK_BALLS = 20, 2  # Number of these balls for which it reaches at each earlier checkpoint.

Groups = Mapping[str, Sequence[Learner]]  # Trained infants by schedule of growth.
MEASURES = {  # What is compared; less is better.
    "time to touch after training": Learner.time_s,
    "time to touch over all checkpoints": Learner.time_over_checkpoints_s,
}
COLUMNS = (Learner.success_rate, Learner.episode_return, *MEASURES.values())  # Columns of the table.
BETTER, WORSE, SAME = "better", "worse", "not distinguishable"


@dataclass(frozen=True, slots=True)
class Trained:
    """Trained infants, and one that moves at random, for the same balls."""

    learners: Sequence[Learner]
    untrained: Sequence[EpisodeResult]
    steps: int  # Control steps of each training.
    check_balls: int

    @property
    def groups(self) -> Groups:
        """The infants by schedule of growth."""
        return by_group(self.learners)


def measure(notebook: Notebook) -> Trained:
    """Train infants by each schedule, or resume interrupted runs."""
    steps, seeds = (QUICK_STEPS, QUICK_SEEDS) if notebook.quick else (STEPS, SEEDS)
    balls, check_balls = (QUICK_BALLS, QUICK_CHECK_BALLS) if notebook.quick else (BALLS, CHECK_BALLS)
    bundle = reaching(AGES_MONTHS[1])
    learners = list(_learners(notebook, bundle, steps, seeds))
    with closing(InfantEnv(bundle)) as env:
        return Trained(learners, evaluate(env, "random", balls, seed=FIRST_BALL), steps, check_balls)


def reaching(age_months: float) -> Bundle:
    """Return the average child of an age, of the law `maturing`, with the task `reach`."""
    senses = {"proprioception": {"include": ["velocity", "limits", "actuation"]}, "vestibular": {}}
    task = {"kind": "reach", "steps": EPISODE_STEPS}
    return building.build(child("growing", age_months, development="maturing", senses=senses, task=task))


def schedule_of(course: str, seed: int, steps: int) -> GrowthSchedule:
    """Return the ages of one training by the control steps done, summed over all environments."""
    return growth_schedule(course, AGES_MONTHS, steps, seed=seed)


def _learners(notebook: Notebook, bundle: Bundle, steps: int, seeds: Sequence[int]) -> Iterator[Learner]:
    wanted = [(course, seed) for seed in seeds for course in COURSES]
    settings = {
        "checkpoint_every": QUICK_CHECKPOINT_EVERY if notebook.quick else CHECKPOINT_EVERY,
        "grow": ":".join(f"{age:g}" for age in AGES_MONTHS),
        "grow_steps": steps,
    }
    for number, (course, seed) in enumerate(wanted):
        progress = notebook.part(number * steps, steps, len(wanted) * steps)
        name = f"{course}_seed_{seed}{'_quick' * notebook.quick}"
        training = learning.trained(notebook, name, bundle, steps, progress, seed=seed, schedule=course, **settings)
        yield Learner(course, seed, training, *_tested(notebook, bundle, notebook.folder / name))


def _tested(
    notebook: Notebook, bundle: Bundle, folder: Path
) -> tuple[list[EpisodeResult], Mapping[int, list[EpisodeResult]]]:
    """Return the reaches at the oldest age: after training, and for fewer balls at each checkpoint, by its steps."""
    balls, check_balls = (QUICK_BALLS, QUICK_CHECK_BALLS) if notebook.quick else (BALLS, CHECK_BALLS)
    *earlier, last = sorted((folder / CHECKPOINTS).glob("*.zip"))
    with closing(InfantEnv(bundle)) as env:
        checks = {int(path.stem): evaluate(env, load_policy(path), check_balls, seed=FIRST_BALL) for path in earlier}
        reaches = evaluate(env, load_policy(last), balls, seed=FIRST_BALL)
    return reaches, {**checks, int(last.stem): reaches[:check_balls]}


def comparison(
    groups: Groups, untrained: Sequence[EpisodeResult], ages_months: tuple[float, float]
) -> dict[str, object]:
    """Return what the page tells of results by schedule, `grown` and `adult` among them, and of what they can show."""
    youngest, oldest = ages_months
    stages = round((oldest - youngest) / STAGE_MONTHS) + 1
    schedules = "\n".join(f"- `{name}`: {meaning};" for name, meaning in COURSES.items()).removesuffix(";") + "."
    count = len(groups["grown"])
    others = [name for name in groups if name != "grown"]
    outcomes = {other: {name: _compared(groups, other, name) for name in MEASURES} for other in others}
    lines = "\n".join(
        f"- `grown` against `{other}`, {name}: {outcomes[other][name]}, {_change(groups, other, name):+.0%};"
        for other in others
        for name in MEASURES
    )
    random = [fmean(getattr(reach, name) for reach in untrained) for name in ("success", "total_reward", "duration_s")]
    rows = [(f"`{name}`", *(mean_and_range(group, column) for column in COLUMNS)) for name, group in groups.items()]
    return {
        "youngest": youngest,
        "oldest": oldest,
        "span": oldest - youngest,
        "stages": stages,
        "stage": STAGE_MONTHS,
        "jumps": stages - 1,
        "schedules": schedules,
        "table": table_rows([*rows, ("random policy", *(f"{value:.3f}" for value in random), "-")]),
        "chance": 2 / comb(2 * count, count),
        "comparisons": f"{lines.removesuffix(';')}.",
        "answer": _answer(outcomes.pop("adult")),
        "order": _order(outcomes),
        "random": fmean(reach.success for reach in untrained),
    }


def _compared(groups: Groups, other: str, measure: str) -> str:
    grown = _values(groups, "grown", measure)
    others = _values(groups, other, measure)
    if max(grown) < min(others):
        return BETTER
    return WORSE if min(grown) > max(others) else SAME


def _change(groups: Groups, other: str, measure: str) -> float:
    return fmean(_values(groups, "grown", measure)) / fmean(_values(groups, other, measure)) - 1


def _values(groups: Groups, schedule: str, measure: str) -> list[float]:
    return [MEASURES[measure](learner) for learner in groups[schedule]]


def _answer(comparisons: Mapping[str, str]) -> str:
    helped, harmed = ([name for name, outcome in comparisons.items() if outcome == which] for which in (BETTER, WORSE))
    if helped and harmed:
        return f"**Growing helped with {' and '.join(helped)}, and harmed {' and '.join(harmed)}.**"
    if helped:
        return f"**Growing helped here, with {' and '.join(helped)}.**"
    if harmed:
        return f"**Growing did not help here: {' and '.join(harmed)} got worse.**"
    return "**No effect of growing is shown here, for better or worse.**"


def _order(comparisons: Mapping[str, Mapping[str, str]]) -> str:
    ahead = [name for name, outcomes in comparisons.items() if set(outcomes.values()) == {BETTER}]
    if len(ahead) == len(comparisons):
        return "The natural order of ages was better than every other by both measures."
    if ahead:
        return f"The natural order of ages was better by both measures than `{'`, `'.join(ahead)}` only."
    return "That the natural order of ages is better than another is not shown by both measures."


def _outcome(reach: EpisodeResult) -> tuple[Cell, ...]:
    return reach.seed, float(reach.success), reach.duration_s, reach.total_reward


def _learning(found: Trained) -> Table:
    return "schedule,seed,steps,age_months,episodes,success_rate,time_s,episode_return", (
        (item.group, item.seed, done, schedule_of(item.group, item.seed, found.steps)(done - 1), *cells)
        for item in found.learners
        for done, cells in item.learning()
    )


def _checks(found: Trained) -> Table:
    return "schedule,seed,steps,ball,success,time_s,episode_return", (
        (item.group, item.seed, done, *_outcome(reach))
        for item in found.learners
        for done, reaches in item.checks.items()
        for reach in reaches
    )


def _reaches(found: Trained) -> Table:
    return "schedule,seed,ball,success,time_s,episode_return", (
        (item.group, item.seed, *_outcome(reach)) for item in found.learners for reach in item.reaches
    )


def _finals(found: Trained) -> Table:
    finals = (Learner.success_rate, *MEASURES.values())
    return "schedule,seed,balls,success_rate,time_s,time_over_checkpoints_s,episode_return", (
        (it.group, it.seed, len(it.reaches), *(measure(it) for measure in finals), it.episode_return())
        for it in found.learners
    )


def _numbers(found: Trained) -> dict[str, object]:
    seeds = dict.fromkeys(learner.seed for learner in found.learners)
    return {
        **comparison(found.groups, found.untrained, AGES_MONTHS),
        "steps": found.steps,
        "seeds": len(seeds),
        "balls": len(found.untrained),
        "check_balls": found.check_balls,
        "training_seeds": ", ".join(map(str, seeds)),
        "first_ball": FIRST_BALL,
    }


TIME_TO_TOUCH = Quantity("time_s", "Time to touch", "s")


def _plots(found: Trained) -> Iterator[Plot]:
    groups, untrained, steps = found.groups, found.untrained, found.steps
    tested = f"at {AGES_MONTHS[1]:g} months"
    done = np.arange(0, steps, max(1, steps // 500))
    firsts = [group[0] for group in groups.values()]
    ages = tuple(
        Line(done / 1000, [schedule_of(item.group, item.seed, steps)(int(step)) for step in done], item.group)
        for item in firsts
    )
    yield Plot(THOUSANDS, AGE, ages, title=f"Schedules (seed {firsts[0].seed})")
    yield learning.learning_plot(groups, TIME_TO_TOUCH, "Learning, at the age of the moment")
    checks = {
        schedule: (list(group[0].checks), [list(item.check_times_s().values()) for item in group])
        for schedule, group in groups.items()
    }
    yield learning.banded_plot(
        checks, TIME_TO_TOUCH, f"Tested {tested}", fmean(reach.duration_s for reach in untrained)
    )
    dots = tuple(
        Dots([item.time_s() for item in group], [100 * item.success_rate() for item in group], schedule)
        for schedule, group in groups.items()
    )
    touched = Quantity("touched", "Balls touched", "%")
    yield Plot(TIME_TO_TOUCH, touched, dots=dots, title=f"After training, {tested}")


EXPERIMENT = Experiment(
    name="growing",
    measure=measure,
    files={
        "learning.csv": _learning,
        "checks.csv": _checks,
        "reaches.csv": _reaches,
        "final.csv": _finals,
        "growing.png": _plots,
    },
    page=PAGES / "growing.md",
    numbers=_numbers,
    libraries=LIBRARIES,
    infants=lambda law: map(reaching, AGES_MONTHS),
)
