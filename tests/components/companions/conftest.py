"""Infants with a caregiver."""

from collections.abc import Callable, Iterator
from contextlib import closing
from typing import Any

import numpy as np
import pytest

import mimoc


def with_caregiver(caregiver: dict[str, Any] | None = None, age_months: float = 4, **keys: Any) -> mimoc.InfantSpec:
    """Return the spec of an infant on its back with a caregiver."""
    scene = {"pose": "supine", **keys.pop("scene", {}), "caregiver": caregiver or {}}
    return mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "x", "age_months": age_months, "scene": scene, **keys})


@pytest.fixture
def cared_for() -> Iterator[Callable[..., mimoc.InfantEnv]]:
    """Return what opens the environment of an infant with a caregiver, reset with seed 0."""
    opened = []

    def give(caregiver: dict[str, Any] | None = None, **keys: Any) -> mimoc.InfantEnv:
        env = mimoc.make(with_caregiver(caregiver, **keys)).unwrapped
        env.reset(seed=0)
        opened.append(env)
        return env

    yield give
    for env in opened:
        with closing(env):
            pass


def move(env: mimoc.InfantEnv, seconds: float, strength: float = 0.0, seed: int = 0) -> np.ndarray:
    """Let time pass under random actions of some strength; return the joints and mocap bodies then."""
    generator = np.random.default_rng(seed)
    for _ in range(round(1000 * seconds / env.manifest.step_ms)):
        env.step((strength * generator.uniform(-1, 1, env.action_space.shape)).astype(np.float32))
    return np.concatenate([env.data.qpos, env.data.mocap_pos.ravel(), env.data.mocap_quat.ravel()])


KICK_S = 0.8


def kick(env: mimoc.InfantEnv, seconds: float) -> None:
    """Let an infant bend and stretch its legs with all its strength, once each .8 s."""
    names = [env.model.actuator(int(index)).name for index in env.actuation.actuators]
    legs = np.array([name.endswith(("_hip_flex", "_knee")) for name in names])
    for _ in range(round(1000 * seconds / env.manifest.step_ms)):
        sign = 1.0 if env.data.time % KICK_S > KICK_S / 2 else -1.0
        env.step((sign * legs).astype(np.float32))
