"""How often parts of an infant's own body touch each other."""

import numpy as np

from mimoc.runtime.env import InfantEnv


class SelfContacts:
    """Counts the contacts between parts of the own body after each control step."""

    def __init__(self, env: InfantEnv):
        """Begin to count.

        Args:
            env: The environment.
        """
        self._env, self._steps, self._contacts = env, 0, 0

    def count(self) -> None:
        """Count the contacts of this moment."""
        model, contact = self._env.model, self._env.data.contact
        own = model.body_rootid[model.geom_bodyid] == model.body(self._env.manifest.root_body).rootid
        pairs = contact.geom.reshape(-1, 2)
        self._contacts += int(np.count_nonzero((pairs >= 0).all(axis=1) & own[pairs].all(axis=1)))
        self._steps += 1

    @property
    def mean(self) -> float:
        """Mean number of contacts per control step."""
        return self._contacts / max(self._steps, 1)
