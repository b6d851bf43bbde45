"""rsl_rl's PPO, which learns from thousands of infants on a device."""

import math
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
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
from mimoc.policies.policy_file import WEIGHTS, Network, interface_of, pack_network
from mimoc.runtime.device.arrays import most_memory_mb, only_warnings, present, put
from mimoc.runtime.device.episodes import DeviceTask
from mimoc.runtime.device.signals import check_infant, find_device
from mimoc.runtime.device.vector_env import DeviceEnv
from mimoc.runtime.device.world_assignment import ResetSampler
from mimoc.runtime.env import InfantEnv
from mimoc.training.checkpoint import IntervalCurve, Modules, Progress, opened_checkpoint, pack, restore_state, state_of
from mimoc.training.curve import CurvePoint, DeviceUse
from mimoc.training.rsl_rl_env import GROUP, EnvRows, InfantRslEnv, check_plain
from mimoc.training.settings import Number, TrainingSettings
from mimoc.training.tracking import ROW_STEPS, RewardWatch

MAX_REWARD = 10.0  # Absolute value at which rewards in units of the deviation of returns are clipped, as on the CPU.


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
        return (rewards / torch.sqrt(self._var[0] + 1e-8)).clamp(-MAX_REWARD, MAX_REWARD)


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
    """PPO of rsl_rl, which learns from some of the infants on a device; see `Learner`.

    It has random numbers of torch of its own, so that beside others it learns what it would alone.
    """

    def __init__(self, settings: TrainingSettings, infant: InfantEnv, rows: EnvRows):
        self._settings, self._infant, self._rows = settings, infant, rows
        torch.manual_seed(settings.interval_seed(0))
        self._ppo = make_ppo(rows, settings)
        self._scale = ReturnScale(rows.num_envs, settings.hyper["gamma"]).to(rows.device)
        self._watch = RewardWatch()
        self._logger: Logger | None = None
        self._curve: DeviceCurve
        self._observation: TensorDict
        self._report: Callable[[int], None]
        self._random_states: Any = None
        self._end = self._rollout_steps = self._overflowed = self._steps = 0
        self._start_s, self._taken_s, self.has_learnt = 0.0, 0.0, False

    @property
    def _modules(self) -> Modules:
        ppo = self._ppo
        return {"actor": ppo.actor, "critic": ppo.critic, "optimizer": ppo.optimizer, "rewards": self._scale}

    def log_to(self, logger: Logger) -> None:
        """Tell a logger what is learnt from now on."""
        self._logger = logger

    def restore(self, checkpoint: bytes) -> Progress:
        """Restore a checkpoint, and return the progress at that point."""
        with opened_checkpoint(checkpoint) as saved:
            restore_state(self._modules, saved.arrays(WEIGHTS))
            return saved.progress()

    def begin(self, before: Progress, report: Callable[[int], None], on_row: Callable[[CurvePoint], None]) -> None:
        """Begin an interval, with episodes and random numbers that begin anew."""
        self._start_s = perf_counter()
        self._report = report
        self._rollout_steps = 0
        self._end = self._settings.end_of_interval(before.steps)
        seed = self._settings.interval_seed(before.steps)
        step_s = ms_to_s(self._infant.manifest.step_ms)
        torch.manual_seed(seed)
        self._curve = DeviceCurve(before, step_s, self._rows.num_envs, self._rows.device, on_row)
        self._observation = self._rows.reset(seed)
        self._rows.randomize_episode_phase()
        self._scale.restart(self._rows.device)
        self._random_states = _random_states()

    def learn(self, others: "Sequence[DeviceLearner]" = ()) -> None:
        """Learn until the end of the interval, in lock-step with others: a control step is one of all infants."""
        learning, env = [self, *others], self._rows.env
        while learning := [learner for learner in learning if learner._curve.steps < learner._end]:
            actions = torch.zeros((env.num_envs, env.num_actions), device=env.device)
            for learner in learning:
                actions[learner._rows.which] = learner._act()
            outcome = env.step(actions)
            for learner in learning:
                learner._learn_from(*learner._rows.part_of(outcome))

    def _act(self) -> torch.Tensor:
        with self._own_random_numbers(), torch.no_grad():
            return self._ppo.act(self._observation)

    def _learn_from(
        self, observation: TensorDict, rewards: torch.Tensor, dones: torch.Tensor, extras: dict[str, Any]
    ) -> None:
        """Take a control step into account; the last one of a rollout updates the policy."""
        self._curve.add(rewards, dones, extras)
        if not self._watch.ended:
            self._watch(rewards.cpu().numpy())
        with self._own_random_numbers():
            with torch.no_grad():
                self._ppo.process_env_step(observation, self._scale.scaled(rewards, dones), dones, extras)
            self._report(self._curve.steps)
            self._observation = observation
            self._rollout_steps = self._rollout_steps + 1
            if self._rollout_steps == int(self._settings.hyper["n_steps"]):
                self._update()

    def _update(self) -> None:
        with torch.no_grad():
            self._ppo.compute_returns(self._observation)
        losses = self._ppo.update()
        self.has_learnt, self._rollout_steps = True, 0
        self._log(losses, self._curve.end_row())
        if self._curve.steps >= self._end:
            self._steps += self._curve.steps - self._curve.start_steps
            self._taken_s += perf_counter() - self._start_s

    @contextmanager
    def _own_random_numbers(self) -> Iterator[None]:
        on_cpu, on_gpus = self._random_states
        torch.set_rng_state(on_cpu)
        if on_gpus:
            torch.cuda.set_rng_state_all(on_gpus)
        try:
            yield
        finally:
            self._random_states = _random_states()

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
        return pack(reached, {WEIGHTS: state_of(self._modules)})

    def use(self, others: "Sequence[DeviceLearner]" = ()) -> list[DeviceUse | None]:
        """Return what it and others took of their device, and what each policy does there."""
        learners = [self, *others]
        uses = list[DeviceUse | None]()
        device = self._rows.env.infants.device
        for learner, success in zip(learners, success_rates(learners), strict=True):
            manifest = learner._infant.manifest
            rate = learner._steps / max(learner._taken_s, 1e-9)
            period = to_steps(manifest.step_ms, manifest.timestep_ms)
            name = f"{device.name} ({self._settings.device})"
            memory_mb = most_memory_mb(device)
            uses.append(DeviceUse(name, rate, rate * period, memory_mb, learner._overflowed, success))
        return uses


def success_rates(learners: Sequence[DeviceLearner]) -> list[float]:
    """Return the share of each learner's infants that have success in an episode without exploration."""
    env = learners[0]._rows.env
    for learner in learners:
        learner._rows.reset(learner._settings.interval_seed(learner._curve.steps))
    observation = env.get_observations()
    is_over = torch.zeros(env.num_envs, dtype=torch.bool, device=env.device)
    succeeds = is_over.clone()
    for _ in range(env.max_episode_length):
        actions = torch.zeros((env.num_envs, env.num_actions), device=env.device)
        with torch.no_grad():
            for learner in learners:
                actions[learner._rows.which] = learner._ppo.actor(observation[learner._rows.which])
        observation, _, dones, extras = env.step(actions)
        succeeds |= extras["is_success"] & dones & ~is_over
        is_over |= dones
    return [float(succeeds[learner._rows.which].double().mean()) for learner in learners]


def _random_states() -> tuple[torch.Tensor, Sequence[torch.Tensor]]:
    return torch.get_rng_state(), torch.cuda.get_rng_state_all() if torch.cuda.is_initialized() else ()


def make_ppo(env: InfantRslEnv | EnvRows, settings: TrainingSettings) -> PPO:
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
def device_learners(
    settings: Sequence[TrainingSettings],
    infants: Sequence[InfantEnv],
    openers: Sequence[Callable[..., InfantEnv]],
) -> Iterator[list[DeviceLearner]]:
    """Open as many infants of each kind as the settings say on their device, and a learner for each kind.

    Trainings differ in infant and seed only. Warp says nothing of its kernels meanwhile.
    """
    with only_warnings():
        batch = DeviceEnv(
            [open_one(kind=ResetSampler) for open_one in openers],
            settings[0].envs * len(openers),
            settings[0].device.removeprefix("warp:"),
            "SameStep",
            settings[0].steps_per_episode,
            "torch",
            "points",  # Touch at points of the skin, as on the CPU, where the policy is to run.
        )
        with closing(batch):
            env = InfantRslEnv(batch, settings[0].seed)
            rows = [EnvRows(env, first, len(openers)) for first in range(len(openers))]
            yield [DeviceLearner(*parts) for parts in zip(settings, infants, rows, strict=True)]


SUMS = ("episodes", "return", "steps", "successes", "steps to success", "overflowed")
"""What is added up of the episodes that ended."""


class DeviceCurve:
    """Extends a learning curve during a training interval; the CPU waits for the device once a row.

    The first episode of each infant does not count: it is cut at a random time, see `EnvRows.randomize_episode_phase`.
    """

    def __init__(self, before: Progress, step_s: float, envs: int, device: Any, on_row: Callable[[CurvePoint], None]):
        """Continue the curve of earlier intervals, of control steps of *step_s*; *on_row* gets each new row."""
        self._curve, self._step_s = IntervalCurve(before, on_row), step_s
        self.steps = self.start_steps = before.steps
        """Control steps so far, summed over all infants."""
        self.overflowed = 0
        """Episodes of the interval that were cut because contacts did not fit."""
        self._returns, self._lengths = (torch.zeros(envs, dtype=torch.float64, device=device) for _ in range(2))
        self._is_whole = torch.zeros(envs, dtype=torch.bool, device=device)
        self._sums = torch.zeros(len(SUMS), dtype=torch.float64, device=device)

    def add(self, rewards: torch.Tensor, dones: torch.Tensor, extras: Mapping[str, Any]) -> None:
        """Take a control step into account; arrays have the shape (envs,)."""
        self.steps += len(rewards)
        self._returns += rewards
        self._lengths += 1
        counts = dones & self._is_whole
        self._is_whole |= dones
        ends = counts.double()
        succeeds = (extras["is_success"] & counts).double()
        overflows = (extras["overflowed"] & dones).double()
        parts = ends, ends * self._returns, ends * self._lengths, succeeds, succeeds * self._lengths, overflows
        self._sums += torch.stack(parts).sum(dim=1)
        for so_far in (self._returns, self._lengths):
            so_far.masked_fill_(dones, 0.0)

    def end_row(self, at_last: bool = False) -> CurvePoint:
        """Return the row of the steps since the row before; it is kept if they are enough, or the last ones."""
        known = dict(zip(SUMS, self._sums.tolist(), strict=True))
        going_on = self._lengths > 0
        count = int(going_on.sum())
        so_far = [float(values.sum()) / count if count else math.nan for values in (self._returns, self._lengths)]
        row = CurvePoint(
            steps=self.steps,
            episodes=int(known["episodes"]),
            episode_return=_share(known["return"], known["episodes"]),
            success_rate=_share(known["successes"], known["episodes"]),
            episode_steps=_share(known["steps"], known["episodes"]),
            time_to_success_s=_share(known["steps to success"], known["successes"]) * self._step_s,
            wall_s=self._curve.wall_s(),
            unfinished=count,
            unfinished_return=so_far[0],
            unfinished_steps=so_far[1],
        )
        if at_last or self.steps - self._curve.row_start >= ROW_STEPS:
            self.overflowed += int(known["overflowed"])
            self._sums.zero_()
            self._curve.add(row)
        return row

    def progress(self) -> Progress:
        """Return the progress at the end of the interval, or where it was interrupted."""
        if self.steps > self._curve.row_start:
            self.end_row(at_last=True)
        return self._curve.progress(self.steps)


def _share(total: float, count: float) -> float:
    return total / count if count else math.nan
