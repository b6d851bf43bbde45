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
from mimoc.runtime.infant import Infant


class Moving:
    """Moves infants with the same commands by themselves, as the law of their age and their arousal say.

    The style of each is drawn from its generator in the first step. It stays, also when the infant grows, and movement
    goes on through episodes: what an infant does does not depend on what it senses.
    """

    def __init__(self, batch: Batch):
        first, self._batch = batch.infants[0], batch
        self._ages, step_s = (
            [infant.manifest.child.corrected_age_months for infant in batch.infants],
            ms_to_s(first.manifest.step_ms),
        )
        joints, laws = joints_of(first.manifest.actuation, first.actuation), [law_at(age) for age in self._ages]
        self._movement = GeneralMovements(joints, laws, step_s, xp=batch.xp, put=batch.put)
        self._started = False

    @property
    def movement(self) -> GeneralMovements:
        """What gives their commands."""
        return self._movement

    def __call__(self, generators: Sequence[np.random.Generator], observation: Any) -> Any:
        """Return the actions of the next control step, shape (k, n)."""
        movement, batch, put = self._movement, self._batch, self._batch.put
        ages = [infant.manifest.child.corrected_age_months for infant in batch.infants]
        if not self._started:
            movement.start(put(draw(generators, 0, movement.starts)[1]))
            self._started = True
        if ages != self._ages:
            movement.set_laws([law_at(age) for age in ages])
            self._ages = ages
        uniform, normal = draw(generators, movement.uniforms, movement.normals)
        return batch.actions(movement.step(put(uniform), put(normal), batch.arousals()))


def bind(env: Infant) -> Policy:
    """Return the policy for an environment; see `Moving`."""
    act = bind_many(batch_of_one(env))
    return lambda generator, observation: act([generator], observation)[0]


def bind_many(batch: Batch) -> BatchPolicy:
    """Return the policy for many infants with the same commands; see `Moving`."""
    return Moving(batch)
