"""Counting contacts, whose number changes, so that no term can say it."""

from collections.abc import Callable

import numpy as np

from mimoc.runtime.env import InfantEnv


def contacts_self(env: InfantEnv) -> Callable[[], float]:
    """Return a function that counts the contacts of this moment between parts of the infant's own body."""

    def count() -> float:
        model = env.model
        is_own = model.body_rootid[model.geom_bodyid] == model.body(env.manifest.root_body).rootid
        pairs = env.data.contact.geom.reshape(-1, 2)
        return int(np.count_nonzero((pairs >= 0).all(axis=1) & is_own[pairs].all(axis=1)))

    return count
