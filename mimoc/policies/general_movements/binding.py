"""The policy `general_movements` of one infant, or of many."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from mimoc.base.units import ms_to_s
from mimoc.policies.general_movements.generator import GeneralMovements, draw
from mimoc.policies.general_movements.joints import joints_of
from mimoc.policies.general_movements.law import law_at
from mimoc.policies.policy import BatchPolicy, Policy
from mimoc.runtime.env import InfantEnv


def bind(env: InfantEnv) -> Policy:
    """Return the policy for an environment."""
    act = bind_many([env])
    return lambda generator, observation: act([generator], observation)[0]


def bind_many(envs: Sequence[InfantEnv]) -> BatchPolicy:
    """Return the policy for the infants of several environments with the same commands."""
    first = envs[0]
    joints = joints_of(first.manifest.actuation, first.actuation)
    laws = [law_at(env.age_months) for env in envs]
    movement, started = GeneralMovements(joints, laws, ms_to_s(first.manifest.step_ms)), []

    def act(generators: Sequence[np.random.Generator], observation: Any) -> np.ndarray:
        if not started:
            started.append(True)
            movement.start(draw(generators, 0, movement.starts)[1])
        arousal = np.array([[env.arousal] for env in envs])
        return movement.step(*draw(generators, movement.uniforms, movement.normals), arousal).astype(np.float32)

    return act
