"""An infant that grows while it lives sinks into nothing and is thrown by nothing."""

import copy

import mujoco
import numpy as np
import pytest
from support.growing import DEEPEST_M, deepest_m, flail, same

import mimoc
from mimoc.bundle.model import simulation_warnings

POSES = ("supine", "prone", "sitting", "standing")


def energy_j(env: mimoc.InfantEnv) -> float:
    mujoco.mj_energyPos(env.model, env.data)
    mujoco.mj_energyVel(env.model, env.data)
    return float(env.data.energy.sum())


@pytest.mark.full
@pytest.mark.parametrize("pose", POSES)
def test_infants_grow_in_quarter_months_without_sinking_into_anything(live, pose):
    env = live(5, scene={"pose": pose})
    for stage in range(1, 9):
        env.grow(to=5 + stage / 4)
        assert deepest_m(env) < DEEPEST_M
        assert np.isfinite(energy_j(env))
        flail(env, 5, seed=stage)
    assert simulation_warnings(env.data) == ()


@pytest.mark.parametrize("pose", POSES)
@pytest.mark.parametrize(("young", "old"), [(0, 24), (24, 0)])
def test_infants_grow_in_one_jump_without_sinking_into_anything(live, pose, young, old):
    env = live(young, scene={"pose": pose})
    env.grow(to=old)
    assert deepest_m(env) < DEEPEST_M
    before_j = energy_j(env)
    for observation in flail(env, 20):
        assert observation in env.observation_space
    assert energy_j(env) < before_j + 30
    assert simulation_warnings(env.data) == ()


@pytest.mark.parametrize(
    "keys", [{"kind": "room", "toys": {"count": [4, 4]}}, {"kind": "crib", "toys": {"count": [3, 3]}}]
)
def test_infants_among_toys_grow_without_sinking_into_them(live, keys):
    env = live(6, scene={**keys, "pose": "sitting"})
    toys = [env.data.joint(toy.joint).qpos.copy() for toy in env.manifest.toys]
    env.grow(to=9)
    assert deepest_m(env) < DEEPEST_M
    for before, toy in zip(toys, env.manifest.toys, strict=True):
        assert env.data.joint(toy.joint).qpos[:3] == pytest.approx(before[:3], abs=0.05)


@pytest.mark.parametrize(("pose", "seed"), [("prone", 3), ("supine", 1)])
def test_toys_are_not_pushed_into_the_floor(live, pose, seed):
    """Limbs come to lie on toys that they were beside."""
    env = live(0, scene={"kind": "room", "toys": {"count": [4, 4]}, "seed": seed, "pose": pose})
    env.grow(to=3)
    assert deepest_m(env) < DEEPEST_M
    assert max(-contact.dist for contact in env.data.contact) < DEEPEST_M


def test_a_crib_grows_along(live):
    """It has more bars at 24 months than at 12, and the infant goes on all the same."""
    env = live(12, scene={"kind": "crib", "toys": {"count": [2, 2]}})
    bars, twin = env.model.ngeom, copy.deepcopy(env)
    env.grow(to=24)
    assert env.model.ngeom > bars
    assert deepest_m(env) < DEEPEST_M
    env.set_state(twin.get_state())
    assert same(flail(env, 5), flail(twin, 5))


def test_five_fingers_grow_too(live):
    env = live(3, body={"hands": "five_finger"}, scene={"pose": "sitting"})
    env.grow(to=12)
    assert deepest_m(env) < DEEPEST_M
