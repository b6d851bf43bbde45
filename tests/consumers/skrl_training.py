"""skrl: its wrapper, its PPO and its trainer, on four infants at once."""

from pathlib import Path

import torch
from skrl.agents.torch.ppo import PPO, PPO_CFG
from skrl.envs.wrappers.torch import wrap_env
from skrl.memories.torch import RandomMemory
from skrl.models.torch import DeterministicMixin, GaussianMixin, Model
from skrl.trainers.torch import SequentialTrainer, SequentialTrainerCfg
from skrl.utils.spaces.torch import compute_space_size

import mimoc

INFANTS, ROLLOUT = 4, 16


class Policy(GaussianMixin, Model):
    def __init__(self, **spaces):
        Model.__init__(self, **spaces)
        GaussianMixin.__init__(self, clip_actions=True)
        self.mean = torch.nn.Linear(compute_space_size(spaces["observation_space"]), self.num_actions)
        self.log_std = torch.nn.Parameter(torch.zeros(self.num_actions))

    def compute(self, inputs, role):
        return self.mean(inputs["observations"]), {"log_std": self.log_std}


class Value(DeterministicMixin, Model):
    def __init__(self, **spaces):
        Model.__init__(self, **spaces)
        DeterministicMixin.__init__(self)
        self.value = torch.nn.Linear(compute_space_size(spaces["observation_space"]), 1)

    def compute(self, inputs, role):
        return self.value(inputs["observations"]), {}


def use(bundles: Path) -> str:
    for name in ("nine_months", "muscle"):
        env = wrap_env(mimoc.make_vec(bundles / name, num_envs=INFANTS, max_episode_steps=10), verbose=False)
        spaces = {"observation_space": env.observation_space, "action_space": env.action_space, "device": "cpu"}
        models = {"policy": Policy(**spaces), "value": Value(**spaces)}
        cfg = PPO_CFG(rollouts=ROLLOUT, learning_epochs=1)
        cfg.experiment.write_interval = cfg.experiment.checkpoint_interval = 0  # No files.
        memory = RandomMemory(memory_size=ROLLOUT, num_envs=INFANTS, device="cpu")
        agent = PPO(models=models, memory=memory, cfg=cfg, **spaces)
        before = models["policy"].mean.weight.clone()
        settings = SequentialTrainerCfg(
            timesteps=2 * ROLLOUT, disable_progressbar=True, close_environment_at_exit=False
        )
        SequentialTrainer(env=env, agents=agent, cfg=settings).train()
        after = models["policy"].mean.weight
        assert torch.isfinite(after).all()
        assert not torch.equal(before, after)
        env.close()
    return f"{2 * ROLLOUT * INFANTS} steps each, two updates"
