"""Compiled infants by actuation model."""

from collections.abc import Callable

import mujoco
import pytest
from support import store

import mimoc


def _driven(model: str, age_months: float, hands: str) -> mujoco.MjModel:
    body = {"hands": hands, "chest_joint": hands == "five_finger"}
    spec = {"mimoc": 1, "name": "infant", "age_months": age_months, "body": body, "actuation": {"model": model}}
    return store.compiled(mimoc.InfantSpec.model_validate(spec))


@pytest.fixture(scope="session")
def driven() -> Callable[[str, float, str], mujoco.MjModel]:
    """Return the compiled average child of an actuation model, an age, and hands; shared, so never to be written to."""
    return _driven
