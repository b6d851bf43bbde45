"""The policy `general_movements` of one infant, or of many."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from mimoc.base.units import ms_to_s
from mimoc.policies.batch import Batch, batch_of_one
from mimoc.policies.general_movements.generator import GeneralMovements, draw
from mimoc.policies.general_movements.joints import joints_of
from mimoc.policies.general_movements.law import law_at
from mimoc.policies.policy import BatchPolicy, Policy
from mimoc.runtime.env import InfantEnv


def bind(env: InfantEnv) -> Policy:
    """Return the policy for an environment."""
    act = bind_many(batch_of_one(env))
    return lambda generator, observation: act([generator], observation)[0]


def bind_many(batch: Batch) -> BatchPolicy:
    """Return the policy for many infants with the same commands."""
    first, put = batch.infants[0], batch.put
    joints = joints_of(first.manifest.actuation, first.actuation)
    laws = [law_at(env.age_months) for env in batch.infants]
    movement = GeneralMovements(joints, laws, ms_to_s(first.manifest.step_ms), xp=batch.xp, put=put)
    started = []

    def act(generators: Sequence[np.random.Generator], observation: Any) -> Any:
        if not started:
            started.append(True)
            movement.start(put(draw(generators, 0, movement.starts)[1]))
        uniform, normal = draw(generators, movement.uniforms, movement.normals)
        return batch.actions(movement.step(put(uniform), put(normal), batch.arousals()))

    return act
