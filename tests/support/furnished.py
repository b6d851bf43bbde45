"""Infants among furniture: their model and their state at the start, and what becomes of it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

import mimoc
from mimoc.bundle.model import load_model

PLAIN = {"skin": False}


@dataclass(frozen=True)
class Furnished:
    bundle: mimoc.Bundle
    model: mujoco.MjModel
    data: mujoco.MjData

    def deepest_m(self) -> float:
        """Return the depth of the deepest contact, in [m]."""
        return float(-self.data.contact.dist.min(initial=0.0))

    def place(self, *bodies: str) -> np.ndarray:
        """Return where the centres of mass of some bodies are, shape (n, 3), [m]."""
        return np.array([self.data.body(name).xipos.copy() for name in bodies])

    def run(self, seconds: float) -> None:
        """Let time pass without commands; MuJoCo has nothing to warn of."""
        for _ in range(round(seconds / self.model.opt.timestep)):
            mujoco.mj_step(self.model, self.data)
        assert not self.data.warning.number.any()

    def moved_m(self, seconds: float, *bodies: str) -> float:
        """Return how far some bodies are from where they were after a while, the farthest, in [m]."""
        before = self.place(*bodies)
        self.run(seconds)
        return float(np.linalg.norm(self.place(*bodies) - before, axis=1).max())


def spec_with(objects: Sequence[dict[str, Any]], age_months: float = 9, **others: Any) -> mimoc.InfantSpec:
    """Return the spec of an infant among some objects; others are keys of its scene, or its sections."""
    scene = {key: others.pop(key) for key in ("kind", "pose", "start_at", "held", "room", "seed") if key in others}
    data = {"mimoc": 1, "name": "x", "age_months": age_months, "body": {**PLAIN, **others.pop("body", {})}, **others}
    return mimoc.InfantSpec.model_validate({**data, "scene": {**scene, "objects": list(objects)}})


def furnished(objects: Sequence[dict[str, Any]], age_months: float = 9, **others: Any) -> Furnished:
    bundle = mimoc.build(spec_with(objects, age_months, **others))
    model = load_model(bundle)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(bundle.manifest.pose).id)
    mujoco.mj_forward(model, data)
    return Furnished(bundle, model, data)
