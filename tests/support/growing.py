"""Infants that grow: what they are, how they flail, and how deep they sink into something."""

from typing import Any

import mujoco
import numpy as np

import mimoc

DEEPEST_M = 2e-4  # Wanted just after growth, of all contacts of the infant.
SENSES = {"proprioception": {}, "vestibular": {"canals": "age"}}


def spec(age_months: float = 6, **keys: Any) -> mimoc.InfantSpec:
    data = {"mimoc": 1, "name": "infant", "age_months": age_months, "senses": SENSES}
    return mimoc.InfantSpec.model_validate({**data, **keys})


def flail(env: mimoc.InfantEnv, steps: int, seed: int = 0) -> list[dict[str, np.ndarray]]:
    commands = np.random.default_rng(seed).uniform(-1, 1, (steps, *(env.action_space.shape or ())))
    return [env.step(command.astype(np.float32))[0] for command in commands]


def same(first: list[dict[str, np.ndarray]], second: list[dict[str, np.ndarray]]) -> bool:
    return all(np.array_equal(one[name], other[name]) for one, other in zip(first, second, strict=True) for name in one)


def deepest_m(env: mimoc.InfantEnv) -> float:
    model, data = env.model, env.data
    mujoco.mj_fwdPosition(model, data)
    own = model.body_rootid[model.geom_bodyid] == model.body(env.manifest.root_body).id
    depths = [-contact.dist for contact in data.contact if own[contact.geom].any()]
    return max([0.0, *depths])
