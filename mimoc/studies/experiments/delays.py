"""Effects of delays on reaching: on learning (López et al. 2025, figure 4), and on the movements of infants."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from itertools import pairwise
from operator import methodcaller
from pathlib import Path
from statistics import fmean

from mimoc.base.units import ms_to_s
from mimoc.bundle.io import Bundle
from mimoc.compiler import pipeline
from mimoc.quantities import Quantity
from mimoc.render.plots.plot import Dots, Line, Plot
from mimoc.runtime.env import InfantEnv
from mimoc.schema.infant import InfantSpec
from mimoc.studies.experiments.infant_reaches import DELAYS, infants_text, reach_at_ages, write_reaches
from mimoc.studies.experiments.learner import (
    FIRST_BALL,
    LIBRARIES,
    Learner,
    by_group,
    learning_plot,
    mean_and_range,
    movement_of,
    trained,
)
from mimoc.studies.experiments.notebook import Cell, Notebook, page_text, table_rows
from mimoc.tasks.reach import ReachEntry
from mimoc.training import Episode, evaluate, load_policy

DELAYS_MS: Sequence[float] = (0, 50, 200)
MOTOR_MS = 5.0
AGE_MONTHS = 18
STEPS, QUICK_STEPS = 500_000, 40_960
"""Control steps of each training run: the paper's, and a number that takes minutes."""
SEEDS, QUICK_SEEDS = (1, 2, 3), (1, 2)
EPISODES = 50
"""Number of reaches of each trained infant; all of them reach for the same balls."""
SHOWN = 4
"""Number of balls whose hand paths are plotted, for the infants of the first seed."""
MONTHS: Sequence[float] = (4, 6, 9)
"""Ages of the infants whose reaches are compared with those of real ones."""
REACHES, QUICK_REACHES = 20, 4
"""Number of reaches of each, with each delay."""
REACH_S = 3.0
"""Simulated time after which a reach is given up."""

Groups = Mapping[str, Sequence[Learner]]
"""Trained infants by their sensory delay, as it is shown, the shortest first."""


ARC_LENGTH, JERK, DETOUR = (methodcaller("median", measure) for measure in ("arc_length", "jerk", "path_ratio"))
"""Medians of a learner's reaches after training."""
MEASURES = (Learner.last_time_s, Learner.success_rate, Learner.time_s, ARC_LENGTH, JERK, DETOUR)
"""The columns of the table."""


def run(notebook: Notebook) -> Path:
    """Train infants with each delay (or resume interrupted runs), compare them, and return the path of the report."""
    steps, seeds = (QUICK_STEPS, QUICK_SEEDS) if notebook.quick else (STEPS, SEEDS)
    infants = len(MONTHS) * len(DELAYS)
    total = infants + steps * len(seeds) * len(DELAYS_MS)
    count = QUICK_REACHES if notebook.quick else REACHES
    reaches = reach_at_ages(MONTHS, count, REACH_S, notebook.counter(total))
    write_reaches(notebook, reaches)
    learners = list(_learners(notebook, steps, seeds, infants, total))
    groups = {f"{delay_ms} ms": group for delay_ms, group in by_group(learners).items()}
    first = [item for item in learners if item.seed == learners[0].seed]
    _write_tables(notebook, learners, first)
    learning = learning_plot(groups, Quantity("time_s", "Time to reach", "s"), "Learning")
    notebook.write_plots("delays.png", [learning, _path_plot(first), _smoothness_plot(groups)])
    *others, longest = groups
    return notebook.write_page(
        *LIBRARIES,
        age=AGE_MONTHS,
        delays=f"{', '.join(others)} and {longest}",
        motor=MOTOR_MS,
        steps=steps,
        seeds=len(seeds),
        episodes=EPISODES,
        shown=SHOWN,
        **_comparison(groups),
        infants=infants_text(reaches, REACH_S),
        training_seeds=", ".join(map(str, seeds)),
        first_ball=FIRST_BALL,
    )


def _learners(notebook: Notebook, steps: int, seeds: Sequence[int], before: int, total: int) -> Iterator[Learner]:
    """Yield each trained infant, after some steps of all."""
    wanted = [(delay_ms, seed) for seed in seeds for delay_ms in DELAYS_MS]
    for number, (delay_ms, seed) in enumerate(wanted):
        bundle, progress = reaching(delay_ms), notebook.part(before + number * steps, steps, total)
        training = trained(notebook, f"delay_{delay_ms:g}ms_seed_{seed}", bundle, steps, progress, seed=seed)
        task = bundle.manifest.task
        assert isinstance(task, ReachEntry)
        with closing(InfantEnv(bundle)) as env:
            reaches = evaluate(env, load_policy(training.policy), EPISODES, seed=FIRST_BALL, follow=task.effector)
        yield Learner(f"{delay_ms:g}", seed, training, reaches)


def reaching(delay_ms: float) -> Bundle:
    """Return the paper's infant with the task `reach` and the given delay of all its senses."""
    spec = {
        "mimoc": 1,
        "name": "reaching",
        "age_months": AGE_MONTHS,
        "development": "published",
        "senses": {"proprioception": {"include": ["velocity"]}},
        "delays": {"sensory_ms": float(delay_ms), "motor_ms": MOTOR_MS},
        "task": {"kind": "reach"},
    }
    return pipeline.build(InfantSpec.model_validate(spec))


def _comparison(groups: Groups) -> dict[str, str]:
    """Return the table of the page, and whether the results have the same order as the paper's."""
    rows = [(delay, *(mean_and_range(group, measure) for measure in MEASURES)) for delay, group in groups.items()]
    measures: Mapping[str, Callable[[Learner], float]] = {
        "slower": Learner.last_time_s,
        "longer": Learner.time_s,
        "shorter_arc": lambda learner: -ARC_LENGTH(learner),
        "jerkier": lambda learner: -JERK(learner),
    }
    means = {what: [fmean(map(measure, group)) for group in groups.values()] for what, measure in measures.items()}
    verdicts = {
        what: "yes" if all(before < after for before, after in pairwise(values)) else "not in every case"
        for what, values in means.items()
    }
    reach_s = fmean(learner.time_s() for group in groups.values() for learner in group)
    ballistic = reach_s < ms_to_s(max(DELAYS_MS))
    stroke = page_text("delays_stroke", reach_ms=1000 * reach_s) if ballistic else ""
    return {"table": table_rows(rows), **verdicts, "stroke": stroke}


def _write_tables(notebook: Notebook, learners: Sequence[Learner], first: Sequence[Learner]) -> None:
    notebook.write_table(
        "learning.csv",
        "delay_ms,seed,steps,episodes,success_rate,time_s,episode_return",
        ((item.group, item.seed, steps, *cells) for item in learners for steps, cells in item.learning()),
    )
    notebook.write_table(
        "reaches.csv",
        "delay_ms,seed,ball,success,time_s,log_dimensionless_jerk,spectral_arc_length,detour",
        ((item.group, item.seed, *_reach_cells(reach)) for item in learners for reach in item.reaches),
    )
    notebook.write_table(
        "paths.csv",
        "delay_ms,seed,ball,time_s,x_m,y_m,z_m",
        (
            (item.group, item.seed, reach.seed, index * reach.duration_s / reach.steps, *place)
            for item in first
            for reach in item.reaches[:SHOWN]
            for index, place in enumerate(movement_of(reach).path_m.tolist())
        ),
    )


def _reach_cells(reach: Episode) -> tuple[Cell, ...]:
    movement = movement_of(reach)
    smoothness = (movement.jerk, movement.arc_length, movement.path_ratio)
    return (reach.seed, float(reach.success), reach.duration_s, *smoothness)


def _path_plot(first: Sequence[Learner]) -> Plot:
    lines = []
    for item in first:
        with closing(InfantEnv(reaching(float(item.group)))) as env:
            env.reset(seed=0)
            shoulder = env.data.body("right_upper_arm").xpos.copy()
        for reach in item.reaches[:SHOWN]:
            ahead, _, up = 100 * (movement_of(reach).path_m - shoulder).T
            lines.append(Line(ahead, up, f"{item.group} ms"))
    x, y = Quantity("ahead_cm", "In front of the shoulder", "cm"), Quantity("up_cm", "Above the shoulder", "cm")
    return Plot(x, y, tuple(lines), title="Hand paths", equal=True)


def _smoothness_plot(groups: Groups) -> Plot:
    dots = [
        Dots([float(item.group) for item in group], list(map(ARC_LENGTH, group)), label)
        for label, group in groups.items()
    ]
    x, y = Quantity("delay_ms", "Sensory delay", "ms"), Quantity("sal", "Spectral arc length (higher is smoother)")
    return Plot(x, y, dots=tuple(dots), title="Smoothness")
