"""Infants that run, each built once: those of `configs/`, and those of a spec given as keywords."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from support import store

import mimoc
from mimoc.schema.kinds import SKILLS

CONFIGS = sorted(  # One skill stands for all, which begin otherwise and have other entries, but no other MJCF.
    path
    for path in (Path(__file__).parents[2] / "configs").glob("*.yaml")
    if path.stem not in SKILLS or path.stem == "cruise"
)
SENSES = {"proprioception": {}, "vestibular": {}}


def build(**keys: Any) -> mimoc.Bundle:
    spec = {"mimoc": 1, "name": "infant", "age_months": 9, "senses": SENSES}
    return store.built({**spec, **keys})


def actions(env: Any, count: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-1, 1, (count, *env.action_space.shape)).astype(np.float32)


def flail(env: Any, steps: int, seed: int = 0) -> list[dict[str, np.ndarray]]:
    """Return what is observed after each of some random actions."""
    return [env.step(action)[0] for action in actions(env, steps, seed)]


@pytest.fixture(scope="session", params=CONFIGS, ids=lambda path: path.stem)
def config(request) -> mimoc.Bundle:
    return store.built(request.param)


@pytest.fixture(scope="session")
def built() -> Callable[..., mimoc.Bundle]:
    """Return what builds the spec given as keywords, or gives what it built before, which cannot be changed."""
    return build


@pytest.fixture(scope="session")
def bundle() -> mimoc.Bundle:
    return build(scene={"kind": "flat", "pose": "sitting"})


@pytest.fixture
def open_env(bundle) -> Iterator[Callable[..., mimoc.InfantEnv]]:
    """Return what opens the environment of a spec given as keywords, or without any of the usual infant."""
    opened = []

    usual = bundle

    def open_one(render_mode: str | None = None, bundle: mimoc.Bundle | None = None, **keys: Any) -> mimoc.InfantEnv:
        found = bundle or (build(**keys) if keys else usual)
        opened.append(mimoc.InfantEnv(found, render_mode=render_mode))
        return opened[-1]

    yield open_one
    for env in opened:
        env.close()


@pytest.fixture
def env(open_env) -> mimoc.InfantEnv:
    env = open_env()
    env.reset(seed=0)
    return env


def _driven(model: str, age_months: float, hands: str) -> mujoco.MjModel:
    body = {"hands": hands, "chest_joint": hands == "five_finger"}
    spec = {"mimoc": 1, "name": "infant", "age_months": age_months, "body": body, "actuation": {"model": model}}
    return store.compiled(mimoc.InfantSpec.model_validate(spec))


@pytest.fixture(scope="session")
def driven() -> Callable[[str, float, str], mujoco.MjModel]:
    """Return the compiled average child of an actuation model, an age, and hands; shared, so never to be written to."""
    return _driven
