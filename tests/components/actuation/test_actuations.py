"""What every actuation model keeps to, with either hands."""

from functools import cache

import pytest
from gymnasium.utils.env_checker import check_env
from support import store
from support.full import full_but, full_rows

import mimoc
from mimoc.runtime.check import MAX_ENERGY_J_PER_KG, check_stability
from mimoc.schema.components.actuation import ACTUATIONS

NO_STRENGTH = {"strength": dict.fromkeys(("neck", "trunk", "eyes", "arms", "hands", "legs"), 0)}
CHILDREN = [
    *((0, "mitten"), (0, "five_finger"), (1, "mitten"), (3, "five_finger"), (6, "mitten")),
    *((12, "five_finger"), (18, "mitten"), (24, "mitten"), (24, "five_finger")),
]
"""Age in months, and hands: each age has one kind of hands, and the first and the last both."""
FEW_CHILDREN = [CHILDREN[1], CHILDREN[4], CHILDREN[7]]
EVERYTHING_FELT = {"proprioception": {"include": ["velocity", "torque", "limits", "actuation"]}, "vestibular": {}}


@pytest.fixture(params=["mitten", "five_finger"])
def hands(request):
    return request.param


def infant(model, hands, age_months=9, **actuation):
    spec = {
        "mimoc": 1,
        "name": "x",
        "age_months": age_months,
        "body": {"hands": hands},
        "actuation": {"model": model, **actuation},
        "senses": EVERYTHING_FELT,
    }
    return store.built(spec)


@pytest.mark.full
@pytest.mark.parametrize("model", ACTUATIONS)
def test_gymnasium_has_nothing_against_it(model, hands):
    check_env(mimoc.make(infant(model, hands)).unwrapped)


@pytest.mark.parametrize("model", ACTUATIONS)
def test_an_infant_without_any_strength_is_an_environment_too(model, hands):
    env = mimoc.make(infant(model, hands, **NO_STRENGTH))
    check_env(env.unwrapped)
    env.reset(seed=0)
    env.step(env.action_space.high)
    assert env.unwrapped.effort() == 0


@cache
def checks(model, hands, age_months):
    return tuple(check_stability(infant(model, hands, age_months)))


@pytest.mark.parametrize(("age_months", "hands"), full_rows(FEW_CHILDREN, CHILDREN))
@pytest.mark.parametrize("model", ACTUATIONS)
def test_random_control_is_calm_from_every_pose(model, hands, age_months):
    for check in checks(model, hands, age_months):
        assert check.warnings == (), check
        assert check.energy_j_per_kg < MAX_ENERGY_J_PER_KG, check


@pytest.mark.parametrize("children", full_but([FEW_CHILDREN], [CHILDREN]), ids=["few", "all"])
def test_muscles_move_infants_no_faster_than_motors_do(children):
    """Twice the energy at most: little damping is left to the joints, but fast muscles pull less."""
    fastest = {
        model: max(check.energy_j_per_kg for age, hands in children for check in checks(model, hands, age))
        for model in ("torque", "muscle")
    }
    assert fastest["muscle"] < 2 * fastest["torque"]
