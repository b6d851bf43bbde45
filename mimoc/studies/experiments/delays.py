"""Effects of delays on reaching: on learning (López et al. 2025, figure 4), and on the movements of infants."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from itertools import pairwise
from operator import methodcaller
from statistics import fmean
from typing import Any

from mimoc.base.quantities import Quantity
from mimoc.base.units import ms_to_s
from mimoc.bundle.io import Bundle
from mimoc.compiler import building
from mimoc.components.tasks.reach import ReachEntry
from mimoc.render.plots import Dots, Line, Plot
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.quantities import EpisodeResult
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import Development
from mimoc.studies.experiment import Experiment, Measured, Table, child
from mimoc.studies.experiments import late_reaches, learner as learning
from mimoc.studies.experiments.late_reaches import DELAYS, DELAYS_MS, MOTOR_MS, VARIANTS
from mimoc.studies.experiments.learner import FIRST_BALL, LIBRARIES, Learner, by_group, mean_and_range, movement_of
from mimoc.studies.notebook import PAGES, Cell, Notebook, table_rows
from mimoc.training import evaluate, load_policy

FAR_BALL, NEAR_BALL = {"kind": "reach", "ball": "mimo"}, {"kind": "reach", "ball": "near"}
SETUPS: Mapping[str, Mapping[str, Any]] = {
    "mimo": {"task": FAR_BALL},
    "near": {"task": NEAR_BALL},
    "near_weak": {"task": NEAR_BALL, "actuation": {"strength": {"arms": 0.2}}},
}
"""Keys of a spec by the name of what is learned; the first is the paper's, of which there is a run for each seed."""
TITLES = ("MIMo's ball", "a near ball", "a near ball, arms of a fifth of the strength")
PAPER = "mimo"  # Key of the paper's setup.
QUICK_VARIANTS = 1  # Number of variants of reaches that the smaller version tries.
AGE_MONTHS = 18
STEPS, QUICK_STEPS = 500_000, 40_960
"""Control steps of each training run: the paper's, and a number that takes minutes."""
SEEDS, QUICK_SEEDS = (1, 2), (1,)
EPISODES = 50  # Number of reaches of each trained infant; all of them reach for the same balls.
MAX_PLOTTED = 4  # Number of balls whose hand paths are plotted, for the infants of the first seed.
MONTHS: Sequence[float] = (4, 6, 9)  # Ages of the infants whose reaches are compared with those of real ones.
REACHES, QUICK_REACHES = 20, 4  # Number of reaches of each, with each delay.
REACH_S = 3.0  # Simulated time after which a reach is given up.

Groups = Mapping[str, Sequence[Learner]]  # Trained infants by their sensory delay, as it is shown, the shortest first.

UNITS, DETOUR = (methodcaller("mean", measure) for measure in ("units", "path_ratio"))
"""Means of a learner's reaches after training."""
ARC_LENGTH, JERK = (methodcaller("median", measure) for measure in ("arc_length", "jerk"))  # Medians of the same.
LESS_SMOOTH: Sequence[tuple[str, str, Callable[[Learner], float]]] = (
    ("more_units", "movement units", UNITS),
    ("longer_path", "path length", DETOUR),
    ("shorter_arc", "spectral arc length", lambda learner: -ARC_LENGTH(learner)),
    ("jerkier", "jerk", lambda learner: -JERK(learner)),
)
"""What is greater where movements are less smooth: key of the page, name and measure."""
MEASURES = (Learner.last_time_s, Learner.success_rate, Learner.time_s, UNITS, DETOUR, ARC_LENGTH, JERK)


@dataclass(frozen=True, slots=True)
class Trained:
    """Infants trained with each delay, and reaches with late senses."""

    law: Development
    steps: int
    seeds: Sequence[int]
    by_setup: Mapping[str, Sequence[Learner]]
    late: late_reaches.Reaches
    reaches: Sequence[late_reaches.Group]

    @property
    def setups(self) -> dict[str, Groups]:
        """Infants with their reaches for balls that are within reach, by setup and delay."""
        within = {name: by_group(_within_reach(same)) for name, same in self.by_setup.items()}
        return {name: {f"{ms} ms": group for ms, group in groups.items()} for name, groups in within.items()}

    @property
    def groups(self) -> Groups:
        """The infants of the paper's setup by delay."""
        return self.setups[PAPER]

    @property
    def first(self) -> list[Learner]:
        """The infants of the first seed in the paper's setup."""
        learners = _within_reach(self.by_setup[PAPER])
        return [item for item in learners if item.seed == learners[0].seed]


def measure(notebook: Notebook) -> Trained:
    """Let infants reach with late senses, and train infants with each delay, or resume interrupted runs."""
    steps, seeds = (QUICK_STEPS, QUICK_SEEDS) if notebook.quick else (STEPS, SEEDS)
    variants = VARIANTS[:QUICK_VARIANTS] if notebook.quick else VARIANTS
    runs = list(_runs(seeds))
    before = len(MONTHS) * len(DELAYS) + len(variants) * len(DELAYS_MS)
    total = before + steps * len(runs)
    count = QUICK_REACHES if notebook.quick else REACHES
    counted = notebook.counter(total)
    late = late_reaches.reach_with_variants(variants, notebook.law, count, REACH_S, counted)
    reaches = late_reaches.reach_at_ages(MONTHS, count, REACH_S, counted)
    by_setup = _learners(notebook, steps, runs, before, total)
    return Trained(notebook.law, steps, seeds, by_setup, late, reaches)


def _numbers(found: Trained) -> dict[str, object]:
    groups = found.groups
    *others, longest = groups
    worse = {"slower": Learner.last_time_s, "longer": Learner.time_s} | {name: one for name, _, one in LESS_SMOOTH}
    return {
        "age": AGE_MONTHS,
        "delays": f"{', '.join(others)} and {longest}",
        "motor": MOTOR_MS,
        "steps": found.steps,
        "seeds": len(found.seeds),
        "episodes": EPISODES,
        "beyond": EPISODES - len(found.first[0].reaches),
        "shown": MAX_PLOTTED,
        "table": table_rows(
            (delay, *(mean_and_range(group, measure) for measure in MEASURES)) for delay, group in groups.items()
        ),
        **{name: "yes" if _rising(groups, measure) else "not in every case" for name, measure in worse.items()},
        "setups": _setups_rows(found.setups),
        "setups_seed": found.seeds[0],
        "longest_s": ms_to_s(max(DELAYS_MS)),
        "ataxia": late_reaches.ataxia_text(found.late, REACH_S),
        "infants": late_reaches.infants_text(found.reaches, REACH_S),
        "training_seeds": ", ".join(map(str, found.seeds)),
        "first_ball": FIRST_BALL,
    }


def infants(law: Development) -> Iterator[Bundle | InfantSpec]:
    """Yield those that learn, and those whose reaches are late; delays are not of the body."""
    yield from (reaching(law, DELAYS_MS[0], setup) for setup in SETUPS)
    by_body = {(item.age_months, item.strength, item.other_law): item for item in VARIANTS}
    yield from (late_reaches.ataxic_infant(variant, law, DELAYS_MS[0]) for variant in by_body.values())
    yield from (late_reaches.infant_of_age(age_months, delay) for age_months in MONTHS for delay in list(DELAYS)[:1])


def _runs(seeds: Sequence[int]) -> Iterator[tuple[str, float, int]]:
    """Yield setup, delay and seed of each training run: of setups but the paper's, extreme delays and one seed."""
    yield from ((PAPER, delay_ms, seed) for seed in seeds for delay_ms in DELAYS_MS)
    extremes = DELAYS_MS[0], DELAYS_MS[-1]
    yield from ((setup, delay_ms, seeds[0]) for setup in SETUPS if setup != PAPER for delay_ms in extremes)


def _learners(
    notebook: Notebook, steps: int, runs: Sequence[tuple[str, float, int]], before: int, total: int
) -> Mapping[str, Sequence[Learner]]:
    learners: dict[str, list[Learner]] = {setup: [] for setup, _, _ in runs}
    for number, (setup, delay_ms, seed) in enumerate(runs):
        bundle = reaching(notebook.law, delay_ms, setup)
        progress = notebook.part(before + number * steps, steps, total)
        training = learning.trained(notebook, f"{setup}_{delay_ms:g}ms_seed_{seed}", bundle, steps, progress, seed=seed)
        task = bundle.manifest.task
        assert isinstance(task, ReachEntry)
        with closing(InfantEnv(bundle)) as env:
            reaches = evaluate(env, load_policy(training.policy), EPISODES, seed=FIRST_BALL, follow=task.effector)
        learners[setup].append(Learner(f"{delay_ms:g}", seed, training, reaches))
    return learners


def reaching(development: Development, delay_ms: float, setup: str = PAPER) -> Bundle:
    """Return the infant of a setup, with the given delay of all its senses."""
    keys = {
        "development": development,
        "senses": {"proprioception": {"include": ["velocity"]}},
        "delays": {"sensory_ms": float(delay_ms), "motor_ms": MOTOR_MS},
        **SETUPS[setup],
    }
    return building.build(child("reaching", AGE_MONTHS, **keys))


def _within_reach(learners: Sequence[Learner]) -> list[Learner]:
    """Return infants with their reaches for balls that one of them touches; with all, if there is no such ball."""
    touched = {reach.seed for item in learners for reach in item.reaches if reach.success}
    return [
        replace(item, reaches=[reach for reach in item.reaches if not touched or reach.seed in touched])
        for item in learners
    ]


def _rising(groups: Groups, measure: Callable[[Learner], float]) -> bool:
    means = [fmean(map(measure, group)) for group in groups.values()]
    return all(before < after for before, after in pairwise(means))


def _less_smooth(groups: Groups) -> str:
    """Return whether movements are less smooth with each longer delay by every measure, or by which measures."""
    by = [name for _, name, measure in LESS_SMOOTH if _rising(groups, measure)]
    if len(by) == len(LESS_SMOOTH):
        return "yes"
    return f"by {' and '.join(by)} only" if by else "no"


def _longer(groups: Groups, measure: Callable[[Learner], float]) -> str:
    """Return whether a measure is greater with each longer delay, or with which it is greater than with the least."""
    shortest, *longer = ((delay, fmean(map(measure, group))) for delay, group in groups.items())
    greater = [delay for delay, mean in longer if mean > shortest[1]]
    return "yes" if _rising(groups, measure) else f"with {' and '.join(greater)} only" if greater else "no"


def _measured(groups: Groups) -> Measured:
    success = min(learner.success_rate() for group in groups.values() for learner in group)
    return {
        "infants learn more slowly with each longer delay": _longer(groups, Learner.last_time_s),
        "movements are less smooth with each longer delay": _less_smooth(groups),
        "all delays: balls are reached after training": "yes" if success == 1 else f"{success:.0%} or more",
    }


def _setups_rows(setups: Mapping[str, Groups]) -> str:
    """Return the first measures by extreme delays, and how many reaches end before the longest one has passed."""
    titles, rows = dict(zip(SETUPS, TITLES, strict=True)), []
    for setup, groups in setups.items():
        shortest, *_, longest = groups
        for delay in (shortest, longest):
            learner = groups[delay][0]
            early = fmean(reach.duration_s <= ms_to_s(max(DELAYS_MS)) for reach in learner.reaches)
            measures = (f"{measure(learner):.3f}" for measure in MEASURES[:5])
            rows.append((titles[setup], delay, *measures, f"{early:.0%}"))
    return table_rows(rows)


def _learning(found: Trained) -> Table:
    return "setup,delay_ms,seed,steps,episodes,success_rate,time_s,episode_return", (
        (setup, item.group, item.seed, steps, *cells)
        for setup, learners in found.by_setup.items()
        for item in learners
        for steps, cells in item.learning()
    )


def _reaches(found: Trained) -> Table:
    measures = "movement_units,log_dimensionless_jerk,spectral_arc_length,detour"
    return f"setup,delay_ms,seed,ball,success,time_s,{measures}", (
        (setup, item.group, item.seed, *_reach_cells(reach))
        for setup, learners in found.by_setup.items()
        for item in learners
        for reach in item.reaches
    )


def _paths(found: Trained) -> Table:
    return "delay_ms,seed,ball,time_s,x_m,y_m,z_m", (
        (item.group, item.seed, reach.seed, index * reach.duration_s / reach.steps, *place)
        for item in found.first
        for reach in item.reaches[:MAX_PLOTTED]
        for index, place in enumerate(movement_of(reach).path_m.tolist())
    )


def _reach_cells(reach: EpisodeResult) -> tuple[Cell, ...]:
    movement = movement_of(reach)
    smoothness = (movement.units, movement.jerk, movement.arc_length, movement.path_ratio)
    return (reach.seed, float(reach.success), reach.duration_s, *smoothness)


def _smoothness_plot(groups: Groups) -> Plot:
    dots = [
        Dots([float(item.group) for item in group], list(map(UNITS, group)), label) for label, group in groups.items()
    ]
    x = Quantity("delay_ms", "Sensory delay", "ms")
    y = Quantity("units", "Movement units in a reach, mean")
    return Plot(x, y, dots=tuple(dots), title="Smoothness")


def _plots(found: Trained) -> list[Plot]:
    curves = learning.learning_plot(found.groups, Quantity("time_s", "Time to reach", "s"), "Learning")
    lines = []
    for item in found.first:
        with closing(InfantEnv(reaching(found.law, float(item.group)))) as env:
            env.reset(seed=0)
            shoulder = env.data.body("right_upper_arm").xpos.copy()
        for reach in item.reaches[:MAX_PLOTTED]:
            ahead, _, up = 100 * (movement_of(reach).path_m - shoulder).T
            lines.append(Line(ahead, up, f"{item.group} ms"))
    x = Quantity("ahead_cm", "In front of the shoulder", "cm")
    y = Quantity("up_cm", "Above the shoulder", "cm")
    return [curves, Plot(x, y, tuple(lines), title="Hand paths", equal=True), _smoothness_plot(found.groups)]


EXPERIMENT = Experiment(
    name="delays",
    measure=measure,
    files={
        "ataxia.csv": lambda found: late_reaches.ataxia_table(found.late),
        "ataxia.png": lambda found: late_reaches.ataxia_plots(found.late),
        "infants.csv": lambda found: late_reaches.infants_table(found.reaches),
        "infants.png": lambda found: late_reaches.infants_plots(found.reaches),
        "learning.csv": _learning,
        "reaches.csv": _reaches,
        "paths.csv": _paths,
        "delays.png": _plots,
    },
    page=PAGES / "delays.md",
    numbers=_numbers,
    measured=lambda found: _measured(found.groups),
    libraries=LIBRARIES,
    infants=infants,
    development="published",
)
