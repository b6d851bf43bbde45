"""Infants that grow: what they are, and how deep they sink into something."""

from typing import Any

import mujoco

import mimoc

DEEPEST_M = 2e-4  # Wanted just after growth, of all contacts of the infant.
SENSES = {"proprioception": {}, "vestibular": {"canals": "age"}}


def spec(age_months: float = 6, **keys: Any) -> mimoc.InfantSpec:
    data = {"mimoc": 1, "name": "infant", "age_months": age_months, "senses": SENSES}
    return mimoc.InfantSpec.model_validate({**data, **keys})


def deepest_m(env: mimoc.InfantEnv) -> float:
    model, data = env.model, env.data
    mujoco.mj_fwdPosition(model, data)
    own = model.body_rootid[model.geom_bodyid] == model.body(env.manifest.root_body).id
    depths = [-contact.dist for contact in data.contact if own[contact.geom].any()]
    return max([0.0, *depths])
