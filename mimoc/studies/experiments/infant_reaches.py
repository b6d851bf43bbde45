"""Reaches of infants of several ages with several delays, with the noise of their age."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from typing import Any

import numpy as np

from mimoc.compiler import pipeline
from mimoc.quantities import Quantity
from mimoc.quantities.child import AGE
from mimoc.render.plots.plot import Line, Plot
from mimoc.runtime.env import InfantEnv
from mimoc.schema.infant import InfantSpec
from mimoc.studies.experiments.notebook import Notebook
from mimoc.studies.experiments.sensed_reaching import Reach, reach_once

OWN = "physiological"
"""The delays of the infant's age."""
DELAYS: Mapping[str, Mapping[str, Any]] = {
    "none": {},
    OWN: {"preset": OWN},
    "100 ms": {"preset": OWN, "sensory_ms": 100.0},
    "200 ms": {"preset": OWN, "sensory_ms": 200.0},
}
"""By name, as in a spec; the longer ones are those of the senses, with the commands' own of the age."""
NOISE: Mapping[str, Any] = {"motor": "maturing", "proprioception_deg": 1.0}
JITTER_MS = 5.0
"""Noise of all infants; jitter for those with delays. One degree and one physics step are guesses."""
SEED = 1
"""Seed of the targets, which are in the same directions at all ages."""


@dataclass(frozen=True, slots=True)
class Group:
    """The reaches of an infant of an age, with a delay."""

    age_months: float
    delay: str
    """Key of `DELAYS`."""
    sensory_ms: float
    """Delay of proprioception of the arm."""
    reaches: Sequence[Reach]

    def median(self, measure: Callable[[Reach], float]) -> float:
        """Return the median of a measure over all reaches, those that did not arrive included."""
        return float(np.nanmedian([measure(reach) for reach in self.reaches]))

    @property
    def arrived(self) -> float:
        """Fraction of the reaches that arrived."""
        return float(np.mean([reach.arrived for reach in self.reaches]))


MEASURES: Mapping[str, Callable[[Reach], float]] = {
    "duration_s": lambda reach: reach.duration_s,
    "mean_speed_m_s": lambda reach: float(reach.speed_m_s.mean()),
    "peak_speed_m_s": lambda reach: float(reach.speed_m_s.max()),
    "movement_units": lambda reach: reach.units,
    "path_ratio": lambda reach: reach.path_ratio,
    "spectral_arc_length": lambda reach: reach.arc_length,
    "log_dimensionless_jerk": lambda reach: reach.jerk,
}
"""Measures of a reach by the heading of their column."""


def infant(age_months: float, delay: str) -> InfantSpec:
    """Return an infant that sits with its hip held, moves its right arm and has the noise of its age."""
    return InfantSpec.model_validate(
        {
            "mimoc": 1,
            "name": "reaching",
            "age_months": age_months,
            "actuation": {"regions": ["right_arm"], "locked": ["trunk", "neck"]},
            "senses": {"proprioception": {"include": ["velocity"]}},
            "delays": dict(DELAYS[delay]),
            "noise": {**NOISE, **({"delay_jitter_ms": JITTER_MS} if DELAYS[delay] else {})},
            "scene": {"kind": "flat", "pose": "sitting", "held": ["hip"]},
        }
    )


def reach_at_ages(months: Sequence[float], count: int, most_s: float, progress: Callable[[int], None]) -> list[Group]:
    """Let infants of some ages reach with each delay, for the same number of targets.

    Args:
        months: Ages, in months.
        count: Number of reaches of each infant.
        most_s: Simulated time after which a reach is given up.
        progress: Called with the number of infants done.
    """
    groups = []
    for age_months in months:
        for delay in DELAYS:
            generator = np.random.default_rng(SEED)
            with closing(InfantEnv(pipeline.build(infant(age_months, delay)))) as env:
                reaches = [reach_once(env, seed, generator, most_s) for seed in range(count)]
                sensory_ms = env.manifest.delays.proprioception.ms
            groups.append(Group(age_months, delay, sensory_ms, reaches))
            progress(len(groups))
    return groups


def write_reaches(notebook: Notebook, groups: Sequence[Group]) -> None:
    """Write `infants.csv` and `infants.png`."""
    notebook.write_table(
        "infants.csv",
        ("age_months", "delay", "reach", "arrived", "distance_m", *MEASURES),
        (
            (group.age_months, group.delay, index, float(reach.arrived), reach.distance_m, *_measured(reach))
            for group in groups
            for index, reach in enumerate(group.reaches)
        ),
    )
    onset, speed = Quantity("time_s", "Time since onset", "s"), Quantity("speed_m_s", "Speed of the hand", "m/s")
    units, ratio = Quantity("movement_units", "Movement units"), Quantity("path_ratio", "Path length / distance")
    plots = [
        Plot(onset, speed, tuple(_speeds(groups)), title="One reach"),
        Plot(AGE, units, tuple(_by_age(groups, "movement_units")), title="Movement units"),
        Plot(AGE, ratio, tuple(_by_age(groups, "path_ratio")), title="Straightness"),
    ]
    notebook.write_plots("infants.png", plots)


def by_delay(groups: Sequence[Group]) -> dict[str, list[Group]]:
    """Return the groups of each delay, by age."""
    return {delay: [group for group in groups if group.delay == delay] for delay in DELAYS}


def _measured(reach: Reach) -> Iterator[float]:
    for measure in MEASURES.values():
        yield measure(reach)


def _speeds(groups: Sequence[Group]) -> Iterator[Line]:
    """Yield the speed in the reach of median duration of the youngest infant, with each delay."""
    for group in groups:
        if group.age_months == groups[0].age_months:
            durations_s = [reach.duration_s for reach in group.reaches]
            reach = group.reaches[int(np.argsort(durations_s)[len(durations_s) // 2])]
            yield Line(reach.step_s * np.arange(len(reach.speed_m_s)), reach.speed_m_s, group.delay)


def _by_age(groups: Sequence[Group], measure: str) -> Iterator[Line]:
    for delay, same in by_delay(groups).items():
        medians = [group.median(MEASURES[measure]) for group in same]
        yield Line([group.age_months for group in same], medians, delay, "marked")
