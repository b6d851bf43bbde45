"""Learning libraries take the environment as it is."""

import numpy as np
import pytest
from stable_baselines3 import PPO
from stable_baselines3.common.env_checker import check_env

import mimoc

SENSES = {
    "proprioception": {},
    "vestibular": {},
    "touch": {"density": 0.2},
    "vision": {"width_px": 40, "height_px": 40, "foveation": 3},
}
STEPS = 64


@pytest.fixture(scope="module")
def bundle(built) -> mimoc.Bundle:
    """Return an infant with every sense, all signals late."""
    return built(senses=SENSES, delays={"preset": "physiological"})


def test_stable_baselines_has_nothing_against_it(bundle, recwarn):
    env = mimoc.InfantEnv(bundle)
    check_env(env)
    env.close()
    assert not [str(warning.message) for warning in recwarn if "mimoc" in str(warning.filename)]


def test_ppo_trains_on_all_senses(bundle):
    env = mimoc.make(bundle, max_episode_steps=100)
    agent = PPO("MultiInputPolicy", env, n_steps=STEPS // 2, batch_size=STEPS // 2, n_epochs=1, seed=0, device="cpu")
    before = [weights.detach().numpy().copy() for weights in agent.policy.parameters()]
    agent.learn(STEPS)
    after = [weights.detach().numpy() for weights in agent.policy.parameters()]
    assert agent.num_timesteps == STEPS
    assert all(np.isfinite(weights).all() for weights in after)
    assert any((old != new).any() for old, new in zip(before, after, strict=True))
    env.close()
