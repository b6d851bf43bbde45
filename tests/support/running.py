"""Infants that run, each built once: those of `configs/`, and those of a spec given as keywords."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from support import store

import mimoc
from mimoc.schema.components.tasks import SKILLS

CONFIGS = sorted(
    path
    for path in (Path(__file__).parents[2] / "configs").glob("*.yaml")
    if path.stem not in SKILLS or path.stem == "cruise"
)
"""One skill stands for all, which begin otherwise and have other entries, but no other MJCF."""
SENSES = {"proprioception": {}, "vestibular": {}}


def build(**keys: Any) -> mimoc.Bundle:
    spec = {"mimoc": 1, "name": "infant", "age_months": 9, "senses": SENSES}
    return store.built({**spec, **keys})


@pytest.fixture(scope="session", params=CONFIGS, ids=lambda path: path.stem)
def config(request) -> mimoc.Bundle:
    """Return the bundle of each config that mimoc ships."""
    return store.built(request.param)


@pytest.fixture(scope="session")
def built() -> Callable[..., mimoc.Bundle]:
    """Return what builds the spec given as keywords, or gives what it built before, which cannot be changed."""
    return build


@pytest.fixture(scope="session")
def bundle() -> mimoc.Bundle:
    """Return a sitting infant with every sense there is."""
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
    """Return the environment of the usual infant, after a reset."""
    env = open_env()
    env.reset(seed=0)
    return env
