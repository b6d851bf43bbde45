"""Every policy acts for each infant of a world and of a batch as it does for one that is alone."""

from contextlib import closing
from typing import Any

import numpy as np
import pytest
from support.motions import moved
from support.store import built, made_once
from support.worlds import placed

import mimoc
from mimoc.motion.joint_motion import pack_motion
from mimoc.policies.named import policy_of
from mimoc.policies.rollout import Run
from mimoc.policies.spec import needs_argument
from mimoc.runtime.world_env import WorldEnv
from mimoc.schema.kinds import POLICIES

SENSES = {"proprioception": {"include": ["velocity"]}, "vestibular": {}, "touch": {"density": 0.3}}
KIM: dict[str, Any] = {"mimoc": 1, "name": "kim", "age_months": 9, "senses": SENSES, "scene": {"pose": "sitting"}}
BEN = {**KIM, "name": "ben", "age_months": 6}
ARGUMENTS = {  # Arguments of policies; one that cannot be chosen by its name alone must be here.
    "look_at": ("right_hand", "0.5,0.2,0.3"),
    "reach_for": ("0.15,-0.1,0.25,right", "left_foot"),
    "reflexes": ("1.5",),
    "kick": ("left",),
    "skill": ("sit", "roll"),
    "motion": ("DIR",),
}
TEXTS = [
    *(name for name in POLICIES if not needs_argument(POLICIES[name]) and name != "look_around"),  # It needs eyes.
    *(f"{name}:{argument}" for name in POLICIES for argument in ARGUMENTS.get(name, ())),
    "sit+look_at:head+general_movements+reflexes",
]
FAR_CM = {"y_cm": 500.0}, {"y_cm": 0.0}


def test_all_policies_are_here():
    assert {name for name in POLICIES if needs_argument(POLICIES[name])} <= ARGUMENTS.keys()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("motion")
    (path / "motion.npz").write_bytes(pack_motion(moved(built(KIM), 0.3)))
    return path


@pytest.fixture(params=TEXTS)
def policy(request, folder) -> str:
    return request.param.replace("DIR", str(folder))


@pytest.fixture(scope="module")
def world():
    """Return a world in which the infant is the second one, far away from the first."""
    bundle = made_once("world far apart", lambda: placed({"ben": BEN, "kim": KIM}, *FAR_CM))
    with closing(WorldEnv(bundle)) as env:
        yield env


@pytest.fixture(scope="module")
def kim():
    with closing(mimoc.InfantEnv(built(KIM))) as env:
        yield env


def assert_same_in_a_world(kim, world, policy, steps, within_m=1e-6):
    alone, shared = Run(kim, policy, seed=1), Run(world, policy, seed=0)
    for _ in range(steps):
        alone.step()
        shared.step()
    assert world.infants["kim"].keypoints() == pytest.approx(kim.keypoints(), abs=within_m, nan_ok=True)
    metrics, others = (run["kim"].metrics for run in ({"kim": alone.summary()}, shared.summaries()))
    assert others == pytest.approx(metrics, rel=1e-4, abs=1e-6)


def test_in_a_world_an_infant_does_what_it_does_alone(kim, world, policy):
    assert_same_in_a_world(kim, world, policy, steps=8)


ROUNDED_M = {"prone": 0.02}  # Forearms that slide make much of the rounding of places in a world within a second.


@pytest.mark.full
def test_in_a_world_it_does_so_for_a_second(kim, world, policy):
    assert_same_in_a_world(kim, world, policy, steps=100, within_m=ROUNDED_M.get(policy, 1e-6))


def test_in_a_batch_of_worlds_an_infant_does_what_it_does_alone(kim, world, policy):
    with closing(mimoc.make_vec([world.bundle, world.bundle])) as envs:
        act, generators = mimoc.policy_vec(policy, envs), [np.random.default_rng(row) for row in range(4)]
        observations, _ = envs.reset(seed=0)
        for _ in range(3):
            observations, *_ = envs.step(act(generators, observations))
        # It is the second infant of the second world. As in a batch, nobody but its policy begins its episode.
        observation, _ = kim.reset(seed=3)
        alone, generator = policy_of(kim, policy), np.random.default_rng(3)
        for _ in range(3):
            observation, *_ = kim.step(alone(generator, observation))
        assert envs.infants[3].keypoints() == pytest.approx(kim.keypoints(), abs=1e-6, nan_ok=True)


def test_a_row_of_a_batch_is_commanded_what_the_infant_is_alone(kim, policy):
    bundle, steps = built(KIM), 3
    with closing(mimoc.InfantEnv(bundle)) as second:
        envs, alone = mimoc.make_vec([bundle, bundle]), (kim, second)
        act, generators = mimoc.policy_vec(policy, envs), [np.random.default_rng(row) for row in range(2)]
        observations, _ = envs.reset(seed=0)
        singles = [(env.reset(seed=row)[0], policy_of(env, policy)) for row, env in enumerate(alone)]
        seen, actions = [observation for observation, _ in singles], list[np.ndarray]()
        drawn = [np.random.default_rng(row) for row in range(2)]
        for _ in range(steps):
            commands = act(generators, observations)
            actions = [one(chance, now) for (_, one), chance, now in zip(singles, drawn, seen, strict=True)]
            assert commands.tobytes() == np.stack(actions).tobytes()
            observations, *_ = envs.step(commands)
            seen = [env.step(action)[0] for env, action in zip(alone, actions, strict=True)]
        envs.close()
