"""Infants with objects in their scenes."""

from typing import Any

import mujoco
import numpy as np
from support import store

import mimoc
from mimoc.bundle.model import load_posed

TOUCH_M = 1.5e-4  # Penetration of what lies on something.


def spec_with(*objects: dict[str, Any], age_months: float = 6, kind: str = "flat", **scene: Any) -> dict[str, Any]:
    return {
        "mimoc": 1,
        "name": "infant",
        "age_months": age_months,
        "body": {"skin": False},
        "scene": {"kind": kind, "objects": list(objects), **scene},
    }


def built_with(*objects: dict[str, Any], **keys: Any) -> mimoc.Bundle:
    return store.built(spec_with(*objects, **keys))


def started(bundle: mimoc.Bundle, pose: str | None = None) -> tuple[mujoco.MjModel, mujoco.MjData]:
    return load_posed(bundle, pose)


def deepest_m(bundle: mimoc.Bundle, model: mujoco.MjModel, data: mujoco.MjData) -> float:
    roots = [model.body(item.body).id for item in bundle.manifest.objects]
    pairs = model.body_rootid[model.geom_bodyid[data.contact.geom]]
    return float(-data.contact.dist[np.isin(pairs, roots).any(axis=1)].min(initial=0.0))


def drift_m(bundle: mimoc.Bundle, model: mujoco.MjModel, data: mujoco.MjData, seconds: float = 0.5) -> float:
    """Return how far a body of an object moves at most in the next half second.

    A cylinder on a box trembles: MuJoCo finds one contact between them at a time.
    """
    roots = [model.body(item.body).id for item in bundle.manifest.objects]
    bodies = np.isin(model.body_rootid, roots)
    before_m, farthest_m = data.xipos[bodies].copy(), 0.0
    for _ in range(round(seconds / model.opt.timestep)):
        mujoco.mj_step(model, data)
        farthest_m = max(farthest_m, float(np.abs(data.xipos[bodies] - before_m).max(initial=0.0)))
    return farthest_m


def fastest_m_s(bundle: mimoc.Bundle, model: mujoco.MjModel, data: mujoco.MjData) -> float:
    roots = [model.body(item.body).id for item in bundle.manifest.objects]
    speed, speeds_m_s = np.zeros(6), [0.0]
    for body in np.flatnonzero(np.isin(model.body_rootid, roots)):
        mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_BODY, int(body), speed, 0)
        speeds_m_s.append(float(np.linalg.norm(speed[3:])))
    return max(speeds_m_s)
