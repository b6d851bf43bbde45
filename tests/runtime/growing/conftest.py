"""The environments of infants that grow."""

from collections.abc import Callable, Iterator
from typing import Any

import pytest
from support.growing import flail, spec

import mimoc
from mimoc.compiler.variants import SpecVariants


@pytest.fixture(scope="module")
def variants() -> Callable[..., SpecVariants]:
    """Return what builds the infants of a spec, each once."""
    found: dict[str, SpecVariants] = {}

    def of(age_months: float = 6, **keys: Any) -> SpecVariants:
        wanted = spec(age_months, **keys)
        told = wanted.model_dump_json(exclude_unset=True)
        return found.setdefault(told, found.get(told) or SpecVariants(wanted))

    return of


@pytest.fixture
def live(variants) -> Iterator[Callable[..., mimoc.InfantEnv]]:
    """Return what opens the environment of a spec given as keywords, and lets the infant flail a little."""
    opened: list[mimoc.InfantEnv] = []

    def open_one(age_months: float = 6, steps: int = 20, **keys: Any) -> mimoc.InfantEnv:
        found = variants(age_months, **keys)
        env = mimoc.InfantEnv(found.original, variants=found)
        opened.append(env)
        env.reset(seed=0)
        flail(env, steps)
        return env

    yield open_one
    for env in opened:
        env.close()
