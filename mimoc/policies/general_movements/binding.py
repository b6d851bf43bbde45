"""The policy `general_movements` of one infant, or of many."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.base.units import ms_to_s
from mimoc.policies.general_movements.generator import GeneralMovements, draw
from mimoc.policies.general_movements.joints import joints_of
from mimoc.policies.general_movements.law import law_at
from mimoc.policies.policy import BatchPolicy, Policy
from mimoc.runtime.env import InfantEnv


class Moving:
    """Moves infants with the same commands by themselves, as the law of their age and their arousal say.

    The style of each is drawn from its generator in the first step. It stays, also when the infant grows, and movement
    goes on through episodes: what an infant does does not depend on what it senses.
    """

    def __init__(self, envs: Sequence[InfantEnv]):
        """Bind it to infants."""
        first = envs[0]
        self._envs, self._ages = envs, [env.age_months for env in envs]
        self._joints = joints_of(first.manifest.actuation, first.actuation)
        laws = [law_at(age) for age in self._ages]
        self._movement = GeneralMovements(self._joints, laws, ms_to_s(first.manifest.step_ms))
        self._started = False

    def __call__(self, generators: Sequence[np.random.Generator], observation: Any) -> npt.NDArray[np.float32]:
        """Return the actions of the next control step, shape (k, n)."""
        movement, ages = self._movement, [env.age_months for env in self._envs]
        if not self._started:
            movement.start(draw(generators, 0, movement.starts)[1])
            self._started = True
        if ages != self._ages:
            movement.set_laws([law_at(age) for age in ages])
            self._ages = ages
        arousal = np.array([[env.arousal] for env in self._envs])
        return movement.step(*draw(generators, movement.uniforms, movement.normals), arousal).astype(np.float32)


def bind(env: InfantEnv) -> Policy:
    """Return the policy for an environment; see `Moving`."""
    act = bind_many([env])
    return lambda generator, observation: act([generator], observation)[0]


def bind_many(envs: Sequence[InfantEnv]) -> BatchPolicy:
    """Return the policy for the infants of several environments with the same commands; see `Moving`."""
    return Moving(envs)
