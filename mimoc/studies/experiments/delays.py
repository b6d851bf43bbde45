"""Effects of delays on reaching: on learning (López et al. 2025, figure 4), and on the movements of infants."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from statistics import fmean

import numpy as np

from mimoc.base.units import ms_to_s
from mimoc.bundle.files import check_unlinked
from mimoc.bundle.io import Bundle
from mimoc.compiler import pipeline
from mimoc.quantities import Quantity
from mimoc.quantities.outcome import TRAINED
from mimoc.render.plots.plot import Band, Dots, Line, Plot
from mimoc.runtime.env import InfantEnv
from mimoc.schema.infant import InfantSpec
from mimoc.studies.experiments.infant_reaches import DELAYS, infant_sections, reach_at_ages, write_reaches
from mimoc.studies.experiments.learner import Learner, binned_times_s, detour, mean_and_range, smoothness
from mimoc.studies.experiments.notebook import Notebook, markdown_table, page_texts
from mimoc.tasks.reach import ReachEntry
from mimoc.training import evaluate, load_policy, train

Groups = Mapping[float, Sequence[Learner]]
"""Trained infants by sensory delay in ms."""

TEXTS = page_texts("delays")


def sections(groups: Groups, **numbers: float) -> tuple[str, str]:
    """Return the sections of the report: method and results.

    Args:
        groups: The infants by delay in ms, the shortest first.
        numbers: Numbers of the experiment, by their names in the text.
    """
    *others, longest = (f"{delay_ms:g} ms" for delay_ms in groups)
    about = TEXTS["about"].format(delays=f"{', '.join(others)} and {longest}", **numbers)
    return about, TEXTS["compared"].format(table=_table(groups), verdict=_verdict(groups))


def _table(groups: Groups) -> str:
    headings = (
        "sensory delay",
        "time to reach, end of training [s]",
        "balls touched",
        "time to reach, after training [s]",
        "spectral arc length",
        "log dimensionless jerk",
        "path length / distance",
    )
    rows = [
        (
            f"{delay_ms:g} ms",
            mean_and_range([learner.last_time_s() for learner in group]),
            mean_and_range([learner.success_rate() for learner in group]),
            mean_and_range([learner.reach_time_s() for learner in group]),
            mean_and_range([learner.arc_length() for learner in group]),
            mean_and_range([learner.jerk() for learner in group]),
            mean_and_range([learner.detour() for learner in group]),
        )
        for delay_ms, group in groups.items()
    ]
    return markdown_table(headings, rows)


def _verdict(groups: Groups) -> str:
    """Return as text whether the results have the same order as the paper's."""
    measures: Mapping[str, Callable[[Learner], float]] = {
        "learning is slower": Learner.last_time_s,
        "trained infants take longer": Learner.reach_time_s,
        "movements are less smooth by spectral arc length": lambda learner: -learner.arc_length(),
        "movements are less smooth by log dimensionless jerk": lambda learner: -learner.jerk(),
    }
    means = {what: [fmean(map(of, group)) for group in groups.values()] for what, of in measures.items()}
    lines = "\n".join(f"- {what}: {'yes' if _rises(rise) else 'not in every case'};" for what, rise in means.items())
    reach_s = fmean(learner.reach_time_s() for group in groups.values() for learner in group)
    stroke = TEXTS["stroke"].format(reach_ms=1000 * reach_s) if reach_s < ms_to_s(max(groups)) else ""
    return f"With increasing delay,\n\n{lines.removesuffix(';')}.\n\n{stroke}"


def _rises(values: Sequence[float]) -> bool:
    return all(before < after for before, after in pairwise(values))


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
FIRST_BALL = 1000
"""Seed of the first ball, which is not the seed of any training run."""
MONTHS: Sequence[float] = (4, 6, 9)
"""Ages of the infants whose reaches are compared with those of real ones."""
REACHES, QUICK_REACHES = 20, 4
"""Number of reaches of each, with each delay."""
REACH_S = 3.0
"""Simulated time after which a reach is given up."""


def run(notebook: Notebook) -> Path:
    """Train infants with each delay (or resume interrupted runs), compare them, and return the path of the report."""
    steps, seeds = (QUICK_STEPS, QUICK_SEEDS) if notebook.quick else (STEPS, SEEDS)
    infants = len(MONTHS) * len(DELAYS)
    total = infants + steps * len(seeds) * len(DELAYS_MS)
    groups = reach_at_ages(
        MONTHS,
        QUICK_REACHES if notebook.quick else REACHES,
        REACH_S,
        lambda done: notebook.progress(done, total),
    )
    write_reaches(notebook, groups)
    learners = list(_learners(notebook, steps, seeds, lambda done: notebook.progress(infants + done, total)))
    _write_tables(notebook, learners)
    notebook.write_plots("delays.png", [_learning_plot(learners), _path_plot(learners), _smoothness_plot(learners)])
    numbers = {"age": AGE_MONTHS, "motor": MOTOR_MS, "steps": steps, "seeds": len(seeds)}
    learning = sections(_by_delay(learners), **numbers, episodes=EPISODES, shown=SHOWN)
    return notebook.write_page(
        "Delays",
        (*learning, *infant_sections(groups, REACH_S)),
        seeds=f"Seeds: {', '.join(map(str, seeds))} for training, {FIRST_BALL} and up for the balls.",
        libraries=["gymnasium", "stable-baselines3", "torch", "matplotlib"],
    )


def _learners(
    notebook: Notebook, steps: int, seeds: Sequence[int], progress: Callable[[int], None]
) -> Iterator[Learner]:
    """Yield each trained infant; each training run has a folder of its own, in which it can be resumed.

    Progress is called with the number of steps done.
    """
    wanted = [(delay_ms, seed) for seed in seeds for delay_ms in DELAYS_MS]
    for number, (delay_ms, seed) in enumerate(wanted):
        bundle = reaching(delay_ms)
        folder = check_unlinked(notebook.folder / f"delay_{delay_ms:g}ms_seed_{seed}", below=notebook.folder)

        def report(done: int, total: int, before: int = number * steps) -> None:
            progress(before + min(done, steps))

        training = train(bundle, folder, steps=steps, seed=seed, progress=report)
        with closing(InfantEnv(bundle)) as env:
            follow = _effector(bundle)
            reaches = evaluate(env, load_policy(training.policy), EPISODES, seed=FIRST_BALL, follow=follow)
        progress((number + 1) * steps)
        yield Learner(delay_ms, seed, training, reaches)


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


def _effector(bundle: Bundle) -> str:
    task = bundle.manifest.task
    assert isinstance(task, ReachEntry)
    return task.effector


def _write_tables(notebook: Notebook, learners: Sequence[Learner]) -> None:
    notebook.write_table(
        "learning.csv",
        ("delay_ms", "seed", "steps", "episodes", "success_rate", "time_s", "episode_return"),
        (
            (item.delay_ms, item.seed, row.steps, row.episodes, row.success_rate, time_s, row.episode_return)
            for item in learners
            for row, time_s in zip(item.training.curve.rows, item.time_s, strict=True)
        ),
    )
    notebook.write_table(
        "reaches.csv",
        ("delay_ms", "seed", "ball", "success", "time_s", "log_dimensionless_jerk", "spectral_arc_length", "detour"),
        (
            (
                item.delay_ms,
                item.seed,
                reach.seed,
                float(reach.success),
                reach.duration_s,
                *smoothness(reach),
                detour(reach),
            )
            for item in learners
            for reach in item.reaches
        ),
    )
    notebook.write_table(
        "paths.csv",
        ("delay_ms", "seed", "ball", "time_s", "x_m", "y_m", "z_m"),
        (
            (item.delay_ms, item.seed, reach.seed, index * reach.duration_s / reach.steps, *place.tolist())
            for item in _of_first_seed(learners)
            for reach in item.reaches[:SHOWN]
            if reach.path_m is not None
            for index, place in enumerate(reach.path_m)
        ),
    )


def _of_first_seed(learners: Sequence[Learner]) -> list[Learner]:
    return [item for item in learners if item.seed == learners[0].seed]


def _by_delay(learners: Sequence[Learner]) -> dict[float, list[Learner]]:
    return {delay_ms: [item for item in learners if item.delay_ms == delay_ms] for delay_ms in DELAYS_MS}


def _label(delay_ms: float) -> str:
    return f"{delay_ms:g} ms"


def _learning_plot(learners: Sequence[Learner]) -> Plot:
    lines, bands = [], []
    for delay_ms, group in _by_delay(learners).items():
        steps, times_s = zip(*(binned_times_s(item.training.curve) for item in group), strict=True)
        middle, low, high = np.mean(times_s, axis=0), np.min(times_s, axis=0), np.max(times_s, axis=0)
        lines.append(Line(steps[0] / 1000, middle, _label(delay_ms)))
        bands.append(Band(steps[0] / 1000, low, high, _label(delay_ms)))
    y = Quantity("time_s", "Time to reach", "s")
    return Plot(replace(TRAINED, unit="thousands"), y, tuple(lines), tuple(bands), title="Learning")


def _path_plot(learners: Sequence[Learner]) -> Plot:
    lines = []
    for item in _of_first_seed(learners):
        with closing(InfantEnv(reaching(item.delay_ms))) as env:
            env.reset(seed=0)
            shoulder = env.data.body("right_upper_arm").xpos.copy()
        for reach in item.reaches[:SHOWN]:
            assert reach.path_m is not None
            ahead, _, up = 100 * (reach.path_m - shoulder).T
            lines.append(Line(ahead, up, _label(item.delay_ms)))
    x, y = Quantity("ahead_cm", "In front of the shoulder", "cm"), Quantity("up_cm", "Above the shoulder", "cm")
    return Plot(x, y, tuple(lines), title="Hand paths", equal=True)


def _smoothness_plot(learners: Sequence[Learner]) -> Plot:
    dots = []
    for delay_ms, group in _by_delay(learners).items():
        lengths = [item.arc_length() for item in group]
        dots.append(Dots([delay_ms] * len(lengths), lengths, _label(delay_ms)))
    x, y = Quantity("delay_ms", "Sensory delay", "ms"), Quantity("sal", "Spectral arc length (higher is smoother)")
    return Plot(x, y, dots=tuple(dots), title="Smoothness")
