"""The scores of a policy in one task at one age: success, return, effort, smoothness and likeness."""

import json
import math
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass, field
from hashlib import sha256
from typing import Any

import numpy as np

from mimoc.base.errors import MovementError
from mimoc.base.units import ms_to_s
from mimoc.bundle.io import LOCK, digests
from mimoc.compiler import pipeline
from mimoc.movement.filming import Film
from mimoc.movement.measured import measure_movement
from mimoc.movement.real_infants import real_infants
from mimoc.movement.sample import distance
from mimoc.policies.policy import start_again
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.sense import FloatArray
from mimoc.schema.base import Model
from mimoc.schema.quantities import Real, Whole
from mimoc.studies.bench.entrant import bound_policy
from mimoc.studies.bench.table import Cell, bench_table
from mimoc.studies.experiments.sensed_reaching import UNIT_M_S, Movement

Z_95 = 1.959963984540054  # Quantile of the standard normal distribution for intervals of 95 %.
WINDOW_S = 2.0
"""Length of the parts of an episode of which each is one movement, since smoothness depends on how many there are."""
NO_GOAL = "free"  # The kind of task that nobody succeeds in.


class CellScores(Model):
    """The scores of a policy in one task at one age; what could not be measured is None."""

    bundle: str
    """Digest of the infant."""
    episodes: Whole
    successes: Whole | None
    """Episodes that succeeded; None for a task without a goal."""
    success: Real | None
    """Their share."""
    success_95: tuple[Real, Real] | None
    """Its interval of 95 % (Wilson)."""
    mean_return: Real
    """Mean over episodes of the sum of rewards."""
    returns: tuple[Real, ...]
    """Sum of rewards of each episode, in the order of the seeds, to compare policies in pairs."""
    effort: Real
    """Mean over control steps of the effort of the actuators."""
    arc_length: Real | None
    """Mean spectral arc length of hands and feet; larger is smoother."""
    jerk: Real | None
    """Mean log dimensionless jerk of hands and feet, with its sign turned; larger is smoother."""
    likeness: Real | None
    """Mean distance to real infants; those are .77 to 1.57 from each other."""
    states: str
    """Digest of all states of all episodes."""


@dataclass
class _Tally:
    """What is gathered over the episodes of a cell."""

    returns: list[float] = field(default_factory=list)
    successes: int = 0
    efforts: list[float] = field(default_factory=list)
    movements: list[Movement] = field(default_factory=list)
    distances: list[float] = field(default_factory=list)
    states: Any = field(default_factory=sha256)


def score_cell(cell: Cell, policy: str, episodes: int) -> CellScores:
    """Return the scores of a policy in the first test episodes; raise a MimocError if it does not fit, or fails."""
    bundle, tally = pipeline.build(cell.spec), _Tally()
    with closing(InfantEnv(bundle)) as env:
        act = bound_policy(env, policy)
        for number in range(episodes):
            seed = bench_table().seeds.test[0] + number
            generator, seen, paths_m = np.random.default_rng(seed), Film(), list[FloatArray]()
            observation, _ = env.reset(seed=seed)
            start_again(act)
            limbs = (*env.manifest.anatomy.arms, *env.manifest.anatomy.legs)
            ends = [env.model.body(limb.end).id for limb in limbs if limb.end]
            total, ended, success = 0.0, False, False
            while not ended:
                if cell.row.likeness:
                    seen.watch(env)
                observation, reward, terminated, truncated, info = env.step(act(generator, observation))
                total, ended, success = total + float(reward), terminated or truncated, bool(info["is_success"])
                tally.efforts.append(env.effort())
                tally.states.update(env.data.qpos.tobytes() + env.data.qvel.tobytes())
                paths_m.append(env.data.xipos[ends].copy())
            tally.returns.append(total)
            tally.successes += success
            step_s, places_m = ms_to_s(env.manifest.step_ms), np.array(paths_m)
            for limb in range(len(ends)):
                tally.movements += movements_in(places_m[:, limb], step_s)
            if cell.row.likeness:
                tally.distances += _distance(seen)
        has_goal = env.manifest.task.kind != NO_GOAL
    count = len(tally.returns)
    inside = digests({name: content for name, content in bundle.files.items() if name != LOCK})
    return CellScores(
        bundle=f"sha256:{sha256(json.dumps(inside).encode()).hexdigest()}",
        episodes=count,
        successes=tally.successes if has_goal else None,
        success=tally.successes / count if has_goal else None,
        success_95=wilson_interval(tally.successes, count) if has_goal else None,
        mean_return=math.fsum(tally.returns) / count,
        returns=tuple(tally.returns),
        effort=math.fsum(tally.efforts) / len(tally.efforts),
        arc_length=_mean([one.arc_length for one in tally.movements]),
        jerk=_mean([one.jerk for one in tally.movements]),
        likeness=_mean(tally.distances),
        states=f"sha256:{tally.states.hexdigest()}",
    )


def wilson_interval(successes: int, count: int) -> tuple[float, float]:
    """Return the interval of 95 % of a share (Wilson 1927, J Am Stat Assoc 22: 209), within 0 and 1.

    (p + z² / 2n ± z √(p (1 - p) / n + z² / 4n²)) / (1 + z² / n), with p = successes / n and z = 1.96.
    """
    share, part = successes / count, Z_95**2 / count
    middle, half = share + part / 2, Z_95 * math.sqrt(share * (1 - share) / count + part / (4 * count))
    low, high = ((middle + sign * half) / (1 + part) for sign in (-1, 1))
    return (0.0 if successes == 0 else low, 1.0 if successes == count else high)


def movements_in(path_m: FloatArray, step_s: float) -> list[Movement]:
    """Return the movements of a hand or a foot, of 2 s each; those slower than 5 cm/s throughout are left out.

    Its places after each control step of an episode have the shape (t, 3). What is left at the end is left out, but for
    an episode that is shorter than 2 s.
    """
    steps = round(WINDOW_S / step_s)
    whole = range(0, len(path_m) - steps, steps)
    parts = [path_m[start : start + steps + 1] for start in whole] or [path_m]
    movements = [Movement(part, step_s) for part in parts if len(part) > 1]
    return [one for one in movements if one.speed_m_s.max() > UNIT_M_S]


def _distance(film: Film) -> list[float]:
    try:
        return [distance(measure_movement(film.develop("episode").seen), real_infants())]
    except MovementError:
        return []


def _mean(values: Sequence[float]) -> float | None:
    """Return the mean of all that are numbers; None if there are none."""
    numbers = [value for value in values if math.isfinite(value)]
    return math.fsum(numbers) / len(numbers) if numbers else None
