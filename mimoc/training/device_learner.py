"""rsl_rl's PPO, which learns from thousands of infants on a device."""

from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import closing, contextmanager
from time import perf_counter
from typing import Any

import numpy as np
import torch
from rsl_rl.algorithms import PPO
from rsl_rl.models import MLPModel
from rsl_rl.modules import EmpiricalNormalization
from rsl_rl.storage import RolloutStorage
from stable_baselines3.common.logger import Logger
from tensordict import TensorDict

from mimoc.base.units import ms_to_s, to_steps
from mimoc.policies.network import Network, pack_network
from mimoc.policies.policy_file import interface_of
from mimoc.runtime.device.arrays import present, put
from mimoc.runtime.device.episode_ends import DeviceTask
from mimoc.runtime.device.signals import check_infant, find_device
from mimoc.runtime.device.usage import most_memory_mb, only_warnings
from mimoc.runtime.device.vector_env import DeviceEnv
from mimoc.runtime.device.world_assignment import ResetSampler
from mimoc.runtime.env import InfantEnv
from mimoc.training.agents import Modules, interval_seed
from mimoc.training.checkpoint import Progress, pack_modules, restore_modules
from mimoc.training.curve import CurvePoint
from mimoc.training.device_curve import DeviceCurve
from mimoc.training.learner import DeviceUse
from mimoc.training.rsl_rl_env import GROUP, InfantRslEnv, check_plain
from mimoc.training.settings import Number, TrainingSettings
from mimoc.training.shares import Share
from mimoc.training.tracking import RewardWatch

MOST_REWARD = 10.0
"""Absolute value at which rewards in units of the deviation of returns are clipped, as on the CPU."""


class ClippedNormalization(EmpiricalNormalization):
    """Normalises observations x as on the CPU: clip((x - mean) / sqrt(variance + floor²), -c, c)."""

    def __init__(self, numbers: int, floor: float, clip: float):
        """Begin with mean 0 and variance 1 of so many numbers."""
        super().__init__(numbers)
        self.floor, self.clip = floor, clip

    @property
    def deviation(self) -> torch.Tensor:
        """What is divided by, shape (1, numbers)."""
        variance: Any = self._var
        return torch.sqrt(variance.clamp(min=0.0) + self.floor**2)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        """Return normalised observations, shape (n, numbers)."""
        return ((x - self._mean) / self.deviation).clamp(-self.clip, self.clip)


class ReturnScale(EmpiricalNormalization):
    """Divides rewards by the deviation of discounted returns, as on the CPU."""

    def __init__(self, envs: int, gamma: float):
        """Begin with so many infants."""
        super().__init__(1)
        self._gamma, self._returns = gamma, torch.zeros(envs)

    def restart(self, device: Any) -> None:
        """Begin episodes of all infants."""
        self._returns = torch.zeros(len(self._returns), device=device)

    def scaled(self, rewards: torch.Tensor, dones: torch.Tensor) -> torch.Tensor:
        """Return scaled rewards of a control step, shape (envs,)."""
        returns = self._returns * self._gamma + rewards
        self.update(returns[:, None])
        self._returns = returns.masked_fill(dones, 0.0)
        return (rewards / torch.sqrt(self._var[0] + 1e-8)).clamp(-MOST_REWARD, MOST_REWARD)


class EarlyEnding(RolloutStorage):
    """A rollout that gives no more parts to learn from once the policy has moved too far from the one that made it."""

    actor: MLPModel
    target_kl: float
    """KL divergence from the former policy, as a mean over a part, beyond which it gives no more."""
    parts = 0
    """How many were given in the last update."""

    def mini_batch_generator(self, num_mini_batches: int, num_epochs: int = 8) -> Generator[Any, None, None]:
        """Yield parts; before each but the first, the divergence at the one before is known."""
        self.parts = 0
        for batch in super().mini_batch_generator(num_mini_batches, num_epochs):
            self.parts += 1
            yield batch
            with torch.no_grad():
                old: Any = batch.old_distribution_params
                if self.actor.get_kl_divergence(old, self.actor.output_distribution_params).mean() > self.target_kl:
                    return


class DeviceLearner:
    """PPO of rsl_rl with its infants; see `Learner`."""

    def __init__(self, settings: TrainingSettings, infant: InfantEnv, env: Share):
        self._settings, self._infant, self._env = settings, infant, env
        torch.manual_seed(interval_seed(settings.seed, 0))
        self._ppo = make_ppo(env, settings)
        self._scale = ReturnScale(env.num_envs, settings.hyper["gamma"]).to(env.device)
        self._watch = RewardWatch()
        self._logger: Logger | None = None
        self._curve: DeviceCurve
        self._steps, self._overflowed, self._taken_s, self.has_learnt = 0, 0, 0.0, False

    @property
    def _modules(self) -> Modules:
        ppo = self._ppo
        return {"actor": ppo.actor, "critic": ppo.critic, "optimizer": ppo.optimizer, "rewards": self._scale}

    def log_to(self, logger: Logger) -> None:
        """Tell a logger what is learnt from now on."""
        self._logger = logger

    def restore(self, checkpoint: bytes) -> Progress:
        """Restore a checkpoint, and return the progress at that point."""
        return restore_modules(checkpoint, self._modules)

    async def learn(
        self, before: Progress, report: Callable[[int], None], on_row: Callable[[CurvePoint], None]
    ) -> None:
        """Learn until the next checkpoint: from episodes that begin anew, with random numbers that begin anew."""
        start_s, seed = perf_counter(), interval_seed(self._settings.seed, before.steps)
        torch.manual_seed(seed)
        step_s = ms_to_s(self._infant.manifest.step_ms)
        self._curve = DeviceCurve(before, step_s, self._env.num_envs, self._env.device, on_row)
        observation = self._env.reset(seed)
        self._env.spread()
        self._scale.restart(self._env.device)
        try:
            while self._curve.steps < self._settings.end_of_interval(before.steps):
                observation = await self._rollout(observation, report)
                losses = self._ppo.update()
                self.has_learnt = True
                self._log(losses, self._curve.end_row())
        finally:
            self._steps += self._curve.steps - before.steps
            self._taken_s += perf_counter() - start_s

    async def _rollout(self, observation: TensorDict, report: Callable[[int], None]) -> TensorDict:
        """Let the policy act for some control steps, and return what is observed then."""
        for _ in range(int(self._settings.hyper["n_steps"])):
            with torch.no_grad():
                actions = self._ppo.act(observation)
            observation, rewards, dones, extras = await self._env.step(actions)
            self._curve.add(rewards, dones, extras)
            if not self._watch.ended:
                self._watch(rewards.cpu().numpy())
            with torch.no_grad():
                self._ppo.process_env_step(observation, self._scale.scaled(rewards, dones), dones, extras)
            report(self._curve.steps)
        with torch.no_grad():
            self._ppo.compute_returns(observation)
        return observation

    def _log(self, losses: dict[str, float], row: CurvePoint) -> None:
        """Tell the logger of an update; rsl_rl divides losses by the number of all parts, given or not."""
        if self._logger is None:
            return
        storage: Any = self._ppo.storage
        parts = self._ppo.num_learning_epochs * self._ppo.num_mini_batches
        numbers = {f"train/{name}": value * parts / storage.parts for name, value in losses.items()}
        numbers |= {"train/parts": storage.parts, "train/std": float(self._ppo.actor.output_std.detach().mean())}
        if row.episodes:
            numbers |= {"rollout/ep_rew_mean": row.episode_return, "rollout/ep_len_mean": row.episode_steps}
            numbers |= {"rollout/success_rate": row.success_rate}
        for name, value in numbers.items():
            self._logger.record(name, value)
        self._logger.dump(row.steps)

    def progress(self) -> Progress:
        """Return the progress at the end of what was learnt last, or where that was interrupted."""
        return self._curve.progress()

    def policy(self) -> bytes:
        """Return the content of the file of its policy."""
        about = {"infant": self._infant.manifest.name, "steps": self._curve.steps, "settings": self._settings.data()}
        return pack_network(network_of(self._ppo.actor), {**about, **interface_of(self._infant)})

    def checkpoint(self, reached: Progress) -> bytes:
        """Return the content of a checkpoint file."""
        self._overflowed += self._curve.overflowed
        return pack_modules(self._modules, reached)

    async def use(self) -> DeviceUse:
        """Return what was taken of the device, and what the policy does there."""
        manifest, device = self._infant.manifest, self._env.infants.device
        rate = self._steps / max(self._taken_s, 1e-9)
        period, name = to_steps(manifest.step_ms, manifest.timestep_ms), f"{device.name} ({self._settings.device})"
        success = await self._success()
        return DeviceUse(name, rate, rate * period, most_memory_mb(device), self._overflowed, success)

    async def _success(self) -> float:
        """Return the share of the infants that have success in an episode of the commands that the policy means."""
        observation = self._env.reset(interval_seed(self._settings.seed, self._curve.steps))
        is_over = torch.zeros(self._env.num_envs, dtype=torch.bool, device=self._env.device)
        succeeds = is_over.clone()
        for _ in range(self._env.max_episode_length):
            with torch.no_grad():
                actions = self._ppo.actor(observation)
            observation, _, dones, extras = await self._env.step(actions)
            succeeds |= extras["is_success"] & dones & ~is_over
            is_over |= dones
        return float(succeeds.double().mean())


def make_ppo(env: InfantRslEnv | Share, settings: TrainingSettings) -> PPO:
    """Return rsl_rl's PPO with untrained networks."""
    hyper, observation = settings.hyper, env.get_observations()
    distribution = {"class_name": "GaussianDistribution", "init_std": hyper["init_std"], "std_type": "log"}
    actor = _model(observation, hyper, env.num_actions, distribution).to(env.device)
    critic = _model(observation, hyper, 1, None).to(env.device)
    device: Any = env.device
    storage = EarlyEnding("rl", env.num_envs, int(hyper["n_steps"]), observation, [env.num_actions], device)
    storage.actor, storage.target_kl = actor, hyper["target_kl"]
    return PPO(
        actor,
        critic,
        storage,
        num_learning_epochs=int(hyper["n_epochs"]),
        num_mini_batches=int(hyper["mini_batches"]),
        clip_param=hyper["clip_range"],
        gamma=hyper["gamma"],
        lam=hyper["gae_lambda"],
        entropy_coef=hyper["ent_coef"],
        learning_rate=hyper["learning_rate"],
        max_grad_norm=hyper["max_grad_norm"],
        schedule="fixed",
        device=device,
    )


def _model(
    observation: TensorDict, hyper: "dict[str, Number] | Any", outputs: int, distribution: dict[str, Any] | None
) -> MLPModel:
    hidden = [int(hyper["width"])] * int(hyper["layers"])
    model = MLPModel(observation, {"set": [GROUP]}, "set", outputs, hidden, "elu", True, distribution)
    floor, clip = hyper["observation_floor"], hyper["observation_clip"]
    model.obs_normalizer = ClippedNormalization(model.obs_dim, floor, clip)
    return model


def network_of(actor: MLPModel) -> Network:
    """Return the policy as NumPy computes it."""
    scale: Any = actor.obs_normalizer
    layers = [layer for layer in actor.mlp if isinstance(layer, torch.nn.Linear)]
    pairs = [(layer.weight.numpy(force=True), layer.bias.numpy(force=True)) for layer in layers]
    mean, deviation = (array[0].numpy(force=True) for array in (scale._mean, scale.deviation))
    return Network(mean.copy(), deviation.copy(), scale.clip, pairs)


def check_on_device(name: str, infant: InfantEnv) -> None:
    """Check that an infant can learn on a device; raise a MimocError if something of it cannot be there."""
    check_plain(infant.observation_space)
    check_infant(infant)
    with present(find_device(name.removeprefix("warp:"))):
        DeviceTask([infant], put(np.zeros(1, int)))


@contextmanager
def device_learner(
    settings: TrainingSettings, infant: InfantEnv, open_one: Callable[..., InfantEnv]
) -> Iterator[DeviceLearner]:
    """Open the infants on their device, and what learns from them."""
    with shared_device(settings, [open_one]) as shares:
        yield DeviceLearner(settings, infant, shares[0])


@contextmanager
def shared_device(settings: TrainingSettings, openers: Sequence[Callable[..., InfantEnv]]) -> Iterator[list[Share]]:
    """Open as many infants of each kind as the settings say on their device, and return the share of each kind.

    Warp says nothing of its kernels meanwhile.
    """
    with only_warnings():
        infants = DeviceEnv(
            [open_one(kind=ResetSampler) for open_one in openers],
            settings.envs * len(openers),
            settings.device.removeprefix("warp:"),
            "SameStep",
            settings.steps_per_episode,
            "torch",
            "points",  # Of the skin, as on the CPU, where the policy is to run.
        )
        with closing(infants):
            env = InfantRslEnv(infants, settings.seed)
            yield [Share(env, first, len(openers)) for first in range(len(openers))]
