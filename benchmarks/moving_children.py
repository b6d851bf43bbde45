"""Children of drawn ages and sizes who move by mimoc's policies, in physics: nothing that a fit assumes made them move.

Four kinds: general movements; kicks at drawn rates and sizes; rolls to the side or over; reaches of one hand to a drawn
place, among general movements.
"""

from collections.abc import Callable
from contextlib import closing

import mujoco
import numpy as np
from known_motions import FloatArray, random_child

from mimoc.policies.rollout import Run
from mimoc.runtime.opening import open_infant
from mimoc.schema.infant import InfantSpec

RATE_HZ = 25.0
SKIPPED_S = 0.5  # Beginning of an episode that is left out, in which an infant falls to rest.


def _kick(draw: np.random.Generator) -> str:
    return f"kick:rate_per_min={draw.uniform(20, 50):.0f},hip_deg={draw.uniform(30, 60):.0f}"


def _reach(draw: np.random.Generator) -> str:
    side, sign = ("left", 1) if draw.random() < 0.5 else ("right", -1)
    x, y, z = draw.uniform(0.02, 0.2), sign * draw.uniform(-0.05, 0.15), draw.uniform(0.1, 0.25)
    return f"general_movements+reach_for:({x:.2f}, {y:.2f}, {z:.2f}),{side}"


KINDS: dict[str, tuple[tuple[float, float], Callable[[np.random.Generator], str]]] = {
    "general movements": ((0.0, 5.0), lambda draw: "general_movements"),
    "kicks": ((1.0, 9.0), _kick),
    "rolls": ((3.0, 9.0), lambda draw: "skill:roll"),
    "reaches": ((3.0, 12.0), _reach),
}
"""Range of ages in months, and the policy, of each kind."""


def moving_child(kind: str, seed: int, seconds: float) -> tuple[InfantSpec, mujoco.MjModel, FloatArray]:
    """Return a child, its model and its motion at 25 frames/s, shape (t, nq)."""
    draw = np.random.default_rng([seed, list(KINDS).index(kind)])
    ages, policy = KINDS[kind]
    spec = random_child(draw).with_(age_months=round(float(draw.uniform(*ages)), 1))
    with closing(open_infant(spec)) as env:
        run, qpos, times_s = Run(env, policy(draw), seed), [], []
        while not times_s or times_s[-1] < SKIPPED_S + seconds:
            run.step()
            times_s.append(float(env.data.time))
            qpos.append(env.data.qpos.copy())
        model = env.model
    frames_s = SKIPPED_S + np.arange(round(seconds * RATE_HZ)) / RATE_HZ
    return spec, model, np.array(qpos)[np.searchsorted(times_s, frames_s - 1e-9)]
