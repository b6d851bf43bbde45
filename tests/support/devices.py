"""Infants on MuJoCo Warp: on its CPU device, or on a GPU if `MIMOC_TEST_DEVICE` says so.

Warp compiles its kernels once for each kind of model, so tests share few of these.
"""

import os
from collections.abc import Mapping
from typing import Any

import numpy as np
from support import store

import mimoc

DEVICE = os.environ.get("MIMOC_TEST_DEVICE", "warp:cpu")  # As `mimoc.make_vec` takes it.
WARP_DEVICE = DEVICE.removeprefix("warp:")  # The same, as Warp calls it.
CLOSE = 1e-4  # Difference of angles [rad] that is left between MuJoCo and MuJoCo Warp after some steps.

SENSES = {"proprioception": {"include": ["velocity", "torque", "limits", "actuation"]}, "vestibular": {}}
FEELING = {**SENSES, "touch": {"density": 0.5}}
SITTING = {"kind": "flat", "pose": "sitting"}


def spec(age_months: float = 9, **keys: Any) -> mimoc.InfantSpec:
    data = {"mimoc": 1, "name": "infant", "age_months": age_months, "senses": SENSES, **keys}
    return mimoc.InfantSpec.model_validate(data)


def infant(age_months: float = 9, **keys: Any) -> mimoc.Bundle:
    return store.built(spec(age_months, **keys))


def sitting(age_months: float = 9, **keys: Any) -> mimoc.Bundle:
    """Return an infant that sits, and feels with its skin."""
    return infant(age_months, **{"senses": FEELING, "scene": SITTING, **keys})


def random_actions(envs: Any, generator: np.random.Generator) -> np.ndarray:
    space = envs.single_action_space
    return generator.uniform(space.low, space.high, envs.action_space.shape).astype(np.float32)


def still(envs: Any) -> np.ndarray:
    return np.zeros(envs.action_space.shape, np.float32)


def break_down(envs: Any) -> None:
    """Let the first infant be so fast that its simulation becomes unstable."""
    speeds = envs.worlds.data.qvel.numpy()
    speeds[0] = 1e12
    envs.worlds.data.qvel.assign(speeds)


def assert_close(
    ours: Mapping[str, Any], theirs: Mapping[str, Any], infant: Any, limit: float = CLOSE, others: float = 30 * CLOSE
) -> None:
    """Compare observations: angles in [rad]; other quantities relatively, if they are large, by another limit."""
    for name, values in theirs.items():
        errors = np.abs(ours[name] - values) / np.maximum(1.0, np.abs(values))
        layout = infant.layout(name) if name == "proprioception" else ()
        angles = [index for index, number in enumerate(layout) if number.endswith("[rad]")]
        assert errors[:, angles].max(initial=0.0) < limit, name
        assert errors.max() < max(others, 30 * limit), name
